//! Rays against planes, boxes and hulls.

use super::chord::Chord;
use super::line::Line;
use crate::Hull;
use clench_math::{Real, Vec3};

/// From above; within the rectangle that positive sizes say.
#[inline(always)]
pub(super) fn plane<T: Real>(size: Vec3<T>, line: &Line<T>) -> (T, Vec3<T>) {
    let down = line.along.z.lt(T::ZERO);
    let distance = -line.origin.z / T::select(down, line.along.z, T::ONE);
    let p = line.at(distance);
    let within = |x: T, half: T| half.le(T::ZERO) | x.abs().le(half);
    let hit = down & within(p.x, size.x) & within(p.y, size.y);
    let up = Vec3::new(T::ZERO, T::ZERO, T::ONE);
    (T::select(hit, distance, T::new(f64::INFINITY)), up)
}

#[inline(always)]
pub(super) fn cuboid<T: Real>(size: Vec3<T>, line: &Line<T>) -> (T, Vec3<T>) {
    let mut chord = Chord::whole();
    for axis in 0..3 {
        chord = chord.slab(line, axis, -size[axis], size[axis]);
    }
    chord.first()
}

/// Behind all planes of its faces.
pub(super) fn hull(hull: &Hull, origin: Vec3<f64>, along: Vec3<f64>) -> Option<(f64, Vec3<f64>)> {
    let mut chord = Chord::whole();
    let (infinity, none) = (f64::INFINITY, Vec3::ZERO);
    for face in 0..hull.face_count() {
        let normal = hull.normal(face);
        let (rate, above) = (normal.dot(along), normal.dot(origin) - hull.offset(face));
        let at = (-above / rate, normal);
        chord = if rate < 0.0 {
            chord.cut(at, (infinity, none))
        } else if rate > 0.0 {
            chord.cut((-infinity, none), at)
        } else if above > 0.0 {
            return None;
        } else {
            chord
        };
    }
    Some(chord.first())
}
