//! Rays: where they hit a shape first.
//!
//! As in MuJoCo, a ray that begins inside a shape hits it where it leaves, and a plane is hit from above only. All normals
//! point out of the shape, whichever side the ray comes from.

mod chord;
mod flat;
mod round;
mod terrain;
mod triangles;

pub use triangles::{TriangleMesh, TriangleMeshError};

use crate::{Asset, Pose, Shape, ShapeKind};
use clench_math::{Real, Scalar, Vec3, kernel};

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T> {
    /// Where it begins, in world coordinates, m.
    pub origin: Vec3<T>,
    /// Where it leads. Its length is the unit of distances along the ray.
    pub direction: Vec3<T>,
}

/// Where a ray hits a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<T> {
    /// From the origin, in lengths of the ray's direction; infinite where the ray hits nothing.
    pub distance: T,
    /// The unit vector out of the shape there, in world coordinates; zero where the ray hits nothing.
    pub normal: Vec3<T>,
}

impl<T: Real> Hit<T> {
    /// None.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Hit {
            distance: T::new(f64::INFINITY),
            normal: Vec3::ZERO,
        }
    }
}

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

/// A ray in the frame of a shape, with a direction of unit length.
#[derive(Clone, Copy)]
struct Line<T> {
    origin: Vec3<T>,
    along: Vec3<T>,
}

impl<T: Real> Line<T> {
    /// The line of a ray, and what its distances are to be divided by.
    #[inline(always)]
    fn of(pose: &Pose<T>, ray: &Ray<T>) -> (Self, Unit<T>) {
        let (direction, unit) = Unit::of(ray.direction);
        let line = Line {
            origin: pose.local(ray.origin),
            along: pose.rotation.transpose_mul(direction) * (T::ONE / unit.length),
        };
        (line, unit)
    }

    /// The point so far along.
    #[inline(always)]
    fn at(&self, distance: T) -> Vec3<T> {
        self.origin + self.along * distance
    }
}

/// The length of a direction, as a product that neither overflows nor vanishes.
#[derive(Clone, Copy)]
struct Unit<T: Real> {
    /// The largest part of the direction, and its length in units of that.
    largest: T,
    length: T,
    /// Where the direction has a length.
    leads: T::Mask,
}

impl<T: Real> Unit<T> {
    /// A direction in units of its largest part; up, where it has none.
    #[inline(always)]
    fn of(d: Vec3<T>) -> (Vec3<T>, Self) {
        let largest = d.x.abs().max(d.y.abs()).max(d.z.abs());
        let leads = largest.ge(T::splat(T::Scalar::MIN_POSITIVE))
            & d.x.is_finite()
            & d.y.is_finite()
            & d.z.is_finite();
        let largest = T::select(leads, largest, T::ONE);
        let up = Vec3::new(T::ZERO, T::ZERO, T::ONE);
        let scaled = Vec3::new(d.x / largest, d.y / largest, d.z / largest);
        let direction = Vec3::select(leads, scaled, up);
        let unit = Unit {
            largest,
            length: direction.norm(),
            leads,
        };
        (direction, unit)
    }

    /// The hit so far along a line, with a local normal, if it is one.
    #[inline(always)]
    fn hit(&self, pose: &Pose<T>, distance: T, normal: Vec3<T>) -> Hit<T> {
        let normal = pose.rotation * normal;
        let distance = distance / self.length / self.largest;
        let none = Hit::none();
        let is_hit = self.leads
            & distance.ge(T::ZERO)
            & distance.is_finite()
            & normal.norm_squared().gt(T::new(0.5));
        Hit {
            distance: T::select(is_hit, distance, none.distance),
            normal: Vec3::select(is_hit, normal, none.normal),
        }
    }
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
