//! The ellipsoid.

use super::core::{Core, Curvature};
use super::feature::Feature;
use super::solid::{Homogeneous, Solid, about_axes};
use crate::ray::chord::Chord;
use crate::ray::line::Line;
use clench_math::{Double, Real, Scalar, Vec3};
use std::f64::consts::PI;

/// The exponent of Thomsen's formula for the surface of an ellipsoid, as in MuJoCo.
const THOMSEN: f64 = 1.6075;
/// The thickness (m) of the layer that represents an ellipsoid's shell, as in MuJoCo.
const LAYER: f64 = 1e-6;

/// An ellipsoid about the local axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid<T> {
    /// The semi-axes along x, y and z, m.
    pub semi_axes: Vec3<T>,
}

impl<T: Real> Solid<T> for Ellipsoid<T> {
    type InDouble = Ellipsoid<Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Ellipsoid {
            semi_axes: self.semi_axes.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        self.semi_axes
    }

    #[inline(always)]
    fn bounding_radius(&self) -> T {
        let s = self.semi_axes;
        s.x.max(s.y).max(s.z)
    }

    /// Returns |S d|.
    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        d.scale_by(self.semi_axes).norm()
    }

    #[inline(always)]
    fn contains(&self, p: Vec3<T>) -> T::Mask {
        let s = self.semi_axes;
        let scaled = Vec3::new(p.x / s.x, p.y / s.y, p.z / s.z);
        scaled.norm_squared().le(T::ONE)
    }

    /// Scales the ellipsoid to the unit sphere; its normal is the gradient of Σ (xᵢ / sᵢ)².
    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        let (one, s) = (T::ONE, self.semi_axes);
        let inverse = Vec3::new(one / s.x, one / s.y, one / s.z);
        let (along, stretch) = line.along.scale_by(inverse).normalize();
        let scaled = Line {
            origin: line.origin.scale_by(inverse),
            along,
        };
        let (distance, _) = Chord::of_ball(&scaled, Vec3::ZERO, one).first();
        let normal = scaled.at(distance).scale_by(inverse).normalize().0;
        (distance / stretch, normal)
    }
}

/// An ellipsoid less the largest ball that rolls freely in it: ρ = (least semi-axis)² / (largest semi-axis).
#[derive(Clone, Copy, Debug)]
pub(crate) struct EllipsoidCore<S> {
    semi_axes: Vec3<S>,
    radius: S,
}

impl<S: Scalar> Ellipsoid<S> {
    pub(crate) fn core(&self) -> EllipsoidCore<S> {
        let s = self.semi_axes;
        let least = s.x.min(s.y).min(s.z);
        let largest = s.x.max(s.y).max(s.z);
        EllipsoidCore {
            semi_axes: s,
            radius: least * (least / largest.max(S::MIN_POSITIVE)),
        }
    }
}

impl<S: Scalar> Core<S> for EllipsoidCore<S> {
    fn radius(&self) -> S {
        self.radius
    }

    #[inline]
    fn support(&self, d: Vec3<S>, _: Vec3<S>) -> Vec3<S> {
        let s = self.semi_axes;
        let scaled = d.scale_by(s);
        let length = scaled.norm().max(S::MIN_POSITIVE);
        let unit = d * (S::ONE / d.norm().max(S::MIN_POSITIVE));
        scaled.scale_by(s) * (S::ONE / length) - unit * self.radius
    }

    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        Feature::corner(d, self.support(d, d))
    }

    #[inline]
    fn curvature(&self, d: Vec3<S>) -> Curvature<S> {
        let s = self.semi_axes;
        let scaled = d.scale_by(s);
        let inverse = S::ONE / scaled.norm().max(S::MIN_POSITIVE);
        Curvature {
            share: inverse,
            diagonal: s.scale_by(s),
            flat: scaled.scale_by(s) * inverse,
            radius: self.radius,
        }
    }

    fn is_curved(&self) -> bool {
        true
    }

    #[inline]
    fn corner(&self, _: Vec3<S>) -> Vec3<S> {
        Vec3::ZERO
    }
}

impl Homogeneous for Ellipsoid<f64> {
    fn measure(&self, shell: bool) -> f64 {
        let Vec3 { x: a, y: b, z: c } = self.semi_axes;
        if shell {
            let sum = (a * b).powf(THOMSEN) + (b * c).powf(THOMSEN) + (c * a).powf(THOMSEN);
            4.0 * PI * (sum / 3.0).powf(1.0 / THOMSEN)
        } else {
            4.0 * PI * a * b * c / 3.0
        }
    }

    /// Computes the shell as the difference of two solids whose semi-axes differ by [`LAYER`].
    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        let inner = self.semi_axes;
        if !shell {
            return about_axes(inner.scale_by(inner) * (mass / 5.0));
        }
        let outer = inner + Vec3::new(LAYER, LAYER, LAYER);
        let volume = |s: Vec3<f64>| 4.0 * PI * s.x * s.y * s.z / 3.0;
        let density = mass / (volume(outer) - volume(inner));
        let solid = |s: Vec3<f64>| about_axes(s.scale_by(s)) * (volume(s) * density / 5.0);
        solid(outer) - solid(inner)
    }
}
