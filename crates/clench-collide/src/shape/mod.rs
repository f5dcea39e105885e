//! What collides: shapes about their own origins. A file each says all that there is to know of one: its size, how far it reaches, what a
//! ray hits, its support function and the face, edge or corner that lies against a plane, its volume and its moments of inertia.
//!
//! Two shapes at once, and where they are, belong to the broad and narrow phase.

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
pub use ellipsoid::Ellipsoid;
pub(crate) use ellipsoid::EllipsoidCore;
pub(crate) use feature::{Feature, MAX_CORNERS, most_level};
pub use mesh::Mesh;
pub use plane::Plane;
pub(crate) use solid::{Homogeneous, Solid};
pub use sphere::Sphere;
pub use terrain::Terrain;

use crate::ray::line::Line;
use crate::{HeightField, Hull};
use clench_math::{Real, Vec3};

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

/// The same expression for every variant of [`Shape`], with the shape in it bound to a name.
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
    /// A shape of this size in metres, as its kind says; numbers that the kind does not use are ignored. A mesh has no hull and a
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
    /// A convex hull.
    pub fn mesh(hull: &'a Hull) -> Self {
        Shape::Mesh(Mesh {
            hull: Some(hull),
            extent: Vec3::from_f64(hull.extent().to_array()),
        })
    }
    /// A height field.
    pub fn height_field(field: &'a HeightField) -> Self {
        let [x, y, elevation, base] = field.size();
        Shape::HeightField(Terrain {
            field: Some(field),
            size: Vec3::from_f64([x, y, 0.25 * elevation + 0.5 * base]),
        })
    }
    /// The same shape with another size: its hull or heights stay what they are.
    pub fn resized<U: Real>(&self, size: Vec3<U>) -> Shape<'a, U> {
        match *self {
            Shape::Mesh(Mesh { hull, .. }) => Shape::Mesh(Mesh { hull, extent: size }),
            Shape::HeightField(Terrain { field, .. }) => {
                Shape::HeightField(Terrain { field, size })
            }
            _ => Shape::new(self.kind(), size),
        }
    }

    /// What it is.
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
    /// Its size in metres, as its kind says.
    #[inline(always)]
    pub fn size(&self) -> Vec3<T> {
        Solid::size(self)
    }
    /// The shape of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Shape<'a, T::Scalar> {
        Solid::lane(self, lane)
    }
    /// The radius in metres of a sphere about the shape's origin that holds it, the smallest where size tells all; infinite for a plane.
    #[inline(always)]
    pub fn bounding_radius(&self) -> T {
        Solid::bounding_radius(self)
    }
    /// Half the lengths of the box about it along its own axes, m; its [`size`](Self::size) where it is a plane or terrain.
    #[inline(always)]
    pub fn half_lengths(&self) -> Vec3<T> {
        Solid::half_lengths(self)
    }
    /// Where a point, in its coordinates, lies in it. In planes and terrain none does.
    #[inline(always)]
    pub fn contains(&self, point: Vec3<T>) -> T::Mask {
        Solid::contains(self, point)
    }
}

impl Shape<'_, f64> {
    /// Volume in m³, or with `shell` the surface in m²; nothing where it is a plane, nor of a mesh, whose own triangles tell more than its
    /// hull. Textbook formulas; where MuJoCo approximates (the shell of an ellipsoid, a height field as a box) so does this.
    pub fn measure(&self, shell: bool) -> f64 {
        self.homogeneous().map_or(0.0, |solid| solid.measure(shell))
    }
    /// Principal moments in kg m² about its origin, along its axes, of a mass in kg that is spread evenly over its volume, or with
    /// `shell` over its surface; nothing where [`measure`](Self::measure) says nothing.
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
    type Alone = Shape<'a, T::Scalar>;

    #[inline(always)]
    fn lane(&self, lane: usize) -> Self::Alone {
        of_each!(self, solid => Shape::from(solid.lane(lane)))
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
