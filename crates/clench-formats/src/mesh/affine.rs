//! Affine maps of points: the pose and scale of a scene node in its parent.

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

    /// Creates a scaling along the axes.
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

    pub(super) fn rotation(rotation: Quat<f64>) -> Self {
        Transform {
            linear: rotation.to_matrix(),
            ..Self::IDENTITY
        }
    }

    /// Creates a map from four rows, the last 0 0 0 1.
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

    /// Returns true if the map reverses handedness and so turns faces inside out.
    pub(super) fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

impl Mul for Transform {
    type Output = Transform;

    /// Composes the maps: applies `inner` first.
    fn mul(self, inner: Transform) -> Transform {
        Transform {
            linear: self.linear * inner.linear,
            offset: self.point(inner.offset),
        }
    }
}

/// Rounds a point to single precision, that of mesh files.
pub(super) fn to_single(point: Vec3<f64>) -> Vec3<f64> {
    Vec3::from_array(point.to_array().map(|x| f64::from(x as f32)))
}
