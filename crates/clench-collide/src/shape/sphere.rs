//! The sphere.

use super::core::Core;
use super::feature::Feature;
use super::solid::{Homogeneous, Solid};
use crate::ray::chord::Chord;
use crate::ray::line::Line;
use clench_math::{Double, Real, Scalar, Vec3};
use std::f64::consts::PI;

/// The points within a radius of the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<T> {
    /// The radius, m.
    pub radius: T,
}

impl<T: Real> Solid<T> for Sphere<T> {
    type InDouble = Sphere<Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Sphere {
            radius: self.radius.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        Vec3::new(self.radius, T::ZERO, T::ZERO)
    }

    #[inline(always)]
    fn bounding_radius(&self) -> T {
        self.radius
    }

    #[inline(always)]
    fn reach_along(&self, _: Vec3<T>) -> T {
        self.radius
    }

    #[inline(always)]
    fn half_lengths(&self) -> Vec3<T> {
        Vec3::new(self.radius, self.radius, self.radius)
    }

    #[inline(always)]
    fn contains(&self, point: Vec3<T>) -> T::Mask {
        point.norm_squared().le(self.radius.squared())
    }

    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        let (distance, _) = Chord::of_ball(line, Vec3::ZERO, self.radius).first();
        (distance, line.at(distance).normalize().0)
    }
}

/// The core is the centre.
impl<S: Scalar> Core<S> for Sphere<S> {
    fn radius(&self) -> S {
        self.radius
    }

    #[inline]
    fn support(&self, _: Vec3<S>, _: Vec3<S>) -> Vec3<S> {
        Vec3::ZERO
    }

    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        Feature::corner(d, Vec3::ZERO)
    }

    fn is_point(&self) -> bool {
        true
    }
}

impl Homogeneous for Sphere<f64> {
    fn measure(&self, shell: bool) -> f64 {
        let r = self.radius;
        match shell {
            false => 4.0 * PI * r * r * r / 3.0,
            true => 4.0 * PI * r * r,
        }
    }

    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        let share = if shell { 3.0 } else { 5.0 };
        let moment = 2.0 * mass * self.radius * self.radius / share;
        Vec3::new(moment, moment, moment)
    }
}
