//! Exponential, logarithm, real powers, and the splitting of exponents.

use super::{SAMPLES, distance, error_32, sweep};
use crate::support::Random;
use clench_math::Real;

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
    // Results over the whole range of exponents, from every mantissa: these need the logarithm's extra digits.
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
