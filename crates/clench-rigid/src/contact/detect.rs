//! Finds the contacts of a configuration: bounding spheres, then the narrow phase, in slots that all lanes share.

use super::reach::{self, Reach, may_touch};
use super::select::{explicit, geoms_may_collide};
use super::{Candidate, Contact, candidates, contact_params, contact_range};
use crate::model::{Model, Params};
use crate::profile::Stage;
use crate::settings::StepSettings;
use crate::workspace::{Positions, Workspace};
use clench_collide::{Bound, Contacts, Grid, Pose, Shape, collide};
use clench_math::{Mask, Real, kernel};
use clench_solver::MaxContacts;

/// Above this many geoms the pairs are not listed once but looked for in each step: a list grows with the square.
const MOST_LISTED_GEOMS: usize = 128;

/// What detection keeps between steps.
#[derive(Clone, Debug)]
pub struct Collision<T: Real> {
    /// The workspace's contacts were given by the user: detection leaves them alone.
    pub given: bool,
    /// Lanes in which the last step found more contacts than the options allow.
    pub overflow: T::Mask,
    /// Pairs to look at, in canonical order.
    candidates: Vec<Candidate>,
    /// Those of them that may touch now.
    near: Vec<u32>,
    /// Finds the candidates of a large model anew each step; those of a small one never change.
    crowd: Option<Box<Crowd<T>>>,
    reaches: Vec<Reach<T>>,
    points: Contacts<T>,
    count: T,
}

#[derive(Clone, Debug)]
struct Crowd<T> {
    grid: Grid,
    bounds: Vec<Bound<T>>,
    margins: Vec<T>,
    hits: Vec<(u32, u32)>,
}

impl<T: Real> Collision<T> {
    /// Prepares detection for a model.
    pub fn new(model: &Model) -> Self {
        let large = model.geoms.len() > MOST_LISTED_GEOMS;
        Collision {
            given: false,
            overflow: T::Mask::splat(false),
            candidates: if large { Vec::new() } else { candidates(model) },
            crowd: large.then(|| Box::new(Crowd::new())),
            near: Vec::new(),
            reaches: Vec::new(),
            points: Contacts::new(),
            count: T::ZERO,
        }
    }

    /// Counts the lanes of a new contact; leaves those that are not full yet.
    #[inline(always)]
    fn admit(&mut self, active: T::Mask, most: MaxContacts) -> T::Mask {
        let MaxContacts::Limit(most) = most else {
            return active;
        };
        let full = self.count.ge(T::new(most as f64));
        self.overflow |= active & full;
        self.count += T::select(active & !full, T::ONE, T::ZERO);
        active & !full
    }
}

/// Fills `ws.contacts` from the geoms' poses, in canonical order.
#[kernel]
pub fn detect<T: Real>(
    model: &Model,
    params: &Params<T>,
    settings: &StepSettings,
    ws: &mut Workspace<T>,
) {
    let (collision, contacts, pos) = (&mut ws.collision, &mut ws.contacts, &ws.position);
    if collision.given {
        return;
    }
    contacts.clear();
    collision.overflow = T::Mask::splat(false);
    collision.count = T::ZERO;
    if !settings.flags.constraint || !settings.flags.contact {
        return;
    }
    if let Some(crowd) = &mut collision.crowd {
        crowd.find(model, params, pos, &mut collision.candidates);
    }
    reach::update(model, params, pos, &mut collision.reaches);
    collision.near.clear();
    for (index, candidate) in collision.candidates.iter().enumerate() {
        let range = || contact_range(model, params, candidate).1;
        if may_touch(candidate, &collision.reaches, pos, range).any() {
            collision.near.push(index as u32);
        }
    }
    ws.clock.lap(Stage::BroadPhase as usize);
    for near in 0..collision.near.len() {
        let candidate = collision.candidates[collision.near[near] as usize];
        narrow(model, params, pos, &candidate, &mut collision.points);
        if !collision.points.as_slice().is_empty() {
            list(model, params, settings, &candidate, collision, contacts);
        }
    }
    ws.clock.lap(Stage::NarrowPhase as usize);
}

/// The points of one candidate.
#[inline(always)]
fn narrow<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    candidate: &Candidate,
    points: &mut Contacts<T>,
) {
    let [a, b] = [candidate.geoms[0] as usize, candidate.geoms[1] as usize];
    let (shape_a, shape_b) = (shape(model, params, a), shape(model, params, b));
    let (pose_a, pose_b) = (pose(pos, a), pose(pos, b));
    let (_, range) = contact_range(model, params, candidate);
    collide(&shape_a, &pose_a, &shape_b, &pose_b, range, points);
}

/// Makes contacts of the points of one candidate.
#[kernel]
fn list<T: Real>(
    model: &Model,
    params: &Params<T>,
    settings: &StepSettings,
    candidate: &Candidate,
    collision: &mut Collision<T>,
    contacts: &mut Vec<Contact<T>>,
) {
    let mixed = contact_params(model, params, candidate);
    for i in 0..collision.points.as_slice().len() {
        let point = collision.points.as_slice()[i];
        let active = collision.admit(point.active, settings.solver.max_contacts);
        if !active.any() {
            continue;
        }
        contacts.push(Contact {
            geoms: candidate.geoms.map(|g| g as usize),
            active,
            dim: mixed.dim,
            dist: point.distance,
            pos: point.position,
            frame: point.frame,
            includemargin: mixed.includemargin,
            friction: mixed.friction,
            solref: mixed.solref,
            solreffriction: mixed.solreffriction,
            solimp: mixed.solimp,
            block: None,
        });
    }
}

/// The shape of a geom.
#[inline(always)]
pub fn shape<'a, T: Real>(model: &'a Model, params: &Params<T>, geom: usize) -> Shape<'a, T> {
    Shape {
        kind: model.geoms[geom].kind,
        size: params.geom_size[geom],
        asset: model.asset(geom),
    }
}

#[inline(always)]
fn pose<T: Real>(pos: &Positions<T>, geom: usize) -> Pose<T> {
    Pose {
        position: pos.geom_xpos[geom],
        rotation: pos.geom_xmat[geom],
    }
}

impl<T: Real> Crowd<T> {
    fn new() -> Self {
        Crowd {
            grid: Grid::new(),
            bounds: Vec::new(),
            margins: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// Replaces `candidates` by the explicit pairs and those that are near in any lane.
    #[kernel]
    fn find(
        &mut self,
        model: &Model,
        params: &Params<T>,
        pos: &Positions<T>,
        candidates: &mut Vec<Candidate>,
    ) {
        let ngeom = model.geoms.len();
        self.bounds.clear();
        self.margins.clear();
        for g in 0..ngeom {
            (self.bounds).push(Bound::new(&shape(model, params, g), &pose(pos, g)));
            self.margins.push(reach::own_margin(model, params, g));
        }
        let allowed = |g1: u32, g2: u32| geoms_may_collide(model, g1 as usize, g2 as usize);
        let hits = &mut self.hits;
        self.grid.pairs(&self.bounds, &self.margins, allowed, hits);
        candidates.clear();
        candidates.extend((0..model.pairs.len()).map(|p| explicit(model, p as u32)));
        let found =
            |&(g1, g2): &(u32, u32)| Candidate::new(model, [g1 as usize, g2 as usize], None);
        candidates.extend(hits.iter().map(found));
        candidates.sort_unstable_by_key(|c| c.order(model));
    }
}
