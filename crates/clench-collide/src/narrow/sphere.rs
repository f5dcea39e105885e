//! Spheres and the ends of capsules: every pair that comes down to two balls, or a ball above a plane.

use crate::{
    ContactPoint, Contacts, Pose, Shape,
    frame::{frame_along, frame_from_normal},
};
use clench_math::{Real, Vec3};

/// Two balls. `fallback` is the unit normal to use where the centres coincide.
#[inline(always)]
pub(super) fn ball_ball<T: Real>(
    (center_a, radius_a): (Vec3<T>, T),
    (center_b, radius_b): (Vec3<T>, T),
    fallback: impl FnOnce() -> Vec3<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    use clench_math::Mask;
    let offset = center_b - center_a;
    let reach = radius_a + radius_b + margin;
    let active = offset.norm_squared().le(reach * reach);
    if !active.any() {
        return;
    }
    let (mut normal, length) = offset.normalize();
    let coincident = length.lt(T::new(1e-15));
    if coincident.any() {
        normal = Vec3::select(coincident, fallback(), normal);
    }
    let distance = length - radius_a - radius_b;
    out.push(ContactPoint {
        position: center_a + normal * (radius_a + distance * T::new(0.5)),
        frame: frame_from_normal(normal),
        distance,
        active,
    });
}

/// The unit vector orthogonal to the axes of two shapes, or x where they are parallel.
#[inline(always)]
pub(super) fn across_axes<T: Real>(pose_a: &Pose<T>, pose_b: &Pose<T>) -> Vec3<T> {
    pose_a.axis().cross(pose_b.axis()).normalize().0
}

/// A ball above (or in) the half-space of a plane; `along` directs the first tangent.
#[inline(always)]
fn plane_ball<T: Real>(
    plane: &Pose<T>,
    center: Vec3<T>,
    radius: T,
    along: Option<Vec3<T>>,
    margin: T,
    out: &mut Contacts<T>,
) {
    use clench_math::Mask;
    let normal = plane.axis();
    let distance = normal.dot(center - plane.position) - radius;
    let active = distance.le(margin);
    if !active.any() {
        return;
    }
    out.push(ContactPoint {
        position: center - normal * (radius + distance * T::new(0.5)),
        frame: match along {
            Some(direction) => frame_along(normal, direction),
            None => frame_from_normal(normal),
        },
        distance,
        active,
    });
}

pub(super) fn plane_sphere<T: Real>(
    plane: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    plane_ball(plane, pose_b.position, b.size.x, None, margin, out);
}

pub(super) fn plane_capsule<T: Real>(
    plane: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let axis = pose_b.axis();
    let half = axis * b.size.y;
    for center in [pose_b.position + half, pose_b.position - half] {
        plane_ball(plane, center, b.size.x, Some(axis), margin, out);
    }
}

pub(super) fn sphere_sphere<T: Real>(
    a: &Shape<T>,
    pose_a: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    ball_ball(
        (pose_a.position, a.size.x),
        (pose_b.position, b.size.x),
        || across_axes(pose_a, pose_b),
        margin,
        out,
    );
}

pub(super) fn sphere_capsule<T: Real>(
    a: &Shape<T>,
    pose_a: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let axis = pose_b.axis();
    let along = axis
        .dot(pose_a.position - pose_b.position)
        .clamp(-b.size.y, b.size.y);
    ball_ball(
        (pose_a.position, a.size.x),
        (pose_b.position + axis * along, b.size.x),
        || across_axes(pose_a, pose_b),
        margin,
        out,
    );
}
