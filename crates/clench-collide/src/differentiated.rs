//! Contact points of shapes that move, in dual numbers.
//!
//! Contacts are found in plain numbers first, so pairs that do not touch cost no more than without derivatives. Those
//! of a pair that touches are computed once more in dual numbers of fixed directions: the translation of one shape
//! relative to the other, the rotation of each, and the sizes of both. The chain rule does the rest. Faces, edges and
//! vertices of polyhedra are differentiated as the features that they are, curved surfaces with their curvature.

use crate::contact::Contacts;
use crate::narrow::{Collide, PairMemory, SeparatingAxis, collide_again};
use crate::pose::Pose;
use crate::shape::Shape;
use clench_math::{Dual, Mask, Mat3, Real, Scalar, Vec3, kernel};
use std::cell::Cell;

/// The number of directions, three of each kind.
const DIRECTIONS: usize = 15;
/// The first direction of each kind.
const TRANSLATION: usize = 0;
const ROTATIONS: [usize; 2] = [3, 6];
const SIZES: [usize; 2] = [9, 12];

/// A number with its derivatives by the poses and sizes of two shapes, and an unused one that fills the registers.
type PairDual = Dual<f64, { DIRECTIONS + 1 }>;

/// Computes the same as [`collide_again`] in dual numbers. `collide` is [`collide_again`] in plain numbers.
#[kernel]
pub(crate) fn collide_differentiated<T: Real>(
    collide: Collide<f64>,
    (shapes, poses): ([&Shape<T>; 2], [&Pose<T>; 2]),
    margin: T,
    axis: &mut SeparatingAxis<T>,
    out: &mut Contacts<T>,
) {
    out.clear();
    let mut plain_axis = axis.map(f64_of);
    let mut plain = Contacts::<f64>::new();
    let [plain_a, plain_b] = shapes.map(|shape| shape.resized(map(shape.size(), f64_of)));
    let [at_a, at_b] = poses.map(|pose| pose.map(f64_of));
    collide(
        &plain_a,
        &at_a,
        &plain_b,
        &at_b,
        f64_of(margin),
        &mut PairMemory::of_axis(&mut plain_axis),
        &mut plain,
    );
    *axis = plain_axis.map(T::new);
    if plain.as_slice().is_empty() {
        return;
    }
    // The changes along the directions: numbers whose value is zero.
    let change = |v: Vec3<T>| v - map(v, |x| T::from_value(x.value()));
    let moved = change(poses[0].position);
    let changes = [
        change(poses[1].position) - moved,
        turn(&poses[0].rotation),
        turn(&poses[1].rotation),
        change(shapes[0].size()),
        change(shapes[1].size()),
    ];
    let changes: [T; DIRECTIONS] = std::array::from_fn(|k| changes[k / 3].to_array()[k % 3]);
    let mut points = POINTS.take().unwrap_or_default();
    find(&[plain_a, plain_b], &[at_a, at_b], margin, &mut points);
    for point in points.as_slice() {
        let slot = out.slot(out.as_slice().len());
        let [normal, tangent, _] = point.frame.rows;
        let [normal, tangent] = [chain(&changes, normal), chain(&changes, tangent)];
        slot.position = chain(&changes, point.position) + moved;
        slot.frame = Mat3::from_rows(normal, tangent, normal.cross(tangent));
        slot.distance = chain_number(&changes, &point.distance);
        slot.active = T::Mask::splat(point.active);
    }
    POINTS.set(Some(points));
}

/// The number of directions in which two shapes move relative to each other, and turn in the world.
const MOTIONS: usize = 9;

/// A contact point, and its derivatives by the motion of the shapes: by a translation of the second along each axis of
/// the world, then by a rotation of the first about each axis through its position, then by one of the second.
/// (Tangents may follow the axes of the world, so the rotation of both together matters.)
#[derive(Clone, Copy, Debug, Default)]
pub struct MovingPoint {
    /// The point.
    pub position: Vec3<f64>,
    /// The derivatives of the distance.
    pub distance_rates: [f64; MOTIONS],
    /// The derivatives of the point.
    pub position_rates: [Vec3<f64>; MOTIONS],
    /// The derivatives of the rows of the contact frame.
    pub frame_rates: [[Vec3<f64>; 3]; MOTIONS],
}

/// Replaces `out` by the points where two shapes are at most `margin` metres apart. Generic, so that the crate that
/// differentiates compiles it.
pub fn moving_points<T: Real>(
    shapes: &[Shape<f64>; 2],
    poses: &[Pose<f64>; 2],
    margin: T,
    out: &mut Vec<MovingPoint>,
) {
    let mut points = POINTS.take().unwrap_or_default();
    find(shapes, poses, margin, &mut points);
    out.clear();
    out.extend(points.as_slice().iter().map(|point| {
        let [normal, tangent, _] = point.frame.rows;
        let [n, t] = [normal, tangent].map(|row| map(row, |x| x.value));
        let mut moving = MovingPoint {
            position: map(point.position, |x| x.value),
            ..MovingPoint::default()
        };
        // The sizes follow these directions.
        for k in TRANSLATION..MOTIONS {
            let rate = |v: Vec3<PairDual>| map(v, |x| x.tangent[k]);
            let (dn, dt) = (rate(normal), rate(tangent));
            moving.distance_rates[k] = point.distance.tangent[k];
            moving.position_rates[k] = rate(point.position);
            moving.frame_rates[k] = [dn, dt, dn.cross(t) + n.cross(dt)];
        }
        moving
    }));
    POINTS.set(Some(points));
}

/// Returns a vector that changes by the change of each direction.
#[inline(always)]
fn chain<T: Real>(changes: &[T; DIRECTIONS], v: Vec3<PairDual>) -> Vec3<T> {
    Vec3 {
        x: chain_number(changes, &v.x),
        y: chain_number(changes, &v.y),
        z: chain_number(changes, &v.z),
    }
}

#[inline(always)]
fn chain_number<T: Real>(changes: &[T; DIRECTIONS], x: &PairDual) -> T {
    let mut number = T::new(x.value);
    for (&change, &slope) in changes.iter().zip(&x.tangent) {
        number += change.scale(slope);
    }
    number
}

thread_local! {
    /// Too large to be created for each pair.
    static POINTS: Cell<Option<Box<Contacts<PairDual>>>> = Cell::default();
}

/// Computes the contact points of two shapes with their derivatives. Generic, so that the crate that differentiates
/// compiles it.
fn find<T: Real>(
    shapes: &[Shape<f64>; 2],
    poses: &[Pose<f64>; 2],
    margin: T,
    points: &mut Contacts<PairDual>,
) {
    let [a, b] = [0, 1].map(|k| shapes[k].resized(seeded(shapes[k].size(), SIZES[k])));
    let [pose_a, pose_b] = [0, 1].map(|k| {
        let Pose { position, rotation } = &poses[k];
        // Only the second shape translates.
        let position = match k {
            0 => map(*position, PairDual::new),
            _ => seeded(*position, TRANSLATION),
        };
        Pose {
            position,
            rotation: turning(rotation, ROTATIONS[k]),
        }
    });
    let mut axis = SeparatingAxis::default();
    let margin = PairDual::new(f64_of(margin));
    let memory = &mut PairMemory::of_axis(&mut axis);
    collide_again(&a, &pose_a, &b, &pose_b, margin, memory, points);
}

/// Returns the value of a number. (Dual numbers have one lane.)
#[inline(always)]
fn f64_of<T: Real>(x: T) -> f64 {
    x.lane(0).to_f64()
}

#[inline(always)]
fn map<T, U>(v: Vec3<T>, f: impl Fn(T) -> U) -> Vec3<U> {
    Vec3 {
        x: f(v.x),
        y: f(v.y),
        z: f(v.z),
    }
}

impl<T: Real> Pose<T> {
    fn map<U: Real>(&self, f: impl Fn(T) -> U + Copy) -> Pose<U> {
        Pose {
            position: map(self.position, f),
            rotation: Mat3 {
                rows: self.rotation.rows.map(|row| map(row, f)),
            },
        }
    }
}

/// Returns numbers that change along three directions from `first` on.
fn seeded(v: Vec3<f64>, first: usize) -> Vec3<PairDual> {
    let mut v = map(v, PairDual::new);
    v.x.tangent[first] = 1.0;
    v.y.tangent[first + 1] = 1.0;
    v.z.tangent[first + 2] = 1.0;
    v
}

/// Returns a rotation that turns about the axes of the world, along three directions from `first` on.
fn turning(rotation: &Mat3<f64>, first: usize) -> Mat3<PairDual> {
    let mut rows = rotation.rows.map(|row| map(row, PairDual::new));
    for column in 0..3 {
        let axis = rotation.column(column);
        for direction in 0..3 {
            let mut unit = [0.0; 3];
            unit[direction] = 1.0;
            let rate = Vec3::from_array(unit).cross(axis).to_array();
            for (row, rate) in rows.iter_mut().zip(rate) {
                let entry = match column {
                    0 => &mut row.x,
                    1 => &mut row.y,
                    _ => &mut row.z,
                };
                entry.tangent[first + direction] = rate;
            }
        }
    }
    Mat3 { rows }
}

/// Returns the rotation vector of the change of a rotation, with the value zero.
#[inline(always)]
fn turn<T: Real>(rotation: &Mat3<T>) -> Vec3<T> {
    let mut sum = Vec3::ZERO;
    for column in 0..3 {
        let axis = rotation.column(column);
        let fixed = map(axis, |x| T::from_value(x.value()));
        sum += fixed.cross(axis - fixed);
    }
    sum * T::new(0.5)
}
