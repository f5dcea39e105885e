//! Rays and their first hit on a shape.
//!
//! As in MuJoCo, a ray that starts inside a shape hits it where it leaves, and a plane is hit from above only. All
//! normals point out of the shape, whichever side the ray comes from.

pub(crate) mod chord;
pub(crate) mod line;
pub(crate) mod terrain;
mod triangles;
mod unit_ray;

use line::Line;
pub use line::{Hit, Ray};
pub use triangles::{TriangleMesh, TriangleMeshError, TriangleNode};
pub use unit_ray::UnitRay;

use crate::pose::Pose;
use crate::shape::{Shape, Solid};
use clench_math::{Real, kernel};

/// Computes the first hit of a ray on a shape. A zero direction or a number that is not finite hits nothing.
///
/// For rays alone, a plane whose size along x or y is positive ends at that distance from its origin (as MuJoCo draws
/// it). A [`Mesh`](crate::Mesh) is hit on its hull; use [`TriangleMesh`] for its own triangles. A height field is hit
/// on its surface, its sides or its bottom.
///
/// ```
/// use clench_collide::{Pose, Ray, Shape, ShapeKind, ray};
/// use clench_math::Vec3;
///
/// let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.5, 0.0, 0.0));
/// let down = Ray { origin: Vec3::new(0.0, 0.0, 2.0), direction: Vec3::new(0.0, 0.0, -0.1) };
/// let hit = ray(&ball, &Pose::IDENTITY, &down);
/// assert_eq!((hit.distance, hit.normal), (15.0, Vec3::new(0.0, 0.0, 1.0)));
/// let up = Ray { direction: -down.direction, ..down };
/// assert_eq!(ray(&ball, &Pose::IDENTITY, &up).distance, f64::INFINITY);
/// ```
#[kernel]
pub fn ray<T: Real>(shape: &Shape<T>, pose: &Pose<T>, ray: &Ray<T>) -> Hit<T> {
    let (line, unit) = Line::of(pose, ray);
    let (distance, normal) = shape.hit(&line);
    unit.hit(pose, distance, normal)
}
