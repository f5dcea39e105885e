//! A cached direction that separated two shapes and may do so again.
//!
//! Along a unit direction d from the first shape to the second the gap between them is d·(p_b − p_a) − s_a(d) −
//! s_b(−d), where s are their support functions. No gap exceeds their distance, so a gap beyond the margin proves
//! separation, wherever the direction comes from. It is accepted only if it exceeds the margin by more than the error
//! of a search. So a cached direction only skips a search that would find nothing, and changes no result.

use super::placed::AnyPlaced;
use crate::contact::set_lane;
use crate::hull::Hull;
use crate::shape::{Mesh, Shape, Solid};
use clench_math::{Double, Mask, Real, Scalar, Vec3};

/// The error of a search relative to the smaller shape, twice what the search itself allows ...
const SLACK: f64 = 4e-6;
/// ... plus this multiple of the rounding error of the largest coordinate.
const SLACK_UNITS: f64 = 256.0;

/// The direction that last separated two shapes, in each lane. [`collide_again`](crate::collide_again) uses and updates
/// it. Any unit vector is valid, and none changes a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparatingAxis<T> {
    /// The direction in the frame of the first shape, or of the world if that is a sphere.
    direction: Vec3<T>,
}

impl<T: Real> Default for SeparatingAxis<T> {
    fn default() -> Self {
        let direction = Vec3::new(T::ONE, T::ZERO, T::ZERO);
        SeparatingAxis { direction }
    }
}

impl<T: Real> SeparatingAxis<T> {
    /// Converts the direction to another number type.
    pub(crate) fn map<U: Real>(&self, f: impl Fn(T) -> U) -> SeparatingAxis<U> {
        let Vec3 { x, y, z } = self.direction;
        let direction = Vec3::new(f(x), f(y), f(z));
        SeparatingAxis { direction }
    }

    /// Returns the lanes with the shapes certainly more than `margin` apart; tests bounding boxes before hulls.
    #[inline(always)]
    pub(super) fn separates(&self, a: AnyPlaced<T>, b: AnyPlaced<T>, margin: T) -> T::Mask {
        let along = match a.shape {
            Shape::Sphere(_) => self.direction,
            _ => a.pose.rotation * self.direction,
        };
        let offset = b.pose.position - a.pose.position;
        let back = -b.pose.rotation.transpose_mul(along);
        let centers = along.dot(offset);
        let (size_a, size_b) = (a.shape.bounding_radius(), b.shape.bounding_radius());
        let largest = size_a + size_b + offset.x.abs() + offset.y.abs() + offset.z.abs();
        let rounding = T::splat(T::Scalar::EPSILON) * T::new(SLACK_UNITS);
        let slack = size_a.min(size_b) * T::new(SLACK) + largest * rounding;
        let least = margin + slack;
        let by_boxes = centers - a.shape.reach_along(self.direction) - b.shape.reach_along(back);
        let far = by_boxes.gt(least);
        let open = !far;
        if !open.any() || (hull(&a.shape).is_none() && hull(&b.shape).is_none()) {
            return far;
        }
        let reach = support(&a.shape, self.direction, open) + support(&b.shape, back, open);
        far | (open & (centers - reach).gt(least))
    }

    /// Replaces the direction in some lanes, if the new one is a unit vector.
    #[inline(always)]
    pub(super) fn renew(&mut self, lanes: T::Mask, direction: Vec3<T>) {
        let taken = lanes & is_unit(direction);
        self.direction = Vec3::select(taken, direction, self.direction);
    }

    /// Stores the direction found by a search for a lane, if it is a unit vector.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, direction: Vec3<Double<T>>) {
        if is_unit(direction).any() {
            set_lane(&mut self.direction, lane, Vec3::from_double(direction));
        }
    }
}

/// Tests for a unit vector. A degenerate pair could yield zero, along which any two shapes are 0 apart.
#[inline(always)]
fn is_unit<T: Real>(direction: Vec3<T>) -> T::Mask {
    (direction.norm_squared() - T::ONE).abs().lt(T::new(1e-3))
}

/// Returns the support function of a bounded convex shape along a local unit direction, in some lanes.
#[inline(always)]
fn support<T: Real>(shape: &Shape<T>, d: Vec3<T>, lanes: T::Mask) -> T {
    let Some(hull) = hull(shape) else {
        return shape.reach_along(d);
    };
    let mut reach = T::ZERO;
    for lane in (0..T::LANES).filter(|&lane| lanes.lane(lane)) {
        let d = [d.x, d.y, d.z].map(|x| x.lane(lane).to_f64());
        reach.set_lane(lane, T::Scalar::new(hull_reach(hull, Vec3::from_array(d))));
    }
    reach
}

#[inline(always)]
fn hull<'a, T>(shape: &Shape<'a, T>) -> Option<&'a Hull> {
    match shape {
        Shape::Mesh(Mesh { hull, .. }) => *hull,
        _ => None,
    }
}

/// Returns the support function of a hull.
fn hull_reach(hull: &Hull, d: Vec3<f64>) -> f64 {
    hull.vertices()[hull.support(d)].dot(d)
}
