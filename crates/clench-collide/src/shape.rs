//! What collides: a shape, its size and where it is.

use crate::{HeightField, Hull};
use clench_math::{Mat3, Real, Vec3};

/// The kinds of shape, in the order that decides which of two is the first of a pair (MuJoCo's `mjtGeom`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShapeKind {
    /// The half-space below the local xy plane, without bounds. No size, but for rays: see [`ray`](crate::ray()).
    Plane,
    /// Terrain over a rectangle, on a base. Size: half lengths along x and y; a quarter of the elevation and half of the base,
    /// added (as in MuJoCo).
    HeightField,
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
    /// The convex hull of a mesh. Size: how far it reaches from its origin along x, y, z, to either side.
    Mesh,
}

impl ShapeKind {
    /// Every kind, in order.
    pub const ALL: [ShapeKind; 8] = {
        use ShapeKind::*;
        [
            Plane,
            HeightField,
            Sphere,
            Capsule,
            Ellipsoid,
            Cylinder,
            Box,
            Mesh,
        ]
    };
}

/// A shape about its own origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<'a, T> {
    /// What it is.
    pub kind: ShapeKind,
    /// Size in metres, as each [`ShapeKind`] says; numbers that a kind does not use are ignored.
    pub size: Vec3<T>,
    /// What its size does not tell. A mesh without a hull and a height field without heights touch nothing.
    pub asset: Asset<'a>,
}

/// What belongs to a shape besides its size: the same in every environment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Asset<'a> {
    /// Nothing: the size says it all.
    #[default]
    None,
    /// The hull of a [`ShapeKind::Mesh`].
    Hull(&'a Hull),
    /// The heights of a [`ShapeKind::HeightField`].
    HeightField(&'a HeightField),
}

impl<'a, T: Real> Shape<'a, T> {
    /// A shape that its size describes.
    #[inline(always)]
    pub fn new(kind: ShapeKind, size: Vec3<T>) -> Self {
        Shape {
            kind,
            size,
            asset: Asset::None,
        }
    }
    /// A convex hull.
    pub fn mesh(hull: &'a Hull) -> Self {
        Shape {
            kind: ShapeKind::Mesh,
            size: numbers(hull.extent()),
            asset: Asset::Hull(hull),
        }
    }
    /// A height field.
    pub fn height_field(field: &'a HeightField) -> Self {
        let [x, y, elevation, base] = field.size();
        Shape {
            kind: ShapeKind::HeightField,
            size: numbers(Vec3::new(x, y, 0.25 * elevation + 0.5 * base)),
            asset: Asset::HeightField(field),
        }
    }
}

fn numbers<T: Real>(v: Vec3<f64>) -> Vec3<T> {
    Vec3::new(T::new(v.x), T::new(v.y), T::new(v.z))
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

/// The radius in metres of a sphere about the shape's origin that holds it, the smallest where size tells all; infinite for a plane.
#[inline(always)]
pub fn bounding_radius<T: Real>(shape: &Shape<T>) -> T {
    let s = shape.size;
    match shape.kind {
        ShapeKind::Plane => T::new(f64::INFINITY),
        ShapeKind::Sphere => s.x,
        ShapeKind::Capsule => s.x + s.y,
        ShapeKind::Ellipsoid => s.x.max(s.y).max(s.z),
        ShapeKind::Cylinder => (s.x * s.x + s.y * s.y).sqrt(),
        ShapeKind::Box | ShapeKind::Mesh => s.norm(),
        // Neither elevation nor base is more than four times that sum.
        ShapeKind::HeightField => Vec3::new(s.x, s.y, s.z * T::new(4.0)).norm(),
    }
}

/// How far a shape reaches from its origin along a local unit vector d, at most.
///
/// That is its support function: `r + h |d_z|` of a capsule, `|S d|` of an ellipsoid with semi-axes S, `h |d_z| + r √(d_x² + d_y²)` of a
/// cylinder, `Σ hᵢ |dᵢ|` of a box, which here holds meshes and height fields too.
#[inline(always)]
pub(crate) fn reach_along<T: Real>(shape: &Shape<T>, d: Vec3<T>) -> T {
    let s = shape.size;
    match shape.kind {
        ShapeKind::Plane => T::new(f64::INFINITY),
        ShapeKind::Sphere => s.x,
        ShapeKind::Capsule => s.x + s.y * d.z.abs(),
        ShapeKind::Ellipsoid => d.scale_by(s).norm(),
        ShapeKind::Cylinder => s.x * (d.x * d.x + d.y * d.y).sqrt() + s.y * d.z.abs(),
        ShapeKind::Box | ShapeKind::Mesh => s.x * d.x.abs() + s.y * d.y.abs() + s.z * d.z.abs(),
        // Neither elevation nor base is more than four times the size.
        ShapeKind::HeightField => s.x * d.x.abs() + s.y * d.y.abs() + s.z * T::new(4.0) * d.z.abs(),
    }
}
