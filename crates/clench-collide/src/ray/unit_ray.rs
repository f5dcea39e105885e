//! A proof that a ray misses a sphere, without the square roots and divisions of a hit.

use super::line::{Ray, Unit};
use crate::allowance;
use clench_math::{Real, Scalar, Vec3};

/// A ray with a direction of unit length, made once for many bounding spheres.
#[derive(Clone, Copy, Debug)]
pub struct UnitRay<T> {
    origin: Vec3<T>,
    along: Vec3<T>,
    /// The length of the ray's own direction, the unit of its distances, m.
    length: T,
}

impl<T: Real> UnitRay<T> {
    /// The same ray with a unit direction; one without direction leads upwards.
    #[inline(always)]
    pub fn of(ray: &Ray<T>) -> Self {
        let (direction, unit) = Unit::of(ray.direction);
        UnitRay {
            origin: ray.origin,
            along: direction * (T::ONE / unit.length),
            length: unit.length * unit.largest,
        }
    }

    /// Where the ray may meet a ball before it has gone `within`, in lengths of its direction: never false where it does,
    /// whatever the rounding, and where it only passes close by it may be true. False for numbers that are not finite.
    #[inline(always)]
    pub fn may_meet(&self, center: Vec3<T>, radius: T, within: T) -> T::Mask {
        let from_origin = center - self.origin;
        let ahead = from_origin.dot(self.along);
        let beside = from_origin - self.along * ahead;
        // What is computed from far away is known to this rounding only.
        let far = from_origin.x.abs() + from_origin.y.abs() + from_origin.z.abs();
        let rounding = far * (T::splat(T::Scalar::EPSILON) * T::new(8.0));
        let radius = radius * allowance() + rounding;
        let nearest = ahead - radius;
        let farthest_asked = within * self.length * allowance();
        beside.norm_squared().le(radius * radius)
            & (ahead + radius).ge(T::ZERO)
            & !nearest.gt(farthest_asked)
    }
}
