//! The cylinder.

use super::core::{Core, Curvature, radial_direction};
use super::feature::{EDGE_SINE, Feature};
use super::solid::{Homogeneous, Solid, axial};
use crate::hull::FACE_COSINE;
use crate::ray::chord::Chord;
use crate::ray::line::Line;
use clench_math::{Double, Real, Scalar, Vec3};
use std::f64::consts::PI;

/// The tilt below which a cap is level to rounding: all its corners are equally deep.
pub(crate) const TILT: f64 = 5e-6;

/// A cylinder about the local z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder<T> {
    /// The radius, m.
    pub radius: T,
    /// Half the length, m.
    pub half_length: T,
}

impl<T: Real> Solid<T> for Cylinder<T> {
    type InDouble = Cylinder<Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Cylinder {
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
        (self.radius * self.radius + self.half_length * self.half_length).sqrt()
    }

    /// Returns h |d_z| + r √(d_x² + d_y²).
    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        self.radius * (d.x * d.x + d.y * d.y).sqrt() + self.half_length * d.z.abs()
    }

    #[inline(always)]
    fn half_lengths(&self) -> Vec3<T> {
        Vec3::new(self.radius, self.radius, self.half_length)
    }

    #[inline(always)]
    fn contains(&self, p: Vec3<T>) -> T::Mask {
        let level = p.x * p.x + p.y * p.y;
        level.le(self.radius.squared()) & p.z.abs().le(self.half_length)
    }

    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        let tube = Chord::of_tube(line, self.radius);
        let side = |distance: T| {
            let p = line.at(distance);
            Vec3::new(p.x, p.y, T::ZERO).normalize().0
        };
        let tube = Chord {
            entry_normal: side(tube.entry),
            exit_normal: side(tube.exit),
            ..tube
        };
        tube.slab(line, 2, -self.half_length, self.half_length)
            .first()
    }
}

impl<S: Scalar> Cylinder<S> {
    /// Returns the upper or lower cap: corners at equal angles, the first at the deepest point of its circle. They
    /// ignore a tilt within rounding, so that a standing cylinder stays at rest.
    fn cap_feature(&self, d: Vec3<S>) -> Feature<S> {
        let mut feature = Feature::along(d);
        let (r, up) = (self.radius, S::ONE.copysign(d.z));
        feature.normal = Vec3::new(S::ZERO, S::ZERO, up);
        feature.radius = Some(r);
        let tilted = (d.x * d.x + d.y * d.y).sqrt() > S::new(TILT);
        let (x, y) = if tilted {
            radial_direction(d)
        } else {
            (S::ONE, S::ZERO)
        };
        for (cosine, sine) in CAP_CIRCLE {
            let (cosine, sine) = (S::new(cosine) * r, S::new(sine) * r * up);
            feature.corners.push(Vec3::new(
                x * cosine - y * sine,
                y * cosine + x * sine,
                self.half_length * up,
            ));
        }
        feature
    }
}

impl<S: Scalar> Core<S> for Cylinder<S> {
    #[inline]
    fn support(&self, d: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        let (x, y) = radial_direction(d);
        Vec3::new(
            x * self.radius,
            y * self.radius,
            self.half_length.copysign(side.z),
        )
    }

    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        let upward = d.z.abs();
        if upward >= S::new(FACE_COSINE) {
            self.cap_feature(d)
        } else if upward <= S::new(EDGE_SINE) {
            Feature::edge(d, self.support(d, d), 2)
        } else {
            Feature::corner(d, self.support(d, d))
        }
    }

    #[inline]
    fn curvature(&self, d: Vec3<S>) -> Curvature<S> {
        let (x, y) = radial_direction(d);
        let level = (d.x * d.x + d.y * d.y).sqrt().max(S::EPSILON);
        Curvature {
            share: -self.radius / level,
            flat: Vec3::new(-y, x, S::ZERO),
            ..Curvature::NONE
        }
    }

    fn is_curved(&self) -> bool {
        true
    }

    fn nearest(&self, point: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        let (p, half) = (point(), self.half_length);
        let level = (p.x * p.x + p.y * p.y).sqrt();
        let share = (self.radius / level.max(S::MIN_POSITIVE)).min(S::ONE);
        Some(Vec3::new(p.x * share, p.y * share, p.z.clamp(-half, half)))
    }

    #[inline]
    fn corner(&self, point: Vec3<S>) -> Vec3<S> {
        Vec3::new(S::ZERO, S::ZERO, point.z)
    }

    fn cap(&self) -> Option<S> {
        Some(self.radius)
    }

    fn edge_axes(&self) -> &'static [usize] {
        &[2]
    }

    fn face_axes(&self) -> &'static [usize] {
        &[2]
    }
}

impl Homogeneous for Cylinder<f64> {
    fn measure(&self, shell: bool) -> f64 {
        let (radius, height) = (self.radius, 2.0 * self.half_length);
        match shell {
            false => PI * radius * radius * height,
            true => 2.0 * PI * radius * radius + 2.0 * PI * radius * height,
        }
    }

    /// Computes the shell from a tube and two discs.
    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        let (radius, half) = (self.radius, self.half_length);
        if !shell {
            return solid_cylinder(radius, half, mass);
        }
        let discs = mass * radius / (radius + 2.0 * half);
        let (rr, hh) = (radius * radius, half * half);
        tube(radius, half, mass - discs) + axial(discs * (rr / 4.0 + hh), discs * rr / 2.0)
    }
}

/// Returns the moments of a solid cylinder.
pub(super) fn solid_cylinder(radius: f64, half_length: f64, mass: f64) -> Vec3<f64> {
    let (rr, hh) = (radius * radius, half_length * half_length);
    axial(mass * (3.0 * rr + 4.0 * hh) / 12.0, mass * rr / 2.0)
}

/// Returns the moments of the curved surface of a cylinder.
pub(super) fn tube(radius: f64, half_length: f64, mass: f64) -> Vec3<f64> {
    let (rr, hh) = (radius * radius, half_length * half_length);
    axial(mass * (6.0 * rr + 4.0 * hh) / 12.0, mass * rr)
}

/// Sixteen directions around a circle.
const CAP_CIRCLE: [(f64, f64); 16] = {
    // Cosine and sine of 22.5°, 45° and 67.5°.
    const C: f64 = 0.923_879_532_511_286_7;
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const S: f64 = 0.382_683_432_365_089_8;
    [
        (1.0, 0.0),
        (C, S),
        (D, D),
        (S, C),
        (0.0, 1.0),
        (-S, C),
        (-D, D),
        (-C, S),
        (-1.0, 0.0),
        (-C, -S),
        (-D, -D),
        (-S, -C),
        (0.0, -1.0),
        (S, -C),
        (D, -D),
        (C, -S),
    ]
};
