//! Dual numbers: values are those of plain numbers, derivatives those of differences.

use clench_math::{Dual, Quat, Real, Vec3};

type Number = Dual<f64, 2>;

fn number(value: f64, tangent: [f64; 2]) -> Number {
    Dual { value, tangent }
}

/// Checks a function of two numbers at a point where it is smooth.
fn check(name: &str, x: f64, y: f64, of: impl Fn(Number, Number) -> Number) {
    let exact = of(number(x, [1.0, 0.0]), number(y, [0.0, 1.0]));
    let value = |x, y| of(number(x, [0.0; 2]), number(y, [0.0; 2])).value;
    assert_eq!(
        exact.value,
        value(x, y),
        "{name} has the value of plain numbers"
    );
    let h = 1e-6;
    let by_x = (value(x + h, y) - value(x - h, y)) / (2.0 * h);
    let by_y = (value(x, y + h) - value(x, y - h)) / (2.0 * h);
    for (exact, difference) in exact.tangent.into_iter().zip([by_x, by_y]) {
        let error = (exact - difference).abs() / (1.0 + difference.abs());
        assert!(
            error < 1e-8,
            "{name}({x}, {y}): {exact} exactly, {difference} by differences"
        );
    }
}

#[test]
fn functions_have_exact_derivatives() {
    for (x, y) in [(0.7, 1.3), (2.5, 0.4), (1.1, 3.2)] {
        check("+", x, y, |x, y| x + y);
        check("-", x, y, |x, y| -x - y);
        check("*", x, y, |x, y| x * y);
        check("/", x, y, |x, y| x / y);
        check("scale", x, y, |x, y| x.scale(3.0) - y.scale(0.5));
        check("sqrt", x, y, |x, y| (x * y).sqrt());
        check("sin_cos", x, y, |x, y| x.sin() * y.cos());
        check("atan2", x, -y, |x, y| x.atan2(y));
        check("exp", x, y, |x, y| (x - y).exp());
        check("ln", x, y, |x, y| (x + y).ln());
        check("powf", x, y, |x, y| x.powf(y));
        check("min", x, y, |x, y| x.min(y) * y);
        check("max", x, y, |x, y| x.max(y) * y);
        check("abs", x, -y, |x, y| x * y.abs());
        check("copysign", x, -y, |x, y| x.copysign(y));
        check("floor", x, y, |x, y| x.floor() * y);
    }
}

#[test]
fn derivatives_are_finite_at_singular_points() {
    let zero = number(0.0, [1.0, 2.0]);
    for result in [
        zero.sqrt(),
        zero.atan2(zero),
        zero.powf(number(0.5, [0.0; 2])),
        zero.powf(number(2.0, [1.0, 0.0])),
    ] {
        assert!(result.tangent.iter().all(|x| x.is_finite()), "{result:?}");
    }
}

/// A number that is zero but has derivatives is not skipped as zero.
#[test]
fn numbers_with_other_derivatives_differ() {
    assert!(!number(0.0, [1.0, 0.0]).eq(Number::ZERO));
    assert!(number(0.0, [0.0; 2]).eq(Number::ZERO));
    assert!(number(1.0, [5.0, 0.0]).le(Number::ONE));
}

#[test]
fn rotations_have_derivatives_where_they_have_no_axis() {
    let rest = Vec3::new(
        number(0.0, [1.0, 0.0]),
        number(0.0, [0.0, 3.0]),
        Number::ZERO,
    );
    let turned = Quat::from_rotation_vector(rest);
    assert_eq!(turned.to_array().map(|x| x.value), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(turned.x.tangent, [0.5, 0.0]);
    assert_eq!(turned.y.tangent, [0.0, 1.5]);
    let back = turned.to_rotation_vector();
    assert_eq!(back.x.tangent, rest.x.tangent);
    assert_eq!(back.y.tangent, rest.y.tangent);
    let half = Quat::IDENTITY.integrate(rest, number(0.5, [0.0; 2]));
    assert_eq!(half.x.tangent, [0.25, 0.0]);
}
