//! A fast conservative test of a ray against a sphere.

use super::line::{Ray, Unit};
use crate::broad::allowance;
use clench_math::{Real, Scalar, Vec3};

/// A ray with a unit direction, created once for many bounding spheres.
#[derive(Clone, Copy, Debug)]
pub struct UnitRay<T> {
    origin: Vec3<T>,
    along: Vec3<T>,
    /// The length of the ray's direction, m: the unit of its distances.
    length: T,
}

impl<T: Real> UnitRay<T> {
    /// Normalizes the direction of a ray; a ray without a direction points upwards.
    #[inline(always)]
    pub fn of(ray: &Ray<T>) -> Self {
        let (direction, unit) = Unit::of(ray.direction);
        UnitRay {
            origin: ray.origin,
            along: direction * (T::ONE / unit.length),
            length: unit.length * unit.largest,
        }
    }

    /// Returns the lanes in which the ray may hit a ball within the distance `within`, in lengths of its direction. It
    /// is never false for a hit, whatever the rounding, and may be true for a near miss. It is false if a number is not
    /// finite.
    #[inline(always)]
    pub fn may_intersect(&self, center: Vec3<T>, radius: T, within: T) -> T::Mask {
        let from_origin = center - self.origin;
        let ahead = from_origin.dot(self.along);
        let beside = from_origin - self.along * ahead;
        // The rounding error of values computed from far away.
        let far = from_origin.x.abs() + from_origin.y.abs() + from_origin.z.abs();
        let rounding = far * (T::splat(T::Scalar::EPSILON) * T::new(8.0));
        let radius = radius * allowance() + rounding;
        let nearest = ahead - radius;
        let farthest = within * self.length * allowance();
        beside.norm_squared().le(radius * radius)
            & (ahead + radius).ge(T::ZERO)
            & !nearest.gt(farthest)
    }
}
