//! Shapes on a plane. The plane is the first shape, so normals point out of it.

use super::placed::Placed;
use crate::contact::{ContactPoint, Contacts};
use crate::frame::{frame_along, frame_from_normal};
use crate::shape::{Capsule, Cuboid, Cylinder, Ellipsoid, Plane, Sphere};
use clench_math::{Mask, Mat3, Real, Scalar, Vec3, kernel};

/// Adds the contact of a surface point that is `distance` above the plane.
#[inline(always)]
fn add<T: Real>(
    surface: Vec3<T>,
    distance: T,
    frame: &Mat3<T>,
    active: T::Mask,
    out: &mut Contacts<T>,
) {
    out.push(ContactPoint {
        position: surface - frame.rows[0] * (distance * T::new(0.5)),
        frame: *frame,
        distance,
        active,
    });
}

/// Returns the plane's normal and the height of a shape's origin above it.
#[inline(always)]
fn height<X, T: Real>(plane: Placed<Plane<T>, T>, shape: Placed<X, T>) -> (Vec3<T>, T) {
    let normal = plane.pose.axis();
    let above = normal.dot(shape.pose.position - plane.pose.position);
    (normal, above)
}

#[kernel]
pub(super) fn plane_sphere<T: Real>(
    a: Placed<Plane<T>, T>,
    b: Placed<Sphere<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let radius = b.shape.radius;
    let (normal, above) = height(a, b);
    let distance = above - radius;
    let active = distance.le(margin);
    if active.any() {
        let surface = b.pose.position - normal * radius;
        add(surface, distance, &frame_from_normal(normal), active, out);
    }
}

/// Adds the two ends of the capsule; the first tangent is along its axis.
#[kernel]
pub(super) fn plane_capsule<T: Real>(
    a: Placed<Plane<T>, T>,
    b: Placed<Capsule<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let (radius, half_length) = (b.shape.radius, b.shape.half_length);
    let axis = b.pose.axis();
    let (normal, above) = height(a, b);
    let rise = normal.dot(axis) * half_length;
    let distances = [above + rise - radius, above - rise - radius];
    let active = [distances[0].le(margin), distances[1].le(margin)];
    if !(active[0] | active[1]).any() {
        return;
    }
    let frame = frame_along(normal, axis);
    let half = axis * half_length;
    let middle = b.pose.position - normal * radius;
    add(middle + half, distances[0], &frame, active[0], out);
    add(middle - half, distances[1], &frame, active[1], out);
}

/// Adds the lowest point: the ellipsoid's support against the normal.
#[kernel]
pub(super) fn plane_ellipsoid<T: Real>(
    a: Placed<Plane<T>, T>,
    b: Placed<Ellipsoid<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let size = b.shape.semi_axes;
    let (normal, above) = height(a, b);
    let scaled = b.pose.rotation.transpose_mul(normal).scale_by(size);
    let depth = scaled.norm();
    let distance = above - depth;
    let active = distance.le(margin);
    if active.any() {
        // The ellipsoid is a point if all semi-axes are zero.
        let length = depth.max(T::splat(T::Scalar::MIN_POSITIVE));
        let support = scaled.scale_by(size) * (T::ONE / length);
        let surface = b.pose.position - b.pose.rotation * support;
        add(surface, distance, &frame_from_normal(normal), active, out);
    }
}

/// Adds the lowest points of both cap circles, then two more on the lower circle that form a regular triangle with the
/// first.
#[kernel]
pub(super) fn plane_cylinder<T: Real>(
    a: Placed<Plane<T>, T>,
    b: Placed<Cylinder<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let (radius, half_length) = (b.shape.radius, b.shape.half_length);
    let center = b.pose.position;
    let (normal, above) = height(a, b);
    // The axis, oriented towards the plane, and the radius that points most steeply towards it.
    let up = b.pose.axis();
    let cosine = normal.dot(up);
    let flip = cosine.gt(T::ZERO);
    let axis = Vec3::select(flip, -up, up) * half_length;
    let axis_rise = -cosine.abs() * half_length;
    let steepest = up * cosine - normal;
    let length = steepest.norm();
    let upright = length.lt(T::new(1e-15));
    let scale = radius / T::select(upright, T::ONE, length);
    let any_radius = b.pose.rotation.column(0) * radius;
    let spoke = Vec3::select(upright, any_radius, steepest * scale);
    let spoke_rise = spoke.dot(normal);

    let lowest = above + axis_rise + spoke_rise;
    let active = lowest.le(margin);
    if !active.any() {
        return;
    }
    let frame = frame_from_normal(normal);
    add(center + axis + spoke, lowest, &frame, active, out);

    let other_end = above - axis_rise + spoke_rise;
    let active_other = active & other_end.le(margin);
    add(center - axis + spoke, other_end, &frame, active_other, out);

    let half = T::new(0.5);
    let flank = above + axis_rise - spoke_rise * half;
    let active_flank = active & flank.le(margin);
    if active_flank.any() {
        let (sideways, _) = spoke.cross(axis).normalize();
        let sideways = sideways * (radius * T::new(3f64.sqrt() / 2.0));
        let middle = center + axis - spoke * half;
        add(middle + sideways, flank, &frame, active_flank, out);
        add(middle - sideways, flank, &frame, active_flank, out);
    }
}

/// Adds the corners on the lower side, at most four.
#[kernel]
pub(super) fn plane_box<T: Real>(
    a: Placed<Plane<T>, T>,
    b: Placed<Cuboid<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let (normal, above) = height(a, b);
    let rotation = &b.pose.rotation;
    let half = b.shape.half_lengths;
    let local = rotation.transpose_mul(normal).scale_by(half);
    let lowest = above - (local.x.abs() + local.y.abs() + local.z.abs());
    if !lowest.le(margin).any() {
        return;
    }
    let frame = frame_from_normal(normal);
    let mut count = T::ZERO;
    for corner in 0..8 {
        let sign = |axis: usize| T::new(if corner & (1 << axis) != 0 { 1.0 } else { -1.0 });
        let signs = Vec3::new(sign(0), sign(1), sign(2));
        let rise = local.dot(signs);
        let distance = above + rise;
        // If an edge points down, many corners are level with the centre: four are enough.
        let active = distance.le(margin) & rise.le(T::ZERO) & count.lt(T::new(4.0));
        if active.any() {
            count += T::select(active, T::ONE, T::ZERO);
            let surface = b.pose.position + *rotation * half.scale_by(signs);
            add(surface, distance, &frame, active, out);
        }
    }
}
