//! Affine maps of points: how a node of a scene stands in the one around it.

use clench_math::{Mat3, Quat, Vec3};
use std::ops::Mul;

/// An affine map of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transform {
    linear: Mat3<f64>,
    offset: Vec3<f64>,
}

impl Transform {
    pub(super) const IDENTITY: Transform = Transform {
        linear: Mat3::IDENTITY,
        offset: Vec3::ZERO,
    };

    /// Scales along the axes.
    pub(super) fn scaling(factors: [f64; 3]) -> Self {
        Transform {
            linear: Mat3::diagonal(Vec3::from_array(factors)),
            ..Self::IDENTITY
        }
    }

    pub(super) fn translation(offset: [f64; 3]) -> Self {
        Transform {
            offset: Vec3::from_array(offset),
            ..Self::IDENTITY
        }
    }

    pub(super) fn rotation(turn: Quat<f64>) -> Self {
        Transform {
            linear: turn.to_matrix(),
            ..Self::IDENTITY
        }
    }

    /// A matrix of four rows, whose last is 0 0 0 1.
    pub(super) fn from_rows(rows: [[f64; 4]; 4]) -> Self {
        let row = |i: usize| [rows[i][0], rows[i][1], rows[i][2]];
        Transform {
            linear: Mat3::from_f64([row(0), row(1), row(2)]),
            offset: Vec3::from_array([rows[0][3], rows[1][3], rows[2][3]]),
        }
    }

    pub(super) fn point(&self, point: Vec3<f64>) -> Vec3<f64> {
        self.linear * point + self.offset
    }

    /// Whether it turns right hands into left ones, and so faces inside out.
    pub(super) fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

impl Mul for Transform {
    type Output = Transform;

    /// First `inner`, then this.
    fn mul(self, inner: Transform) -> Transform {
        Transform {
            linear: self.linear * inner.linear,
            offset: self.point(inner.offset),
        }
    }
}

/// A point rounded to single precision, in which mesh files have theirs.
pub(super) fn to_single(point: Vec3<f64>) -> Vec3<f64> {
    Vec3::from_array(point.to_array().map(|x| f64::from(x as f32)))
}
