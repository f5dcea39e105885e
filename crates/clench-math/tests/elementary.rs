//! Accuracy of the elementary functions, and what they do at the edges.
//!
//! The reference is the standard library (the platform's libm), itself off by up to one unit in the last place; in
//! `f32` it is the standard library in `f64`, which is exact for the purpose.

mod support;

use clench_math::{Real, Scalar};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use support::Random;

const SAMPLES: usize = 200_000;

/// How many representable numbers apart.
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

/// Error in units in the last place of the exact value.
fn error_32(value: f32, exact: f64) -> f64 {
    let rounded = (exact as f32).abs();
    let unit = f64::from(rounded.next_up()) - f64::from(rounded);
    (f64::from(value) - exact).abs() / unit
}

/// The worst error over random arguments stays within the bound: 2 numbers in `f64` (libm's own error included), 2 ulp in
/// `f32`.
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

#[test]
fn sine_and_cosine_are_accurate() {
    let mut random = Random::new(1);
    for range in [1e-3, FRAC_PI_4, PI, 100.0, 1e5] {
        sweep(
            "sin",
            || (random.between(-range, range), 0.0),
            [|x, _| Real::sin(x), |x, _| x.sin()],
            |x, _| Real::sin(x),
        );
        sweep(
            "cos",
            || (random.between(-range, range), 0.0),
            [|x, _| Real::cos(x), |x, _| x.cos()],
            |x, _| Real::cos(x),
        );
    }
    for _ in 0..SAMPLES {
        let x = random.between(-1.6e6, 1.6e6);
        let (sine, cosine) = Real::sin_cos(x);
        assert!(
            distance(sine, x.sin()) <= 2 && distance(cosine, x.cos()) <= 2,
            "{x:e}"
        );
    }
}

/// Where the reduction cancels most: the numbers next to the multiples of π/2.
#[test]
fn sine_and_cosine_are_accurate_at_quarter_turns() {
    for quarters in 1..200_000 {
        let x = f64::from(quarters) * FRAC_PI_2;
        for x in [x.next_down(), x, x.next_up(), -x] {
            let (sine, cosine) = Real::sin_cos(x);
            assert!(
                distance(sine, x.sin()) <= 1 && distance(cosine, x.cos()) <= 1,
                "{x:e}"
            );
        }
        let x = x as f32;
        if x < 1e5 {
            let (sine, cosine) = Real::sin_cos(x);
            let (sine_error, cosine_error) = (
                error_32(sine, f64::from(x).sin()),
                error_32(cosine, f64::from(x).cos()),
            );
            assert!(sine_error <= 1.0 && cosine_error <= 1.0, "{x:e}");
        }
    }
}

#[test]
fn sine_and_cosine_of_large_angles_are_sane() {
    let mut random = Random::new(2);
    for _ in 0..SAMPLES {
        let x =
            f64::powf(2.0, random.between(20.0, 50.0)) * [1.0, -1.0][(random.bits() % 2) as usize];
        let unit = x.abs().next_up() - x.abs();
        let (sine, cosine) = Real::sin_cos(x);
        assert!((sine - x.sin()).abs() <= unit, "{x:e}");
        assert!((cosine - x.cos()).abs() <= unit, "{x:e}");
        assert!(sine.abs() <= 1.0 && cosine.abs() <= 1.0, "{x:e}");
        let x = f64::powf(2.0, random.between(50.0, 1023.0));
        assert_eq!(Real::sin_cos(x), (0.0, 1.0), "{x:e}");
        let x = f64::powf(2.0, random.between(17.0, 21.0)) as f32;
        let unit = f64::from(x.next_up()) - f64::from(x);
        let (sine, cosine) = Real::sin_cos(x);
        assert!(
            (f64::from(sine) - f64::from(x).sin()).abs() <= unit,
            "{x:e}"
        );
        assert!(
            (f64::from(cosine) - f64::from(x).cos()).abs() <= unit,
            "{x:e}"
        );
        assert!(sine.abs() <= 1.0 && cosine.abs() <= 1.0, "{x:e}");
    }
}

#[test]
fn sine_and_cosine_at_the_edges() {
    fn check<S: Scalar>() {
        let (sine, cosine) = Real::sin_cos(S::ZERO);
        assert_eq!((sine.to_f64(), cosine.to_f64()), (0.0, 1.0));
        assert!(Real::sin(-S::ZERO).to_f64().is_sign_negative());
        assert!(Real::sin(S::ZERO).to_f64().is_sign_positive());
        for x in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let (sine, cosine) = Real::sin_cos(S::new(x));
            assert!(sine.to_f64().is_nan() && cosine.to_f64().is_nan());
        }
        let tiny = S::MIN_POSITIVE * S::EPSILON;
        assert_eq!(Real::sin_cos(tiny), (tiny, S::ONE));
        assert!(Real::abs(Real::sin(S::MAX)) <= S::ONE);
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn atan2_is_accurate() {
    let mut random = Random::new(3);
    let mut run = |scale_y: f64, scale_x: f64| {
        sweep(
            "atan2",
            || {
                (
                    random.between(-scale_y, scale_y),
                    random.between(-scale_x, scale_x),
                )
            },
            [Real::atan2, f64::atan2],
            Real::atan2,
        );
    };
    for (scale_y, scale_x) in [
        (1.0, 1.0),
        (0.3, 1.0),
        (1e-9, 1.0),
        (1.0, 1e-9),
        (1e30, 1e20),
    ] {
        run(scale_y, scale_x);
    }
}

#[test]
fn atan2_at_the_edges() {
    let infinity = f64::INFINITY;
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        infinity,
        -infinity,
        f64::NAN,
        f64::MAX,
        -f64::MAX,
        0.6 * f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
    ];
    for y in values {
        for x in values {
            let (got, expected) = (Real::atan2(y, x), y.atan2(x));
            assert!(
                distance(got, expected) <= 1,
                "atan2({y:e}, {x:e}) = {got:e}, not {expected:e}"
            );
            assert!(got.is_nan() || got.is_sign_negative() == y.is_sign_negative());
            let (y, x) = (y as f32, x as f32);
            let (got, expected) = (Real::atan2(y, x), f64::from(y).atan2(f64::from(x)));
            if expected.is_nan() {
                assert!(got.is_nan());
            } else {
                assert!(
                    error_32(got, expected) <= 1.0,
                    "atan2({y:e}, {x:e}) = {got:e} in f32"
                );
            }
        }
    }
    assert_eq!(Real::atan2(0.0, -1.0), PI);
    assert_eq!(Real::atan2(-0.0, -1.0), -PI);
    assert_eq!(Real::atan2(2.0, 0.0), FRAC_PI_2);
    assert_eq!(Real::atan2(3.0, 3.0), FRAC_PI_4);
}

#[test]
fn exp_is_accurate() {
    let mut random = Random::new(4);
    for (low, high) in [
        (-1.0, 1.0),
        (-87.0, 88.0),
        (-708.0, 709.7),
        (-745.0, -708.0),
    ] {
        sweep(
            "exp",
            || (random.between(low, high), 0.0),
            [|x, _| Real::exp(x), |x, _| x.exp()],
            |x, _| Real::exp(x),
        );
    }
}

#[test]
fn exp_at_the_edges() {
    for x in [
        0.0,
        -0.0,
        5e-324,
        -1e-20,
        709.78,
        709.79,
        710.0,
        1e4,
        f64::MAX,
        f64::INFINITY,
        f64::NAN,
    ] {
        assert_eq!(
            distance(Real::exp(x), x.exp()),
            0,
            "exp({x:e}) = {:e}",
            Real::exp(x)
        );
    }
    for x in [
        -745.13,
        -745.14,
        -746.0,
        -750.0,
        -1e4,
        -f64::MAX,
        -f64::INFINITY,
    ] {
        assert_eq!(Real::exp(x), x.exp(), "exp({x:e})");
    }
    for x in [
        0.0f32,
        88.72,
        88.73,
        100.0,
        1e30,
        f32::INFINITY,
        -103.9,
        -104.0,
        -110.0,
        -f32::INFINITY,
    ] {
        let expected = f64::from(x).exp() as f32;
        let got = Real::exp(x);
        assert!(
            got == expected || (got - expected).abs() <= 2.0 * f32::EPSILON * expected,
            "exp({x:e}) = {got:e}"
        );
    }
    assert!(Real::exp(f32::NAN).is_nan());
}

#[test]
fn ln_is_accurate() {
    let mut random = Random::new(5);
    sweep(
        "ln",
        || (random.between(0.3, 3.0), 0.0),
        [|x, _| Real::ln(x), |x, _| x.ln()],
        |x, _| Real::ln(x),
    );
    sweep(
        "ln",
        || (random.between(0.999, 1.001), 0.0),
        [|x, _| Real::ln(x), |x, _| x.ln()],
        |x, _| Real::ln(x),
    );
    sweep(
        "ln",
        || (f64::powf(2.0, random.between(-1074.0, 1023.9)), 0.0),
        [|x, _| Real::ln(x), |x, _| x.ln()],
        |x, _| Real::ln(x),
    );
}

#[test]
fn ln_at_the_edges() {
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        5e-324,
        -5e-324,
        f64::MIN_POSITIVE,
        f64::MAX,
        -f64::MAX,
    ];
    for x in values
        .into_iter()
        .chain([f64::INFINITY, -f64::INFINITY, f64::NAN])
    {
        assert!(
            distance(Real::ln(x), x.ln()) <= 1,
            "ln({x:e}) = {:e}",
            Real::ln(x)
        );
    }
    assert_eq!(Real::ln(1.0f64).to_bits(), 0.0f64.to_bits());
    assert_eq!(Real::ln(0.0f32), f32::NEG_INFINITY);
    assert!(Real::ln(-1.0f32).is_nan());
    assert_eq!(
        Real::ln(f32::from_bits(1)),
        f64::from(f32::from_bits(1)).ln() as f32
    );
}

#[test]
fn powf_is_accurate() {
    let mut random = Random::new(6);
    let functions: [fn(f64, f64) -> f64; 2] = [Real::powf, f64::powf];
    sweep(
        "powf",
        || (random.between(0.0, 1.0), random.between(1.0, 10.0)),
        functions,
        Real::powf,
    );
    sweep(
        "powf",
        || (random.between(0.0, 1e-6), random.between(1.0, 10.0)),
        functions,
        Real::powf,
    );
    sweep(
        "powf",
        || (random.between(0.9, 1.1), random.between(-6000.0, 6000.0)),
        functions,
        Real::powf,
    );
    sweep(
        "powf",
        || {
            (
                f64::powf(2.0, random.between(-1074.0, 1023.0)),
                random.between(-1.0, 1.0),
            )
        },
        functions,
        Real::powf,
    );
    // Results over the whole range of exponents, from every mantissa: here the logarithm's extra digits count.
    sweep(
        "powf",
        || (random.between(0.5, 2.0), random.between(-2000.0, 2000.0)),
        functions,
        Real::powf,
    );
}

#[test]
fn powf_at_the_edges() {
    let bases = [
        0.0,
        5e-324,
        1e-300,
        0.5,
        1.0f64.next_down(),
        1.0,
        1.0f64.next_up(),
        2.0,
        f64::MAX,
        f64::INFINITY,
    ];
    let powers = [
        0.0,
        -0.0,
        5e-324,
        0.5,
        1.0,
        2.0,
        10.0,
        1e4,
        1e17,
        1e19,
        f64::MAX,
        f64::INFINITY,
    ];
    for x in bases {
        for p in powers.into_iter().flat_map(|p| [p, -p]) {
            let (got, expected) = (Real::powf(x, p), x.powf(p));
            assert!(
                distance(got, expected) <= 2,
                "powf({x:e}, {p:e}) = {got:e}, not {expected:e}"
            );
            let (x, p) = (x as f32, p as f32);
            let (got, exact) = (Real::powf(x, p), f64::from(x).powf(f64::from(p)));
            let expected = exact as f32;
            assert!(
                got == expected || error_32(got, exact) <= 2.0,
                "powf({x:e}, {p:e}) = {got:e}, not {expected:e}"
            );
        }
    }
    assert!(Real::powf(-1.0f64, 2.0).is_nan());
    assert!(Real::powf(f64::NAN, 2.0).is_nan());
    assert!(Real::powf(2.0, f64::NAN).is_nan());
    assert_eq!(Real::powf(f64::NAN, 0.0), 1.0);
}

#[test]
fn exponents_split_and_scale_exactly() {
    let mut random = Random::new(7);
    for _ in 0..SAMPLES {
        let x = f64::powf(2.0, random.between(-1022.0, 1024.0));
        let (exponent, mantissa) = x.split_exponent();
        assert!((0.5f64.sqrt()..2.0f64.sqrt()).contains(&mantissa), "{x:e}");
        let half = Real::floor(exponent * 0.5);
        assert_eq!(
            mantissa * half.exp2_integer() * (exponent - half).exp2_integer(),
            x
        );
        let x = x as f32;
        if x.is_normal() {
            let (exponent, mantissa) = x.split_exponent();
            assert!((0.5f32.sqrt()..2.0f32.sqrt()).contains(&mantissa), "{x:e}");
            let half = Real::floor(exponent * 0.5);
            assert_eq!(
                mantissa * half.exp2_integer() * (exponent - half).exp2_integer(),
                x
            );
        }
    }
    for k in -1022..=1023 {
        assert_eq!(f64::from(k).exp2_integer(), f64::powi(2.0, k));
    }
    for k in -126..=127 {
        assert_eq!((k as f32).exp2_integer(), f32::powi(2.0, k));
    }
}
