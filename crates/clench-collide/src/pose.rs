//! The pose of a shape.

use clench_math::{Mat3, Real, Vec3};

/// The pose of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// The shape's origin in world coordinates, m.
    pub position: Vec3<T>,
    /// The rotation from local to world coordinates.
    pub rotation: Mat3<T>,
}

impl<T: Real> Pose<T> {
    /// The identity pose.
    pub const IDENTITY: Self = Pose {
        position: Vec3::ZERO,
        rotation: Mat3::IDENTITY,
    };

    /// Returns the pose of lane `i`.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Pose<T::Scalar> {
        let [x, y, z] = self.rotation.rows.map(|row| row.lane(i));
        Pose {
            position: self.position.lane(i),
            rotation: Mat3::from_rows(x, y, z),
        }
    }

    /// Transforms a local point to world coordinates.
    #[inline(always)]
    pub fn point(&self, local: Vec3<T>) -> Vec3<T> {
        self.position + self.rotation * local
    }
    /// Transforms a world point to local coordinates.
    #[inline(always)]
    pub fn local(&self, point: Vec3<T>) -> Vec3<T> {
        self.rotation.transpose_mul(point - self.position)
    }
    /// Returns the local z axis in world coordinates: a plane's normal, the axis of a capsule or cylinder.
    #[inline(always)]
    pub fn axis(&self) -> Vec3<T> {
        self.rotation.column(2)
    }
}
