//! Two balls, and the pairs that reduce to them: sphere–sphere and sphere–capsule.

use super::placed::Placed;
use super::segment::Segment;
use crate::contact::{ContactPoint, Contacts};
use crate::shape::{Capsule, Sphere};
use clench_math::{Mask, Real, Vec3, kernel};

/// A point with a radius: a sphere, or a point on the axis of a capsule.
#[derive(Clone, Copy)]
pub(super) struct Ball<T> {
    pub center: Vec3<T>,
    pub radius: T,
}

/// Adds the contact of two balls in the environments of `wanted`. `across` returns the unit normal for coincident
/// centres.
#[inline(always)]
pub(super) fn ball_ball<T: Real>(
    a: Ball<T>,
    b: Ball<T>,
    across: impl FnOnce() -> Vec3<T>,
    margin: T,
    wanted: T::Mask,
    out: &mut Contacts<T>,
) {
    let offset = b.center - a.center;
    let squared = offset.norm_squared();
    let reach = a.radius + b.radius + margin;
    let active = squared.le(reach * reach) & reach.ge(T::ZERO) & wanted;
    if !active.any() {
        return;
    }
    let length = squared.sqrt();
    let distance = length - a.radius - b.radius;
    let coincident = length.lt(T::new(1e-15));
    let inverse = T::ONE / T::select(coincident, T::ONE, length);
    let mut normal = offset * inverse;
    if coincident.any() {
        normal = Vec3::select(coincident, across(), normal);
    }
    let position = a.center + normal * (a.radius + distance * T::new(0.5));
    out.push(ContactPoint::new(position, normal, distance, active));
}

/// Returns a unit vector across the axes of two shapes. If these are parallel: across them, in the plane of the world's
/// x axis (or y, if they are near x). MuJoCo then uses x itself, which is the same for upright shapes.
#[inline(always)]
pub(super) fn across_axes<A, B, T: Real>(a: Placed<A, T>, b: Placed<B, T>) -> Vec3<T> {
    let axis = b.pose.axis();
    let across = a.pose.axis().cross(axis);
    let parallel = across.norm_squared().lt(T::new(1e-24));
    let x = Vec3::new(T::ONE, T::ZERO, T::ZERO);
    let y = Vec3::new(T::ZERO, T::ONE, T::ZERO);
    let other = Vec3::select(axis.x.abs().gt(T::new(0.9)), y, x);
    let other = other - axis * axis.dot(other);
    Vec3::select(parallel, other, across).normalize().0
}

#[kernel]
pub(super) fn sphere_sphere<T: Real>(
    a: Placed<Sphere<T>, T>,
    b: Placed<Sphere<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let ball = |s: Placed<Sphere<T>, T>| Ball {
        center: s.pose.position,
        radius: s.shape.radius,
    };
    let all = T::Mask::splat(true);
    let across = || a.pose.axis().cross(b.pose.axis()).normalize().0;
    ball_ball(ball(a), ball(b), across, margin, all, out);
}

#[kernel]
pub(super) fn sphere_capsule<T: Real>(
    a: Placed<Sphere<T>, T>,
    b: Placed<Capsule<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let segment = Segment::of(b);
    let center = a.pose.position;
    let along = segment.clamp(segment.axis.dot(center - segment.center));
    let sphere = Ball {
        center,
        radius: a.shape.radius,
    };
    let nearest = Ball {
        center: segment.at(along),
        radius: b.shape.radius,
    };
    let all = T::Mask::splat(true);
    ball_ball(sphere, nearest, || across_axes(a, b), margin, all, out);
}
