//! The candidates of a large model, found in each step.

use super::Candidate;
use super::bounding_sphere::{self, BoundingSphere, own_margin};
use super::placed_shape::{pose, shape};
use super::select::{explicit, geoms_may_collide, match_any, sort};
use crate::model::{Geom, Model, Params};
use crate::sleep::Parts;
use crate::stages::Positions;
use clench_collide::{Bound, BroadPhase, Mobility, Pose};
use clench_math::{Mask, Real, Vec3, kernel};

/// Finds candidates. The bounds of static geoms persist between steps. They are recomputed if the pose, size or margin
/// of any such geom changes in any lane, for example if the lanes receive another group of environments. This is
/// checked only after the poses of fixed bodies were recomputed.
#[derive(Clone, Debug)]
pub(super) struct DynamicBroadPhase<T> {
    broad_phase: BroadPhase,
    bounds: Vec<Bound<T>>,
    margins: Vec<T>,
    hits: Vec<(u32, u32)>,
    /// The geoms that occur only in explicit pairs.
    in_pairs: Vec<usize>,
    /// The static geoms, and the inputs of their bounds.
    statics: Vec<usize>,
    placements: Vec<Placement<T>>,
    /// The [version](crate::fixed::FixedPoses::version) of the poses that they were compared with.
    version: u64,
}

/// The data that determine the bound of a geom.
#[derive(Clone, Copy, Debug)]
struct Placement<T> {
    pose: Pose<T>,
    size: Vec3<T>,
    margin: T,
}

impl<T: Real> Placement<T> {
    #[inline(always)]
    fn of(model: &Model, params: &Params<T>, pos: &Positions<T>, geom: usize) -> Self {
        Placement {
            pose: pose(pos, geom),
            size: params.geom_size[geom],
            margin: own_margin(model, params, geom),
        }
    }

    /// Returns true if both are equal in every lane; false for NaN.
    #[inline(always)]
    fn same(&self, other: &Self) -> bool {
        let same = |a: Vec3<T>, b: Vec3<T>| a.x.eq(b.x) & a.y.eq(b.y) & a.z.eq(b.z);
        let [x, y, z] = self.pose.rotation.rows;
        let [u, v, w] = other.pose.rotation.rows;
        let same = same(self.pose.position, other.pose.position)
            & same(self.size, other.size)
            & (same(x, u) & same(y, v) & same(z, w))
            & self.margin.eq(other.margin);
        same.all()
    }
}

fn mobility(model: &Model, geom: &Geom) -> Mobility {
    let weld = &model.bodies[model.bodies[geom.body].weld];
    if model.is_fixed(geom.body) {
        Mobility::Static
    } else if weld.dofs.is_empty() {
        Mobility::Placed
    } else {
        Mobility::Moving
    }
}

/// Returns a number shared by geoms of one kinematic tree, or that are placed together.
fn cluster(model: &Model, geom: usize) -> usize {
    let body = &model.bodies[model.geoms[geom].body];
    body.last_dof
        .map_or(body.weld, |dof| model.tree.tree_of(dof))
}

impl<T: Real> DynamicBroadPhase<T> {
    #[cold] // Compiled for size.
    #[inline(never)]
    pub(super) fn new(model: &Model) -> Self {
        let roles = model.geoms.iter().zip(match_any(model));
        let roles = Vec::from_iter(roles.map(|(geom, meets)| match meets {
            true => mobility(model, geom),
            false => Mobility::Excluded,
        }));
        let is_static = |&geom: &usize| roles[geom] == Mobility::Static;
        let explicit = model.pairs.iter().flat_map(|pair| pair.geoms);
        let listed = explicit.filter(|&geom| roles[geom] == Mobility::Excluded);
        DynamicBroadPhase {
            broad_phase: BroadPhase::new(&roles, |geom| cluster(model, geom)),
            statics: (0..roles.len()).filter(is_static).collect(),
            in_pairs: listed.collect(),
            bounds: Vec::new(),
            margins: Vec::new(),
            hits: Vec::new(),
            placements: Vec::new(),
            version: 0,
        }
    }

    /// Makes the next update recompute all bounds. Call it in a pass without an update.
    pub(super) fn invalidate(&mut self) {
        self.placements.clear();
        self.bounds.clear();
    }

    /// Updates the bounds and bounding spheres for the poses of geoms; `version` is that of the fixed poses. Those of
    /// trees that the pass omits are valid.
    #[kernel]
    pub fn update(
        &mut self,
        model: &Model,
        params: &Params<T>,
        pos: &Positions<T>,
        version: u64,
        trees: &Parts,
        spheres: &mut Vec<BoundingSphere<T>>,
    ) {
        let placement = |geom: usize| Placement::of(model, params, pos, geom);
        let mut stored = self.statics.iter().zip(&self.placements);
        let unchanged = self.placements.len() == self.statics.len()
            && self.bounds.len() == model.geoms.len()
            && (version == self.version
                || stored.all(|(&geom, stored)| placement(geom).same(stored)));
        self.version = version;
        let bound = |g: usize| Bound::new(&shape(model, params, g), &pose(pos, g));
        if unchanged {
            let computed = |&g: &usize| !trees.omits(model.tree_of_body(model.geoms[g].body));
            let mobile = self.broad_phase.mobile().iter().map(|&g| g as usize);
            let mobile = mobile.filter(computed);
            for g in mobile.clone() {
                self.bounds[g] = bound(g);
                self.margins[g] = own_margin(model, params, g);
            }
            let geoms = mobile.chain(self.in_pairs.iter().copied());
            bounding_sphere::update(model, params, pos, geoms, spheres);
        } else {
            let all = 0..model.geoms.len();
            self.bounds.clear();
            self.bounds.extend(all.clone().map(bound));
            self.margins.clear();
            (self.margins).extend(all.clone().map(|g| own_margin(model, params, g)));
            self.placements.clear();
            (self.placements).extend(self.statics.iter().map(|&geom| placement(geom)));
            self.broad_phase.invalidate_statics();
            bounding_sphere::update(model, params, pos, all, spheres);
        }
    }

    /// Replaces `candidates` with the explicit pairs and the pairs that are near in any lane; with `trees`, those of
    /// geoms that sleep may be missing. Returns the lanes in which they exceed the budget.
    #[kernel]
    pub fn find(
        &mut self,
        model: &Model,
        trees: Option<&Parts>,
        candidates: &mut Vec<Candidate>,
    ) -> T::Mask {
        let is_awake = trees.map(|trees| {
            move |geom: u32| {
                let tree = model.tree_of_body(model.geoms[geom as usize].body);
                tree.is_none_or(|tree| trees.is_awake(tree))
            }
        });
        let awake = is_awake.as_ref().map(|awake| awake as &dyn Fn(u32) -> bool);
        let allowed = |g1: u32, g2: u32| geoms_may_collide(model, g1 as usize, g2 as usize);
        let (bounds, margins, hits) = (&self.bounds, &self.margins, &mut self.hits);
        let limit = model.budget.pairs();
        let too_many = (self.broad_phase).pairs(bounds, margins, awake, allowed, limit, hits);
        candidates.clear();
        candidates.extend((0..model.pairs.len()).map(|p| explicit(model, p as u32)));
        let found =
            |&(g1, g2): &(u32, u32)| Candidate::new(model, [g1 as usize, g2 as usize], None);
        candidates.extend(hits.iter().map(found));
        sort(model, candidates);
        too_many
    }
}
