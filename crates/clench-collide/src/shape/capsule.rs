//! The capsule.

use super::core::Core;
use super::cylinder::{solid_cylinder, tube};
use super::feature::{EDGE_SINE, Feature};
use super::solid::{Homogeneous, Solid, axial};
use crate::ray::chord::Chord;
use crate::ray::line::Line;
use clench_math::{Double, Real, Scalar, Vec3};
use std::f64::consts::PI;

/// The points within a radius of a segment on the local z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule<T> {
    /// The radius, m.
    pub radius: T,
    /// Half the length of the segment, m.
    pub half_length: T,
}

impl<T: Real> Solid<T> for Capsule<T> {
    type InDouble = Capsule<Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Capsule {
            radius: self.radius.lane_in_double(lane),
            half_length: self.half_length.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        Vec3::new(self.radius, self.half_length, T::ZERO)
    }

    #[inline(always)]
    fn bounding_radius(&self) -> T {
        self.radius + self.half_length
    }

    /// Returns r + h |d_z|.
    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        self.radius + self.half_length * d.z.abs()
    }

    #[inline(always)]
    fn half_lengths(&self) -> Vec3<T> {
        Vec3::new(self.radius, self.radius, self.radius + self.half_length)
    }

    #[inline(always)]
    fn contains(&self, p: Vec3<T>) -> T::Mask {
        let end = (p.z.abs() - self.half_length).max(T::ZERO);
        (p.x * p.x + p.y * p.y + end * end).le(self.radius.squared())
    }

    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        let (radius, half) = (self.radius, self.half_length);
        let end = |z| Chord::of_ball(line, Vec3::new(T::ZERO, T::ZERO, z), radius);
        let side = Chord::of_tube(line, radius).slab(line, 2, -half, half);
        let (distance, _) = side.or(end(half)).or(end(-half)).first();
        let mut out = line.at(distance);
        out.z -= out.z.clamp(-half, half);
        (distance, out.normalize().0)
    }
}

/// The core is the segment.
impl<S: Scalar> Core<S> for Capsule<S> {
    fn radius(&self) -> S {
        self.radius
    }

    #[inline]
    fn support(&self, _: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        Vec3::new(S::ZERO, S::ZERO, self.half_length.copysign(side.z))
    }

    #[inline]
    fn corner_along(&self, d: Vec3<S>, side: Vec3<S>) -> (Vec3<S>, u32) {
        let end = self.support(d, side);
        (end, u32::from(end.z < S::ZERO))
    }

    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        let end = self.support(d, d);
        if d.z.abs() <= S::new(EDGE_SINE) {
            Feature::edge(d, end, 2)
        } else {
            Feature::corner(d, end)
        }
    }

    fn nearest(&self, point: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        let half = self.half_length;
        Some(Vec3::new(S::ZERO, S::ZERO, point().z.clamp(-half, half)))
    }

    fn edge_axes(&self) -> &'static [usize] {
        &[2]
    }
}

impl Homogeneous for Capsule<f64> {
    fn measure(&self, shell: bool) -> f64 {
        let (radius, height) = (self.radius, 2.0 * self.half_length);
        match shell {
            false => PI * (radius * radius * height + 4.0 * radius * radius * radius / 3.0),
            true => 4.0 * PI * radius * radius + 2.0 * PI * radius * height,
        }
    }

    /// Adds a cylinder and two hemispheres. The centre of mass of a solid hemisphere is 3r/8 from its flat face, so
    /// moving it by h/2 adds m ((h/2 + 3r/8)² − (3r/8)²) = m h (3r + 2h) / 8; that of a hollow one is r/2 from its open
    /// side.
    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        let (radius, half) = (self.radius, self.half_length);
        if shell {
            let caps = mass * radius / (radius + half);
            let sphere = 2.0 * caps * radius * radius / 3.0;
            let moved = caps * half * (half + radius);
            return tube(radius, half, mass - caps) + axial(sphere + moved, sphere);
        }
        let height = 2.0 * half;
        let caps = mass * 4.0 * radius / (4.0 * radius + 3.0 * height);
        let sphere = 2.0 * caps * radius * radius / 5.0;
        let moved = caps * height * (3.0 * radius + 2.0 * height) / 8.0;
        solid_cylinder(radius, half, mass - caps) + axial(sphere + moved, sphere)
    }
}
