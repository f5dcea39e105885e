//! Finds the contacts of a configuration: bounding spheres, then the narrow phase, in slots that all lanes share.

use super::bounding_sphere::{self, BoundingSphere, may_touch};
use super::dynamic_broad_phase::DynamicBroadPhase;
use super::pair_clock::PairClock;
use super::select::listed_candidates;
use super::separating_axes::SeparatingAxes;
use super::{Candidate, Contact, contact_params, contact_range, surface};
use crate::Budget;
use crate::model::{Model, Params};
use crate::options::MaxContacts;
use crate::profile::Stage;
use crate::settings::StepSettings;
use crate::sleep::Sleep;
use crate::workspace::{Positions, Workspace};
use clench_collide::{
    ContactPoint, Contacts, Pose, SeparatingAxis, Shape, collide_again, multiccd_matters,
};
use clench_math::{Mask, Real, kernel};

/// What a step can find more of than the model's budget allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Excess {
    /// Pairs of geoms whose bounds meet.
    Pairs = 1,
    /// Contacts.
    Contacts,
    /// Numbers in the Jacobian of the contacts.
    Jacobian,
    /// Numbers in the factor of an island's Hessian, or in the matrix of `noslip`.
    Factor,
}

impl Excess {
    /// The excess of a code; `Factor` where it is none of the others.
    pub(crate) fn from_code(code: f64) -> Excess {
        let others = [Excess::Pairs, Excess::Contacts, Excess::Jacobian];
        let found = others.into_iter().find(|&one| f64::from(one as u8) == code);
        found.unwrap_or(Excess::Factor)
    }

    /// What there is too much of, and how much there may be.
    pub(crate) fn describe(self, budget: &Budget) -> (&'static str, u64) {
        match self {
            Excess::Pairs => ("pairs of geoms whose bounds meet", budget.pairs()),
            Excess::Contacts => ("contacts", budget.contacts),
            Excess::Jacobian => ("numbers in the Jacobian of the contacts", budget.matrix),
            Excess::Factor => (
                "numbers in the factor of the Hessian of an island",
                budget.matrix,
            ),
        }
    }
}

/// What detection keeps between steps.
#[derive(Clone, Debug)]
pub struct Collision<T: Real> {
    /// The workspace's contacts were given by the user: detection leaves them alone.
    pub given: bool,
    /// Lanes in which the last step found more contacts than the options allow.
    pub overflow: T::Mask,
    /// What the last step found so much of that it exceeds the model's budget, as the code of an [`Excess`]; such lanes have no
    /// contacts.
    pub excess: T,
    /// Pairs to look at, in canonical order.
    candidates: Vec<Candidate>,
    /// Those of them that may touch now.
    near: Vec<u32>,
    /// Finds the candidates of a large model anew each step; those of a small one never change.
    broad_phase: Option<Box<DynamicBroadPhase<T>>>,
    spheres: Vec<BoundingSphere<T>>,
    axes: SeparatingAxes<T>,
    /// Where the time goes, by kinds of pair.
    pub(crate) clock: PairClock,
    points: Contacts<T>,
    count: T,
    /// Numbers in the Jacobian of the contacts.
    numbers: T,
}

impl<T: Real> Collision<T> {
    /// Prepares detection for a model.
    pub fn new(model: &Model) -> Self {
        let listed = listed_candidates(model);
        let broad_phase = listed
            .is_none()
            .then(|| Box::new(DynamicBroadPhase::new(model)));
        Collision {
            given: false,
            overflow: T::Mask::splat(false),
            excess: T::ZERO,
            candidates: listed.unwrap_or_default(),
            broad_phase,
            near: Vec::new(),
            spheres: Vec::new(),
            axes: SeparatingAxes::default(),
            clock: PairClock::default(),
            points: Contacts::new(),
            count: T::ZERO,
            numbers: T::ZERO,
        }
    }

    /// Counts the lanes of a new contact, whose Jacobian has `numbers`; leaves those that have room for it.
    #[inline(always)]
    fn count_within_limit(
        &mut self,
        active: T::Mask,
        most: MaxContacts,
        numbers: usize,
        budget: &Budget,
    ) -> T::Mask {
        let full = match most {
            MaxContacts::Limit(most) => self.count.ge(T::new(most as f64)),
            MaxContacts::Auto => T::Mask::splat(false),
        };
        self.overflow |= active & full;
        let active = active & !full & self.excess.le(T::ZERO);
        self.count += T::select(active, T::ONE, T::ZERO);
        self.numbers += T::select(active, T::new(numbers as f64), T::ZERO);
        self.exceed(
            self.count.gt(T::new(budget.contacts as f64)),
            Excess::Contacts,
        );
        self.exceed(
            self.numbers.gt(T::new(budget.matrix as f64)),
            Excess::Jacobian,
        );
        active
    }

    /// Notes what lanes have too much of.
    #[inline(always)]
    fn exceed(&mut self, lanes: T::Mask, excess: Excess) {
        self.excess = T::select(lanes, T::new(f64::from(excess as u8)), self.excess);
    }
}

/// What sleeps: two bodies neither of which is awake make no contact.
struct Awake<'a, T: Real> {
    model: &'a Model,
    /// Nothing does without it.
    sleep: Option<&'a Sleep<T>>,
}

impl<T: Real> Awake<'_, T> {
    /// Lanes in which the geoms of a candidate can make a contact.
    #[inline(always)]
    fn of(&self, candidate: &Candidate) -> T::Mask {
        let Some(sleep) = self.sleep else {
            return T::Mask::splat(true);
        };
        sleep.is_either_awake(candidate.geoms.map(|g| self.model.geoms[g as usize].body))
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
    let awake = Awake {
        model,
        sleep: settings.flags.sleep.then_some(&ws.sleep),
    };
    collision.excess = T::ZERO;
    if collision.given {
        return;
    }
    contacts.clear();
    collision.overflow = T::Mask::splat(false);
    (collision.count, collision.numbers) = (T::ZERO, T::ZERO);
    if !settings.flags.constraint || !settings.flags.contact {
        return;
    }
    let spheres = &mut collision.spheres;
    if let Some(broad_phase) = &mut collision.broad_phase {
        broad_phase.update(model, params, pos, spheres);
        let crowded = broad_phase.find(model, &mut collision.candidates);
        collision.exceed(crowded, Excess::Pairs);
    } else {
        bounding_sphere::update(model, params, pos, 0..model.geoms.len(), spheres);
    }
    collision.near.clear();
    for (index, candidate) in collision.candidates.iter().enumerate() {
        let awake = awake.of(candidate);
        if !awake.any() {
            continue;
        }
        let range = || contact_range(model, params, candidate).1;
        let near = may_touch(candidate, &collision.spheres, pos, range);
        if (awake & near).any() {
            collision.near.push(index as u32);
        }
    }
    ws.clock.lap(Stage::BroadPhase as usize);
    collision.axes.reserve(collision.near.len());
    collision.clock.start();
    for near in 0..collision.near.len() {
        let candidate = collision.candidates[collision.near[near] as usize];
        let (axis, points) = (collision.axes.of(candidate.geoms), &mut collision.points);
        narrow(model, params, pos, &candidate, axis, points);
        let any = |lanes: T::Mask, point: &ContactPoint<T>| lanes | point.active;
        collision.clock.lap(candidate.kinds, T::LANES, || {
            let points = collision.points.as_slice().iter();
            points.fold(T::Mask::splat(false), any).count()
        });
        let [a, b] = candidate.kinds;
        if !settings.flags.multiccd && multiccd_matters(a, b) {
            collision.points.keep_deepest();
        }
        if !collision.points.as_slice().is_empty() {
            list(
                params, settings, pos, &candidate, &awake, collision, contacts,
            );
        }
    }
    // Nothing is computed for a step that cannot be.
    let within = collision.excess.le(T::ZERO);
    if !within.all() {
        contacts.iter_mut().for_each(|c| c.active &= within);
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
    axis: &mut SeparatingAxis<T>,
    points: &mut Contacts<T>,
) {
    let [a, b] = [candidate.geoms[0] as usize, candidate.geoms[1] as usize];
    let (shape_a, shape_b) = (shape(model, params, a), shape(model, params, b));
    let (pose_a, pose_b) = (pose(pos, a), pose(pos, b));
    let (_, range) = contact_range(model, params, candidate);
    collide_again(&shape_a, &pose_a, &shape_b, &pose_b, range, axis, points);
}

/// Makes contacts of the points of one candidate.
#[kernel]
fn list<T: Real>(
    params: &Params<T>,
    settings: &StepSettings,
    pos: &Positions<T>,
    candidate: &Candidate,
    awake: &Awake<T>,
    collision: &mut Collision<T>,
    contacts: &mut Vec<Contact<T>>,
) {
    let (model, awake) = (awake.model, awake.of(candidate));
    let mixed = contact_params(model, params, candidate);
    let dofs = |geom: u32| {
        let body = &model.bodies[model.geoms[geom as usize].body];
        body.last_dof.map_or(0, |dof| model.tree.row(dof).len())
    };
    let dofs = dofs(candidate.geoms[0]) + dofs(candidate.geoms[1]);
    let geoms = candidate.geoms.map(|g| g as usize);
    let adheres = !mixed.adhesion.eq(T::ZERO);
    for i in 0..collision.points.as_slice().len() {
        let point = collision.points.as_slice()[i];
        // Where a contact that adheres is within the gap, it is one without friction.
        let apart = adheres & !point.distance.lt(mixed.includemargin);
        for (lanes, dim) in [(!apart, mixed.dim), (apart, 1)] {
            let active = collision.count_within_limit(
                point.active & awake & lanes,
                settings.max_contacts,
                dim * dofs,
                &model.budget,
            );
            if !active.any() {
                continue;
            }
            contacts.push(Contact {
                geoms,
                active,
                dim,
                dist: point.distance,
                pos: point.position,
                frame: point.frame,
                includemargin: mixed.includemargin,
                friction: mixed.friction,
                solref: mixed.solref,
                solreffriction: mixed.solreffriction,
                solimp: mixed.solimp,
                adhesion: mixed.adhesion,
                surfacevel: surface::relative(params, pos, geoms, point.position, &point.frame),
                block: None,
            });
        }
    }
}

/// The shape of a geom.
#[inline(always)]
pub(crate) fn shape<'a, T: Real>(
    model: &'a Model,
    params: &Params<T>,
    geom: usize,
) -> Shape<'a, T> {
    Shape {
        kind: model.geoms[geom].kind,
        size: params.geom_size[geom],
        asset: model.asset(geom),
    }
}

/// The pose of a geom.
#[inline(always)]
pub(super) fn pose<T: Real>(pos: &Positions<T>, geom: usize) -> Pose<T> {
    Pose {
        position: pos.geom_xpos[geom],
        rotation: pos.geom_xmat[geom],
    }
}
