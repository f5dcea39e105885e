//! The rules of the numbers of parameters.

use clench_math::Scalar;

/// The rule of the numbers of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Finite.
    Finite,
    /// Positive and finite.
    Positive,
    /// Finite, zero or more.
    NotNegative,
    /// Finite, positive if the model's number is, else zero or more.
    AsModel,
    /// Finite, zero or more if the model's number is positive, else zero.
    IfModel,
    /// Pairs in ascending order, possibly infinite.
    Range,
    /// Quaternions, which are normalized.
    Quaternion,
    /// Directions, which are normalized.
    Axis,
    /// Not settable: it follows from another field.
    Follows(&'static str),
}

impl Rule {
    /// Returns the required range of a number that is outside it.
    pub(super) fn refuses<S: Scalar>(self, x: S, of_model: f64) -> Option<&'static str> {
        let positive = || (x > S::ZERO && x.is_finite(), "positive and finite");
        let (holds, range) = match self {
            Rule::Range => (!x.to_f64().is_nan(), "a number, or infinite"),
            Rule::Positive => positive(),
            Rule::AsModel if of_model > 0.0 => positive(),
            Rule::IfModel if of_model <= 0.0 => (x == S::ZERO, "zero, as in the model"),
            Rule::NotNegative | Rule::AsModel | Rule::IfModel => {
                (x >= S::ZERO && x.is_finite(), "finite, zero or more")
            }
            Rule::Finite | Rule::Quaternion | Rule::Axis | Rule::Follows(_) => {
                (x.is_finite(), "finite")
            }
        };
        (!holds).then_some(range)
    }
}
