//! Pairs that branch too much for lanes: each lane is computed separately, in scalar code.

use super::placed::Placed;
use crate::contact::{ContactPoint, Contacts, MAX_POINTS, set_lane};
use crate::frame::frame_from_normal;
use crate::shape::Solid;
use arrayvec::ArrayVec;
use clench_math::{Mask, Mat3, Real, Vec3};

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
        Placed<A::SingleEnv, T::Scalar>,
        Placed<B::SingleEnv, T::Scalar>,
        T::Scalar,
        &mut Points<T::Scalar>,
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
        Placed<A::SingleEnv, T::Scalar>,
        Placed<B::SingleEnv, T::Scalar>,
        T::Scalar,
        &mut Points<T::Scalar>,
    ),
) {
    let mut points = Points::new();
    for lane in (0..T::LANES).filter(|lane| wanted.lane(*lane)) {
        let (pose_a, pose_b) = (a.pose.lane(lane), b.pose.lane(lane));
        let a = Placed {
            shape: a.shape.lane(lane),
            pose: &pose_a,
        };
        let b = Placed {
            shape: b.shape.lane(lane),
            pose: &pose_b,
        };
        points.clear();
        pair(lane, a, b, margin.lane(lane), &mut points);
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

fn set_point<T: Real>(
    slot: &mut ContactPoint<T>,
    lane: usize,
    point: &Point<T::Scalar>,
    frame: &Mat3<T::Scalar>,
) {
    set_lane(&mut slot.position, lane, point.position);
    for (row, value) in slot.frame.rows.iter_mut().zip(frame.rows) {
        set_lane(row, lane, value);
    }
    slot.distance.set_lane(lane, point.distance);
    slot.active.set_lane(lane, true);
}
