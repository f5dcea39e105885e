//! Rays against spheres, capsules, ellipsoids and cylinders. The normals of missed shapes mean nothing.

use super::chord::Chord;
use super::line::Line;
use clench_math::{Real, Vec3};

#[inline(always)]
pub(super) fn sphere<T: Real>(size: Vec3<T>, line: &Line<T>) -> (T, Vec3<T>) {
    let (distance, _) = Chord::of_ball(line, Vec3::ZERO, size.x).first();
    (distance, line.at(distance).normalize().0)
}

#[inline(always)]
pub(super) fn capsule<T: Real>(size: Vec3<T>, line: &Line<T>) -> (T, Vec3<T>) {
    let (radius, half) = (size.x, size.y);
    let end = |z| Chord::of_ball(line, Vec3::new(T::ZERO, T::ZERO, z), radius);
    let side = Chord::of_tube(line, radius).slab(line, 2, -half, half);
    let (distance, _) = side.or(end(half)).or(end(-half)).first();
    let mut out = line.at(distance);
    out.z -= out.z.clamp(-half, half);
    (distance, out.normalize().0)
}

/// The semi-axes scale it to the unit sphere; its normal is the gradient of Σ (xᵢ / sᵢ)².
#[inline(always)]
pub(super) fn ellipsoid<T: Real>(size: Vec3<T>, line: &Line<T>) -> (T, Vec3<T>) {
    let one = T::ONE;
    let inverse = Vec3::new(one / size.x, one / size.y, one / size.z);
    let (along, stretch) = line.along.scale_by(inverse).normalize();
    let scaled = Line {
        origin: line.origin.scale_by(inverse),
        along,
    };
    let (distance, _) = Chord::of_ball(&scaled, Vec3::ZERO, one).first();
    let normal = scaled.at(distance).scale_by(inverse).normalize().0;
    (distance / stretch, normal)
}

#[inline(always)]
pub(super) fn cylinder<T: Real>(size: Vec3<T>, line: &Line<T>) -> (T, Vec3<T>) {
    let tube = Chord::of_tube(line, size.x);
    let side = |distance: T| {
        let p = line.at(distance);
        Vec3::new(p.x, p.y, T::ZERO).normalize().0
    };
    let tube = Chord {
        entered: side(tube.enter),
        left: side(tube.leave),
        ..tube
    };
    tube.slab(line, 2, -size.y, size.y).first()
}
