//! Pairs that branch too much for lanes: each lane is computed separately, in scalar code and double precision.

use super::placed::Placed;
use crate::contact::{ContactPoint, Contacts, MAX_POINTS, set_lane};
use crate::frame::frame_from_normal;
use crate::pose::Pose;
use crate::shape::Solid;
use arrayvec::ArrayVec;
use clench_math::{Double, Mask, Mat3, Real, Scalar, Vec3};

/// A contact without a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<S> {
    pub position: Vec3<S>,
    pub normal: Vec3<S>,
    pub distance: S,
}

/// The points of one environment.
pub(super) type Points<S> = ArrayVec<Point<S>, MAX_POINTS>;

/// Writes the points that `pair` finds for each lane into `out`, which is empty; points of equal rank share a slot.
pub(super) fn per_lane<T: Real, A: Solid<T>, B: Solid<T>>(
    a: Placed<A, T>,
    b: Placed<B, T>,
    margin: T,
    out: &mut Contacts<T>,
    pair: impl Fn(
        Placed<A::InDouble, Double<T>>,
        Placed<B::InDouble, Double<T>>,
        Double<T>,
        &mut Points<Double<T>>,
    ),
) {
    let all = T::Mask::splat(true);
    per_lane_where(all, a, b, margin, out, |_, a, b, margin, points| {
        pair(a, b, margin, points);
    });
}

/// Computes the same for some of the lanes and passes the lane index to `pair`.
pub(super) fn per_lane_where<T: Real, A: Solid<T>, B: Solid<T>>(
    wanted: T::Mask,
    a: Placed<A, T>,
    b: Placed<B, T>,
    margin: T,
    out: &mut Contacts<T>,
    mut pair: impl FnMut(
        usize,
        Placed<A::InDouble, Double<T>>,
        Placed<B::InDouble, Double<T>>,
        Double<T>,
        &mut Points<Double<T>>,
    ),
) {
    let mut points = Points::new();
    for lane in (0..T::LANES).filter(|lane| wanted.lane(*lane)) {
        let (pose_a, pose_b) = (in_double(a.pose, lane), in_double(b.pose, lane));
        let a = Placed {
            shape: a.shape.lane_in_double(lane),
            pose: &pose_a,
        };
        let b = Placed {
            shape: b.shape.lane_in_double(lane),
            pose: &pose_b,
        };
        points.clear();
        pair(lane, a, b, margin.lane_in_double(lane), &mut points);
        let mut frame = Mat3::IDENTITY;
        for (k, point) in points.iter().enumerate() {
            // Most points of a pair have the same normal.
            if k == 0 || point.normal != frame.rows[0] {
                frame = frame_from_normal(point.normal);
            }
            set_point(out.slot(k), lane, point, &frame);
        }
    }
}

/// Returns the pose of a lane in double precision.
fn in_double<T: Real>(pose: &Pose<T>, lane: usize) -> Pose<Double<T>> {
    let [x, y, z] = pose.rotation.rows.map(|row| row.lane_in_double(lane));
    Pose {
        position: pose.position.lane_in_double(lane),
        rotation: Mat3::from_rows(x, y, z),
    }
}

fn set_point<T: Real>(
    slot: &mut ContactPoint<T>,
    lane: usize,
    point: &Point<Double<T>>,
    frame: &Mat3<Double<T>>,
) {
    set_lane(&mut slot.position, lane, Vec3::from_double(point.position));
    for (row, value) in slot.frame.rows.iter_mut().zip(frame.rows) {
        set_lane(row, lane, Vec3::from_double(value));
    }
    slot.distance
        .set_lane(lane, T::Scalar::from_double(point.distance));
    slot.active.set_lane(lane, true);
}
