//! Proofs of the depth of two overlapping polyhedra that stay valid while the bodies move.
//!
//! The depth is the distance δ from the origin to the boundary of the difference of the bodies. A search ends with a
//! polytope of points of the difference. When the bodies have moved, the same corners give the points of another closed
//! surface, still in the difference. If the origin is on the inner side of the planes of all its triangles, at least δ′
//! away from them, the ball of radius δ′ is within the difference: each ray from the origin meets the surface, at least
//! δ′ away. The features that touched bound the depth from above, by their gap. If both bounds agree, up to the
//! tolerance of a search, no search is needed. This holds for any stored polytope, also that of other bodies.
//!
//! A search ends with the same bits, because it measures the same features: a proof is accepted only if no other
//! direction is as deep, up to twice the tolerance.

use super::pair::Pair;
use super::polytope::Polytope;
use super::touching::{Measured, Touching, tie};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// The maximum number of points of a stored polytope.
const POINTS: usize = 16;
const TRIANGLES: usize = 2 * POINTS - 4;

/// The polytope that proved a depth, by the corners of both bodies, and the features that touched.
#[derive(Clone, Debug, Default)]
pub struct DepthProof {
    points: ArrayVec<[u16; 2], POINTS>,
    triangles: ArrayVec<[u8; 3], TRIANGLES>,
    touching: Option<Touching>,
}

/// The proofs of a pair of shapes in a table that pairs and environments share.
#[derive(Debug, Default)]
pub struct LaneProofs<'a> {
    table: &'a mut [DepthProof],
    pair: u32,
    envs: &'a [u32],
}

impl<'a> LaneProofs<'a> {
    /// Creates the proofs of a pair, given a number that distinguishes it and the environment of each lane, or none.
    /// The length of the table must be zero or a power of two.
    pub fn new(table: &'a mut [DepthProof], pair: u32, envs: &'a [u32]) -> Self {
        LaneProofs { table, pair, envs }
    }

    /// Returns the proof of a lane.
    pub(super) fn of_lane(&mut self, lane: usize) -> Option<&mut DepthProof> {
        let env = self.envs.get(lane).copied().unwrap_or(0);
        let mixed = self.pair ^ env.wrapping_mul(0xC2B2_AE35);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D);
        let index = (mixed ^ (mixed >> 13)) as usize;
        let last = self.table.len().wrapping_sub(1);
        self.table.get_mut(index & last)
    }
}

impl DepthProof {
    /// Stores the polytope of a search, if it is small enough.
    pub(super) fn store<S: Scalar>(&mut self, polytope: &Polytope<S>, touching: Touching) {
        self.touching = None;
        self.points.clear();
        self.triangles.clear();
        for corners in polytope.corners_of_vertices() {
            let [Ok(a), Ok(b)] = corners.map(u16::try_from) else {
                return;
            };
            if self.points.try_push([a, b]).is_err() {
                return;
            }
        }
        for triangle in polytope.triangles() {
            if self.triangles.try_push(triangle).is_err() {
                return;
            }
        }
        self.touching = Some(touching);
    }

    /// Returns the largest gap of a pair if the proof holds for its poses.
    pub(super) fn confirm<S: Scalar>(&self, pair: &Pair<S>) -> Option<Measured<S>> {
        let touching = self.touching?;
        let bodies = pair.polyhedra()?;
        let counts = [0, 1].map(|k| bodies[k].corner_count());
        let exist = |&[a, b]: &[u16; 2]| usize::from(a) < counts[0] && usize::from(b) < counts[1];
        if !touching.exist(&bodies) || !self.points.iter().all(exist) {
            return None;
        }
        let measured = touching.measure_first(pair, &bodies)?;
        let difference = |&[a, b]: &[u16; 2]| {
            let (a, b) = (bodies[0].corner(a.into()), bodies[1].corner(b.into()));
            pair.offset + pair.rotation * b - a
        };
        let differences: ArrayVec<Vec3<S>, POINTS> = self.points.iter().map(difference).collect();
        let depth = -measured.0.gap;
        let (near, far) = (
            depth - S::new(0.5) * tie(pair),
            depth + S::new(2.0) * tie(pair),
        );
        let touches = |&k: &u8| {
            let corners = self.points[k as usize].map(u32::from);
            touching.include(pair, &bodies, &measured, corners)
        };
        let holds = self.triangles.iter().all(|triangle| {
            let [p, q, r] = triangle.map(|k| differences[k as usize]);
            let normal = (q - p).cross(r - p);
            let (height, square) = (normal.dot(p), normal.norm_squared());
            let beyond = |distance: S| height.squared() > distance.squared() * square;
            height > S::ZERO && (beyond(far) || (beyond(near) && triangle.iter().all(touches)))
        });
        holds.then_some(measured)
    }
}
