//! Surfaces that move while their geoms do not, such as conveyor belts (MuJoCo's `surfacevel`).
//!
//! The surface of a geom moves with v + ω × (x − p) at a point x, with v and ω in the geom's frame, whose origin is p.
//! The difference of the two surfaces' velocities acts on a contact along its tangents and about its normal.

use super::placed_shape::pose;
use crate::model::Params;
use crate::stages::Positions;
use clench_math::{Mask, Mat3, Real, Vec3};

/// Returns the velocity of the second geom's surface minus that of the first at `point`: along both tangents of
/// `frame`, and about its normal.
#[inline(always)]
pub(super) fn relative<T: Real>(
    params: &Params<T>,
    pos: &Positions<T>,
    geoms: [usize; 2],
    point: Vec3<T>,
    frame: &Mat3<T>,
) -> [T; 3] {
    let [mut linear, mut angular] = [Vec3::ZERO; 2];
    for (geom, sign) in geoms.into_iter().zip([-T::ONE, T::ONE]) {
        let velocity = &params.geom_surfacevel[geom];
        if velocity.iter().all(|v| v.eq(T::ZERO).all()) {
            continue;
        }
        let pose = pose(pos, geom);
        let turning = pose.rotation * Vec3::from_slice(&velocity[3..]);
        let along = pose.rotation * Vec3::from_slice(velocity);
        linear += (along + turning.cross(point - pose.position)) * sign;
        angular += turning * sign;
    }
    let [normal, first, second] = frame.rows;
    [first.dot(linear), second.dot(linear), normal.dot(angular)]
}
