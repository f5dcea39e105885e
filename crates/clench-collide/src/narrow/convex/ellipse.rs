//! The normals of an ellipse through a point.
//!
//! With C = cos θ and S = sin θ the ellipse is at (C, b S). Its normal there, (b C, S), goes through the point (x, y)
//! if
//!
//! ```text
//! G(θ) = (1 − b²) S C − x S + b y C = 0,      G + G″ = −3 (1 − b²) S C ≤ 0 in the first quarter.
//! ```
//!
//! Being no more curved than a sinusoid, G has at most two roots there, from − to + and from + to −. At the second the
//! gap along the normal is a maximum, and Newton's method with sinusoids for tangents approaches it from the y axis
//! without overshoot.

use clench_math::Scalar;

/// The maximum number of Newton steps. Four are usual.
pub(crate) const STEPS: usize = 16;

/// An ellipse with semi-axes 1 along x and b ≤ 1 along y: an obliquely projected circle.
pub(super) struct Ellipse<S> {
    minor: S,
    /// 1 − b².
    square: S,
}

impl<S: Scalar> Ellipse<S> {
    /// Projects a unit circle whose axis has this cosine and sine to the line of sight.
    pub(super) fn new(cosine: S, sine: S) -> Self {
        Ellipse {
            minor: cosine,
            square: sine * sine,
        }
    }

    /// Returns the unit normal in the first quarter that goes through a point with x ≥ 0 and along which the gap
    /// between ellipse and point has a local maximum, if there is one.
    #[inline]
    pub(super) fn normal_through(&self, (x, y): (S, S)) -> Option<(S, S)> {
        let (square, height) = (self.square, self.minor * y);
        // The first step, from the y axis.
        let (mut cos, mut sin) = (x, square + height);
        for _ in 0..STEPS {
            if sin <= S::ZERO {
                return None;
            }
            let inverse = S::ONE / (cos * cos + sin * sin).sqrt();
            (cos, sin) = (cos * inverse, sin * inverse);
            let value = square * sin * cos - x * sin + height * cos;
            let fall = x * cos + height * sin - square * (cos * cos - sin * sin);
            if fall <= S::ZERO {
                return None;
            }
            // The normal of a flat ellipse turns quickly at its end.
            let turn = cos * cos * self.minor * self.minor + sin * sin;
            let last = value * value <= fall * fall * turn * S::EPSILON;
            (cos, sin) = (cos * fall - sin * value, sin * fall + cos * value);
            if last {
                break;
            }
        }
        let (u, v) = (self.minor * cos, sin);
        let inverse = S::ONE / (u * u + v * v).sqrt();
        Some((u * inverse, v * inverse))
    }
}
