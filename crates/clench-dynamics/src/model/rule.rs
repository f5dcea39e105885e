//! What the numbers of a parameter must be.

use clench_math::Scalar;

/// What the numbers of a field must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Finite.
    Finite,
    /// Positive and finite.
    Positive,
    /// Finite, zero or more.
    NotNegative,
    /// Finite, positive where the model's number is, else zero or more.
    AsModel,
    /// Finite, zero or more where the model's number is positive, else zero.
    IfModel,
    /// Pairs that do not fall, infinite if need be.
    Range,
    /// Quaternions, which are made unit ones.
    Quaternion,
    /// Directions, which are made unit vectors.
    Axis,
    /// It cannot be set: it follows from another field.
    Follows(&'static str),
}

impl Rule {
    /// What a number must be, if it is not.
    pub(super) fn refuses<S: Scalar>(self, x: S, of_model: f64) -> Option<&'static str> {
        let positive = self == Rule::Positive || self == Rule::AsModel && of_model > 0.0;
        let not_negative = matches!(self, Rule::NotNegative | Rule::AsModel | Rule::IfModel);
        let (holds, range) = match self {
            Rule::Range => (!x.to_f64().is_nan(), "a number, or infinite"),
            _ if positive => (x > S::ZERO && x.is_finite(), "positive and finite"),
            Rule::IfModel if of_model <= 0.0 => (x == S::ZERO, "zero, as in the model"),
            _ if not_negative => (x >= S::ZERO && x.is_finite(), "finite, zero or more"),
            _ => (x.is_finite(), "finite"),
        };
        (!holds).then_some(range)
    }
}
