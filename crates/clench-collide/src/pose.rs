//! Where a shape is.

use clench_math::{Mat3, Real, Vec3};

/// Where a shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// Its origin in the world, m.
    pub position: Vec3<T>,
    /// Local to world coordinates.
    pub rotation: Mat3<T>,
}

impl<T: Real> Pose<T> {
    /// At the origin, not turned.
    pub const IDENTITY: Self = Pose {
        position: Vec3::ZERO,
        rotation: Mat3::IDENTITY,
    };

    /// The pose of lane `i`.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Pose<T::Scalar> {
        let [x, y, z] = self.rotation.rows.map(|row| row.lane(i));
        Pose {
            position: self.position.lane(i),
            rotation: Mat3::from_rows(x, y, z),
        }
    }

    /// The world coordinates of a local point.
    #[inline(always)]
    pub fn point(&self, local: Vec3<T>) -> Vec3<T> {
        self.position + self.rotation * local
    }
    /// The local coordinates of a world point.
    #[inline(always)]
    pub fn local(&self, point: Vec3<T>) -> Vec3<T> {
        self.rotation.transpose_mul(point - self.position)
    }
    /// The local z axis in the world: a plane's normal, the axis of a capsule or cylinder.
    #[inline(always)]
    pub fn axis(&self) -> Vec3<T> {
        self.rotation.column(2)
    }
}
