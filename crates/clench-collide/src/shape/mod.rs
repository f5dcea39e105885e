//! Shapes about their own origins. Each file describes one shape: size, extent, ray intersection, support function, the
//! face, edge or corner that lies against a plane, volume and moments of inertia.
//!
//! Pairs of shapes and their poses belong to the broad and narrow phase.

mod capsule;
mod core;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod feature;
mod mesh;
mod plane;
mod solid;
mod sphere;
mod terrain;

pub(crate) use self::core::{Core, Curvature};
pub use capsule::Capsule;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub(crate) use cylinder::TILT;
pub use ellipsoid::Ellipsoid;
pub(crate) use ellipsoid::EllipsoidCore;
pub(crate) use feature::{EDGE_SINE, Feature, MAX_CORNERS, most_level};
pub use mesh::Mesh;
pub(crate) use mesh::{ASIDE, LEVEL, NOTICEABLE, TIE};
pub use plane::Plane;
pub(crate) use solid::{Homogeneous, Solid};
pub use sphere::Sphere;
pub use terrain::Terrain;

use crate::height_field::HeightField;
use crate::hull::Hull;
use crate::ray::line::Line;
use clench_math::{Double, Real, Vec3};

/// The kinds of shape, in the order of the two shapes of a pair (MuJoCo's `mjtGeom`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShapeKind {
    /// The unbounded half-space below the local xy plane. Its size affects only rays: see [`ray`](crate::ray()).
    Plane,
    /// Terrain over a rectangle, on a base. Size: half lengths along x and y; a quarter of the elevation plus half of
    /// the base (as in MuJoCo).
    HeightField,
    /// A sphere. Size: radius.
    Sphere,
    /// The points within a radius of a segment on the local z axis. Size: radius, half length of the segment.
    Capsule,
    /// An ellipsoid. Size: semi-axes along x, y, z.
    Ellipsoid,
    /// A cylinder about the local z axis. Size: radius, half length.
    Cylinder,
    /// A box. Size: half lengths along x, y, z.
    Box,
    /// The convex hull of a mesh. Size: its maximum extent from its origin along x, y, z, to either side.
    Mesh,
}

impl ShapeKind {
    /// All kinds, in order.
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

/// A shape about its own origin, one of each [`ShapeKind`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "each is the shape of its name")]
pub enum Shape<'a, T> {
    Plane(Plane<T>),
    HeightField(Terrain<'a, T>),
    Sphere(Sphere<T>),
    Capsule(Capsule<T>),
    Ellipsoid(Ellipsoid<T>),
    Cylinder(Cylinder<T>),
    Box(Cuboid<T>),
    Mesh(Mesh<'a, T>),
}

/// Evaluates an expression for each variant of [`Shape`], with the shape bound to a name.
macro_rules! of_each {
    ($shape:expr, $solid:ident => $answer:expr) => {
        match $shape {
            Shape::Plane($solid) => $answer,
            Shape::HeightField($solid) => $answer,
            Shape::Sphere($solid) => $answer,
            Shape::Capsule($solid) => $answer,
            Shape::Ellipsoid($solid) => $answer,
            Shape::Cylinder($solid) => $answer,
            Shape::Box($solid) => $answer,
            Shape::Mesh($solid) => $answer,
        }
    };
}

impl<'a, T: Real> Shape<'a, T> {
    /// Creates a shape of a size in metres, as defined by its kind, ignoring unused numbers. A mesh has no hull and a
    /// height field no heights yet.
    #[inline(always)]
    pub fn new(kind: ShapeKind, size: Vec3<T>) -> Self {
        let (radius, half_length) = (size.x, size.y);
        match kind {
            ShapeKind::Plane => Shape::Plane(Plane { size }),
            ShapeKind::HeightField => Shape::HeightField(Terrain { field: None, size }),
            ShapeKind::Sphere => Shape::Sphere(Sphere { radius }),
            ShapeKind::Capsule => Shape::Capsule(Capsule {
                radius,
                half_length,
            }),
            ShapeKind::Ellipsoid => Shape::Ellipsoid(Ellipsoid { semi_axes: size }),
            ShapeKind::Cylinder => Shape::Cylinder(Cylinder {
                radius,
                half_length,
            }),
            ShapeKind::Box => Shape::Box(Cuboid { half_lengths: size }),
            ShapeKind::Mesh => Shape::Mesh(Mesh {
                hull: None,
                extent: size,
            }),
        }
    }
    /// Creates a convex hull.
    pub fn mesh(hull: &'a Hull) -> Self {
        Shape::Mesh(Mesh {
            hull: Some(hull),
            extent: Vec3::from_f64(hull.extent().to_array()),
        })
    }
    /// Creates a height field.
    pub fn height_field(field: &'a HeightField) -> Self {
        let [x, y, elevation, base] = field.size();
        Shape::HeightField(Terrain {
            field: Some(field),
            size: Vec3::from_f64([x, y, 0.25 * elevation + 0.5 * base]),
        })
    }
    /// Returns the shape with another size; hull and heights do not change.
    pub fn resized<U: Real>(&self, size: Vec3<U>) -> Shape<'a, U> {
        match *self {
            Shape::Mesh(Mesh { hull, .. }) => Shape::Mesh(Mesh { hull, extent: size }),
            Shape::HeightField(Terrain { field, .. }) => {
                Shape::HeightField(Terrain { field, size })
            }
            _ => Shape::new(self.kind(), size),
        }
    }

    /// Returns the kind of the shape.
    #[inline(always)]
    pub fn kind(&self) -> ShapeKind {
        match self {
            Shape::Plane(_) => ShapeKind::Plane,
            Shape::HeightField(_) => ShapeKind::HeightField,
            Shape::Sphere(_) => ShapeKind::Sphere,
            Shape::Capsule(_) => ShapeKind::Capsule,
            Shape::Ellipsoid(_) => ShapeKind::Ellipsoid,
            Shape::Cylinder(_) => ShapeKind::Cylinder,
            Shape::Box(_) => ShapeKind::Box,
            Shape::Mesh(_) => ShapeKind::Mesh,
        }
    }
    /// Returns the size in metres, as defined by the kind.
    #[inline(always)]
    pub fn size(&self) -> Vec3<T> {
        Solid::size(self)
    }
    /// Returns the shape of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Shape<'a, T::Scalar> {
        self.resized(self.size().lane(lane))
    }
    /// Returns the radius in metres of a sphere about the origin that encloses the shape, the smallest if the size
    /// defines it; infinite for a plane.
    #[inline(always)]
    pub fn bounding_radius(&self) -> T {
        Solid::bounding_radius(self)
    }
    /// Returns half the lengths of the bounding box along the shape's axes, m; the [`size`](Self::size) of a plane or
    /// terrain.
    #[inline(always)]
    pub fn half_lengths(&self) -> Vec3<T> {
        Solid::half_lengths(self)
    }
    /// Returns the lanes in which the shape contains a local point; none for planes and terrain.
    #[inline(always)]
    pub fn contains(&self, point: Vec3<T>) -> T::Mask {
        Solid::contains(self, point)
    }
}

impl Shape<'_, f64> {
    /// Computes the volume in m³, or with `shell` the surface area in m²; zero for a plane, and for a mesh, which has
    /// more accurate triangles. Exact, except where MuJoCo approximates (the shell of an ellipsoid, a height field as a
    /// box).
    pub fn measure(&self, shell: bool) -> f64 {
        self.homogeneous().map_or(0.0, |solid| solid.measure(shell))
    }
    /// Computes the principal moments of inertia in kg m² about the origin, along the axes, of a mass in kg distributed
    /// evenly over the volume, or with `shell` over the surface; zero where [`measure`](Self::measure) is.
    pub fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        self.homogeneous()
            .map_or(Vec3::ZERO, |solid| solid.moments(mass, shell))
    }

    fn homogeneous(&self) -> Option<&dyn Homogeneous> {
        Some(match self {
            Shape::Plane(_) | Shape::Mesh(_) => return None,
            Shape::HeightField(terrain) => terrain,
            Shape::Sphere(sphere) => sphere,
            Shape::Capsule(capsule) => capsule,
            Shape::Ellipsoid(ellipsoid) => ellipsoid,
            Shape::Cylinder(cylinder) => cylinder,
            Shape::Box(cuboid) => cuboid,
        })
    }
}

impl<'a, T: Real> Solid<T> for Shape<'a, T> {
    type InDouble = Shape<'a, Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        of_each!(self, solid => Shape::from(solid.lane_in_double(lane)))
    }
    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        of_each!(self, solid => solid.size())
    }
    #[inline(always)]
    fn bounding_radius(&self) -> T {
        of_each!(self, solid => solid.bounding_radius())
    }
    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        of_each!(self, solid => solid.reach_along(d))
    }
    #[inline(always)]
    fn half_lengths(&self) -> Vec3<T> {
        of_each!(self, solid => solid.half_lengths())
    }
    #[inline(always)]
    fn contains(&self, point: Vec3<T>) -> T::Mask {
        of_each!(self, solid => solid.contains(point))
    }
    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        of_each!(self, solid => solid.hit(line))
    }
}

macro_rules! any {
    ($($variant:ident($solid:ty)),* $(,)?) => {
        $(impl<'a, T> From<$solid> for Shape<'a, T> {
            #[inline(always)]
            fn from(solid: $solid) -> Self {
                Shape::$variant(solid)
            }
        })*
    };
}

any! {
    Plane(Plane<T>),
    HeightField(Terrain<'a, T>),
    Sphere(Sphere<T>),
    Capsule(Capsule<T>),
    Ellipsoid(Ellipsoid<T>),
    Cylinder(Cylinder<T>),
    Box(Cuboid<T>),
    Mesh(Mesh<'a, T>),
}
