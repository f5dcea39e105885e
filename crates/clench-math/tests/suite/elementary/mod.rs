//! Accuracy of the elementary functions, and their results at the edges.
//!
//! The reference is the standard library (the platform's libm), itself off by up to one unit in the last place. For
//! `f32` it is the standard library in `f64`, which is exact for this purpose.

mod exponential;
mod trigonometric;

const SAMPLES: usize = 200_000;

/// Returns the number of representable steps between two numbers.
fn distance(a: f64, b: f64) -> u64 {
    if a.is_nan() && b.is_nan() {
        return 0;
    }
    let position = |x: f64| {
        let magnitude = (x.abs().to_bits()) as i64;
        if x.is_sign_negative() {
            -magnitude
        } else {
            magnitude
        }
    };
    position(a).abs_diff(position(b))
}

/// Returns the error in units in the last place of the exact value.
fn error_32(value: f32, exact: f64) -> f64 {
    let rounded = (exact as f32).abs();
    let unit = f64::from(rounded.next_up()) - f64::from(rounded);
    (f64::from(value) - exact).abs() / unit
}

/// Checks that the worst error over random arguments is at most 2 steps in `f64` (libm's own error included) and 2 ulp
/// in `f32`.
fn sweep(
    name: &str,
    mut arguments: impl FnMut() -> (f64, f64),
    double: [fn(f64, f64) -> f64; 2],
    single: fn(f32, f32) -> f32,
) {
    let [ours, reference] = double;
    for _ in 0..SAMPLES {
        let (a, b) = arguments();
        let (got, expected) = (ours(a, b), reference(a, b));
        assert!(
            distance(got, expected) <= 2,
            "{name}({a:e}, {b:e}) = {got:e}, not {expected:e}"
        );
        let (a, b) = (a as f32, b as f32);
        let exact = reference(f64::from(a), f64::from(b));
        if exact.abs() < f64::from(f32::MAX) && exact.abs() > f64::from(f32::MIN_POSITIVE) {
            let got = single(a, b);
            assert!(
                error_32(got, exact) <= 2.0,
                "{name}({a:e}, {b:e}) = {got:e}, not {exact:e} in f32"
            );
        }
    }
}
