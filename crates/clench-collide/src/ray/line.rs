//! Rays, what they hit, and a ray in the frame of a shape.

use crate::Pose;
use clench_math::{Real, Scalar, Vec3};

/// A ray in the frame of a shape, with a direction of unit length.
#[derive(Clone, Copy)]
pub(super) struct Line<T> {
    pub(super) origin: Vec3<T>,
    pub(super) along: Vec3<T>,
}

impl<T: Real> Line<T> {
    /// The line of a ray, and what its distances are to be divided by.
    #[inline(always)]
    pub(super) fn of(pose: &Pose<T>, ray: &Ray<T>) -> (Self, Unit<T>) {
        let (direction, unit) = Unit::of(ray.direction);
        let line = Line {
            origin: pose.local(ray.origin),
            along: pose.rotation.transpose_mul(direction) * (T::ONE / unit.length),
        };
        (line, unit)
    }

    /// The point so far along.
    #[inline(always)]
    pub(super) fn at(&self, distance: T) -> Vec3<T> {
        self.origin + self.along * distance
    }
}

/// The length of a direction, as a product that neither overflows nor vanishes.
#[derive(Clone, Copy)]
pub(super) struct Unit<T: Real> {
    /// The largest part of the direction, and its length in units of that.
    pub(super) largest: T,
    pub(super) length: T,
    /// Where the direction has a length.
    leads: T::Mask,
}

impl<T: Real> Unit<T> {
    /// A direction in units of its largest part; up, where it has none.
    #[inline(always)]
    pub(super) fn of(d: Vec3<T>) -> (Vec3<T>, Self) {
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
    pub(super) fn hit(&self, pose: &Pose<T>, distance: T, normal: Vec3<T>) -> Hit<T> {
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
