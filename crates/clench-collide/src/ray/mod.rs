//! Rays: where they hit a shape first.
//!
//! As in MuJoCo, a ray that begins inside a shape hits it where it leaves, and a plane is hit from above only. All normals
//! point out of the shape, whichever side the ray comes from.

mod chord;
mod flat;
mod line;
mod round;
mod terrain;
mod triangles;
mod unit_ray;

use line::Line;
pub use line::{Hit, Ray};
pub use triangles::{TriangleMesh, TriangleMeshError};
pub use unit_ray::UnitRay;

use crate::{Asset, Pose, Shape, ShapeKind};
use clench_math::{Real, Scalar, Vec3, kernel};

/// Where a ray hits a shape first. A direction without length, and numbers that are not finite, hit nothing.
///
/// A plane whose size along x or y is positive ends there, at so much from its origin, for rays alone (as MuJoCo draws it). A
/// [`ShapeKind::Mesh`] is hit on its hull; [`TriangleMesh`] is for its own triangles. A height field is hit on its
/// surface, its sides or its bottom.
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
    let size = shape.size;
    let (distance, normal) = match shape.kind {
        ShapeKind::Plane => flat::plane(size, &line),
        ShapeKind::Sphere => round::sphere(size, &line),
        ShapeKind::Capsule => round::capsule(size, &line),
        ShapeKind::Ellipsoid => round::ellipsoid(size, &line),
        ShapeKind::Cylinder => round::cylinder(size, &line),
        ShapeKind::Box => flat::cuboid(size, &line),
        ShapeKind::Mesh | ShapeKind::HeightField => {
            each_lane(&line, |origin, along| match shape.asset {
                Asset::Hull(hull) => flat::hull(hull, origin, along),
                Asset::HeightField(field) => terrain::height_field(field, origin, along),
                Asset::None => None,
            })
        }
    };
    unit.hit(pose, distance, normal)
}

/// What branches too much for lanes, for each of them: how far along the line, and the normal, if there is a hit.
fn each_lane<T: Real>(
    line: &Line<T>,
    cast: impl Fn(Vec3<f64>, Vec3<f64>) -> Option<(f64, Vec3<f64>)>,
) -> (T, Vec3<T>) {
    let Hit {
        mut distance,
        mut normal,
    } = Hit::<T>::none();
    for lane in 0..T::LANES {
        let of = |v: Vec3<T>| Vec3::from_array(v.to_array().map(|x| x.lane(lane).to_f64()));
        let (origin, along) = (of(line.origin), of(line.along));
        let finite = (origin + along).to_array().iter().all(|x| x.is_finite());
        if !finite {
            continue;
        }
        if let Some((found, n)) = cast(origin, along) {
            distance.set_lane(lane, T::Scalar::new(found));
            for axis in 0..3 {
                normal[axis].set_lane(lane, T::Scalar::new(n[axis]));
            }
        }
    }
    (distance, normal)
}
