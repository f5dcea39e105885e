//! The narrow phase over one thread's share of the near pairs.

use super::depth_proofs::{self, DepthProofs};
use super::pair_clock::PairClock;
use super::placed_shape::{ALL_LANES, AssetLanes, exists, mask_of, pose, shape_in};
use super::separating_axes::SeparatingAxes;
use super::{Candidate, contact_range};
use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_collide::{
    Collide, ContactPoint, Contacts, PairMemory, SeparatingAxis, compiled_collide, multiccd_applies,
};
use clench_math::{Mask, Real, Scalar, kernel};

/// The pairs to check and the points found.
#[derive(Clone, Debug)]
pub(super) struct PairFinder<T: Real> {
    pairs: Vec<NearPair<T>>,
    /// The pairs that touch, each with the end of its points in `points`.
    touching: Vec<(u32, usize)>,
    points: Vec<ContactPoint<T>>,
    /// The points of the current pair.
    scratch: Contacts<T>,
    /// Those of lanes with the same meshes.
    part: Contacts<T>,
    proofs: DepthProofs,
    clock: PairClock,
    collide: Collide<T>,
}

/// A near candidate, its separating axis in the last step, and the index of that axis in its table.
#[derive(Clone, Copy, Debug)]
struct NearPair<T> {
    candidate: u32,
    index: usize,
    axis: SeparatingAxis<T>,
}

impl<T: Real> Default for PairFinder<T> {
    fn default() -> Self {
        PairFinder {
            pairs: Vec::new(),
            touching: Vec::new(),
            points: Vec::new(),
            scratch: Contacts::new(),
            part: Contacts::new(),
            proofs: DepthProofs::default(),
            clock: PairClock::default(),
            collide: compiled_collide(),
        }
    }
}

impl<T: Real> PairFinder<T> {
    /// Clears all pairs and results.
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.touching.clear();
        self.points.clear();
    }

    /// Adds the given candidates of the environments `envs`, and runs the clock if `clock` runs.
    pub(super) fn begin(
        &mut self,
        near: &[u32],
        candidates: &[Candidate],
        axes: &mut SeparatingAxes<T>,
        envs: &[u32],
        clock: &PairClock,
    ) {
        self.clock.run_as(clock);
        self.proofs.begin(envs);
        self.pairs.extend(near.iter().map(|&candidate| {
            let index = axes.index(candidates[candidate as usize].geoms);
            NearPair {
                candidate,
                index,
                axis: *axes.at(index),
            }
        }));
    }

    /// Finds the points of each pair; without `multiccd` only the deepest, for kinds that MuJoCo's flag affects.
    #[kernel]
    pub fn find(
        &mut self,
        model: &Model,
        params: &Params<T>,
        multiccd: bool,
        pos: &Positions<T>,
        candidates: &[Candidate],
    ) {
        self.clock.start();
        let (points, collide) = (&mut self.scratch, self.collide);
        for pair in &mut self.pairs {
            let candidate = &candidates[pair.candidate as usize];
            let [a, b] = candidate.geoms.map(|geom| geom as usize);
            let (_, margin) = contact_range(model, params, candidate);
            let (pose_a, pose_b) = (pose(pos, a), pose(pos, b));
            for (lanes, lane) in AssetLanes::new(model, params, [a, b]) {
                let shape_a = shape_in(model, params, a, lane);
                let shape_b = shape_in(model, params, b, lane);
                // Lanes with other meshes, or without one of the geoms, make no contact at this margin.
                let (taken, part, margin) = match lanes {
                    ALL_LANES => (None, &mut *points, margin),
                    lanes => {
                        let exist = exists(params, a) & exists(params, b);
                        let taken = mask_of::<T>(lanes) & exist;
                        let none = T::splat(-T::Scalar::INFINITY);
                        (Some(taken), &mut self.part, T::select(taken, margin, none))
                    }
                };
                let proofs = self.proofs.of(candidate.kinds, candidate.geoms);
                let axis = &mut pair.axis;
                let memory = &mut PairMemory { axis, proofs };
                collide(&shape_a, &pose_a, &shape_b, &pose_b, margin, memory, part);
                if let Some(taken) = taken {
                    points.merge(&self.part, taken, lane == 0);
                }
            }
            self.clock.lap(candidate.kinds, T::LANES, || {
                let none = T::Mask::splat(false);
                let any = |lanes, point: &ContactPoint<T>| lanes | point.active;
                points.as_slice().iter().fold(none, any).count()
            });
            let [a, b] = candidate.kinds;
            if !multiccd && multiccd_applies(a, b) {
                points.keep_deepest();
            }
            if !points.as_slice().is_empty() {
                if depth_proofs::applies(candidate.kinds) {
                    self.proofs.count_touching();
                }
                self.points.extend_from_slice(points.as_slice());
                self.touching.push((pair.candidate, self.points.len()));
            }
        }
    }

    /// Returns the separating axes and the time spent to their owners.
    pub(super) fn end(&mut self, axes: &mut SeparatingAxes<T>, clock: &mut PairClock) {
        for pair in &self.pairs {
            *axes.at(pair.index) = pair.axis;
        }
        clock.absorb(&mut self.clock);
    }

    /// Returns the candidates that touch, with their points.
    pub(super) fn touching(&self) -> impl Iterator<Item = (u32, &[ContactPoint<T>])> {
        let mut start = 0;
        self.touching.iter().map(move |&(candidate, end)| {
            let points = &self.points[start..end];
            start = end;
            (candidate, points)
        })
    }
}
