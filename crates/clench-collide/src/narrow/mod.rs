//! Narrow phase: the contact points of one pair of shapes.

mod sphere;

use crate::{Contacts, Pose, Shape, ShapeKind};
use clench_math::Real;

/// Whether [`collide`] knows the pair, given in either order.
pub fn supported(a: ShapeKind, b: ShapeKind) -> bool {
    use ShapeKind::*;
    matches!(
        (a.min(b), a.max(b)),
        (Plane, Sphere | Capsule) | (Sphere, Sphere | Capsule)
    )
}

/// Replaces `out` by the points where shape `a` at `pose_a` and shape `b` at `pose_b` are within `margin` metres.
///
/// The kinds must come in [`ShapeKind`]'s order (`a.kind <= b.kind`). A pair that is not [`supported`], or out of
/// order, yields no points: callers refuse such pairs when they build their scene.
pub fn collide<T: Real>(
    a: &Shape<T>,
    pose_a: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    use ShapeKind::*;
    out.clear();
    match (a.kind, b.kind) {
        (Plane, Sphere) => sphere::plane_sphere(pose_a, b, pose_b, margin, out),
        (Plane, Capsule) => sphere::plane_capsule(pose_a, b, pose_b, margin, out),
        (Sphere, Sphere) => sphere::sphere_sphere(a, pose_a, b, pose_b, margin, out),
        (Sphere, Capsule) => sphere::sphere_capsule(a, pose_a, b, pose_b, margin, out),
        _ => {}
    }
}
