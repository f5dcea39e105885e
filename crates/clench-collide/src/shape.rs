//! What collides: a shape, its size and where it is.

use clench_math::{Mat3, Real, Vec3};

/// The kinds of shape, in the order that decides which of two is the first of a pair (MuJoCo's `mjtGeom`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShapeKind {
    /// The half-space below the local xy plane, without bounds. No size.
    Plane,
    /// Size: radius.
    Sphere,
    /// The points within a radius of a segment on the local z axis. Size: radius, half length of the segment.
    Capsule,
    /// Size: semi-axes along x, y, z.
    Ellipsoid,
    /// About the local z axis. Size: radius, half length.
    Cylinder,
    /// Size: half lengths along x, y, z.
    Box,
}

/// A shape about its own origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<T> {
    /// What it is.
    pub kind: ShapeKind,
    /// Size in metres, as each [`ShapeKind`] says; numbers that a kind does not use are ignored.
    pub size: Vec3<T>,
}

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

/// The radius in metres of the smallest sphere about the shape's origin that holds it; infinite for a plane.
#[inline(always)]
pub fn bounding_radius<T: Real>(shape: &Shape<T>) -> T {
    let s = shape.size;
    match shape.kind {
        ShapeKind::Plane => T::new(f64::INFINITY),
        ShapeKind::Sphere => s.x,
        ShapeKind::Capsule => s.x + s.y,
        ShapeKind::Ellipsoid => s.x.max(s.y).max(s.z),
        ShapeKind::Cylinder => (s.x * s.x + s.y * s.y).sqrt(),
        ShapeKind::Box => s.norm(),
    }
}
