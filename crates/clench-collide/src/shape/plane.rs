//! The half-space below a plane.

use super::solid::Solid;
use crate::ray::line::Line;
use clench_math::{Double, Mask, Real, Vec3};

/// The unbounded half-space below the local xy plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<T> {
    /// The extent of the plane along x and y for rays alone, if positive, m.
    pub size: Vec3<T>,
}

impl<T: Real> Solid<T> for Plane<T> {
    type InDouble = Plane<Double<T>>;

    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Plane {
            size: self.size.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        self.size
    }

    #[inline(always)]
    fn bounding_radius(&self) -> T {
        T::new(f64::INFINITY)
    }

    #[inline(always)]
    fn reach_along(&self, _: Vec3<T>) -> T {
        T::new(f64::INFINITY)
    }

    #[inline(always)]
    fn contains(&self, _: Vec3<T>) -> T::Mask {
        T::Mask::splat(false)
    }

    /// Computes a hit from above, within the rectangle defined by positive sizes.
    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        let down = line.along.z.lt(T::ZERO);
        let distance = -line.origin.z / T::select(down, line.along.z, T::ONE);
        let p = line.at(distance);
        let within = |x: T, half: T| half.le(T::ZERO) | x.abs().le(half);
        let hit = down & within(p.x, self.size.x) & within(p.y, self.size.y);
        let up = Vec3::new(T::ZERO, T::ZERO, T::ONE);
        (T::select(hit, distance, T::new(f64::INFINITY)), up)
    }
}
