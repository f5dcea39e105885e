//! Sine, cosine and the angle of a point.

use super::{SAMPLES, distance, error_32, sweep};
use crate::support::Random;
use clench_math::{Real, Scalar};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

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

/// Checks the numbers next to the multiples of π/2, where the reduction cancels most.
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
