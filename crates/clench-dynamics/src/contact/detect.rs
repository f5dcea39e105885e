//! Finds the contacts of a configuration: bounding spheres, then the narrow phase, in slots that all lanes share.

use super::bounding_box::{boxes_may_touch, pays};
use super::bounding_sphere::{self, may_touch};
use super::collision::{Collision, Excess};
use super::pair_finder::PairFinder;
use super::{Candidate, Contact, contact_params, contact_range, surface};
use crate::context::StepContext;
use crate::model::{Model, Params};
use crate::profile::Stage;
use crate::settings::StepSettings;
use crate::sleep::Sleep;
use crate::stages::Positions;
use crate::workspace::Workspace;
use clench_collide::ContactPoint;
use clench_math::{Mask, Real, kernel};
use clench_solver::Threads;
use std::ops::Range;

/// The awake bodies: two sleeping bodies make no contact.
struct Awake<'a, T: Real> {
    model: &'a Model,
    /// `None` if trees cannot sleep.
    sleep: Option<&'a Sleep<T>>,
}

impl<T: Real> Awake<'_, T> {
    /// Returns the lanes in which the geoms of a candidate can make a contact.
    #[inline(always)]
    fn of(&self, candidate: &Candidate) -> T::Mask {
        let Some(sleep) = self.sleep else {
            return T::Mask::splat(true);
        };
        sleep.is_either_awake(candidate.geoms.map(|g| self.model.geoms[g as usize].body))
    }
}

/// The number of finders per thread: more than one, so that threads finish together although pairs take unequal times.
const FINDERS_PER_THREAD: usize = 4;
/// The minimum number of pairs that justifies a thread.
const MIN_PAIRS: usize = 8;

/// Fills `ws.contacts` from the geoms' poses, in canonical order.
#[kernel]
pub fn detect<T: Real>(context: StepContext<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    let (collision, contacts, pos) = (&mut ws.collision, &mut ws.contacts, &ws.position);
    let awake = Awake {
        model,
        sleep: settings.flags.sleep.then_some(&ws.sleep),
    };
    collision.excess = T::ZERO;
    if collision.contacts_provided {
        return;
    }
    contacts.clear();
    collision.overflow = T::Mask::splat(false);
    (collision.contact_count, collision.jacobian_size) = (T::ZERO, T::ZERO);
    if !settings.flags.constraint || !settings.flags.contact {
        if let Some(broad_phase) = &mut collision.broad_phase {
            broad_phase.invalidate();
        }
        return;
    }
    collision.near.clear();
    let spheres = &mut collision.spheres;
    let trees = awake.sleep.map(Sleep::trees);
    if let Some(broad_phase) = &mut collision.broad_phase {
        let version = ws.fixed.version();
        broad_phase.update(model, params, pos, version, ws.sleep.trees(), spheres);
        let too_many = broad_phase.find(model, trees, &mut collision.candidates);
        collision.record_excess(too_many, Excess::Pairs);
    } else {
        let body_pairs = &mut collision.body_pairs;
        bounding_sphere::update(model, params, pos, body_pairs.geoms(), spheres);
        body_pairs.update(spheres);
        collision.awake_pairs.mark(trees);
    }
    let (listed, runs) = match collision.broad_phase {
        None => (true, collision.body_pairs.len()),
        Some(_) => (false, 1),
    };
    for run in 0..runs {
        let mut rest = match listed {
            true => collision.body_pairs.near(run).unwrap_or_default(),
            false => 0..collision.candidates.len(),
        };
        while let Some(candidates) = collision.awake_pairs.next(&mut rest) {
            find_near(params, pos, &awake, candidates, listed, collision);
        }
    }
    ws.clock.lap(Stage::BroadPhase as usize);
    find_points(context, pos, &ws.threads, collision);
    let finders = std::mem::take(&mut collision.finders);
    for (candidate, points) in finders.iter().flat_map(PairFinder::touching) {
        let candidate = collision.candidates[candidate as usize];
        push_contacts(
            (params, settings, pos),
            (&candidate, points),
            &awake,
            collision,
            contacts,
        );
    }
    collision.finders = finders;
    // A lane over the budget fails its step: no constraint is computed for it.
    let within = collision.excess.le(T::ZERO);
    if !within.all() {
        contacts.iter_mut().for_each(|c| c.active &= within);
    }
    ws.clock.lap(Stage::NarrowPhase as usize);
}

/// Appends the candidates that may touch in any lane to the near pairs. If they are `listed` it also compares their
/// boxes; a broad phase has done so for its own candidates.
#[inline(always)]
fn find_near<T: Real>(
    params: &Params<T>,
    pos: &Positions<T>,
    awake: &Awake<T>,
    candidates: Range<usize>,
    listed: bool,
    collision: &mut Collision<T>,
) {
    for index in candidates {
        let candidate = &collision.candidates[index];
        // With one lane, the listed candidates are known to be awake. To check them again takes 3% of a step in which
        // most of 76 boxes sleep.
        let awake_in = match listed && T::LANES == 1 {
            true => T::Mask::splat(true),
            false => awake.of(candidate),
        };
        if !awake_in.any() {
            continue;
        }
        let range = || contact_range(awake.model, params, candidate).1;
        let mut near = awake_in & may_touch(candidate, &collision.spheres, pos, range);
        if near.any() && listed && pays(candidate) {
            near &= boxes_may_touch(awake.model, params, pos, candidate, range());
        }
        if near.any() {
            collision.near.push(index as u32);
        }
    }
}

/// Finds the points of all near candidates, in order, with a number of finders that suits the work.
fn find_points<T: Real>(
    context: StepContext<T>,
    pos: &Positions<T>,
    threads: &Threads,
    collision: &mut Collision<T>,
) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    let (near, candidates, axes) = (&collision.near, &collision.candidates, &mut collision.axes);
    axes.begin(near.len());
    let limit = (threads.count() > 1).then_some(threads.count() * FINDERS_PER_THREAD);
    let count = limit.unwrap_or(1).min(near.len() / MIN_PAIRS).max(1);
    let finders = &mut collision.finders;
    if finders.len() < count {
        finders.resize_with(count, PairFinder::default);
    }
    // Unused finders retain their memory for another step.
    finders.iter_mut().for_each(PairFinder::clear);
    let finders = &mut finders[..count];
    for (k, finder) in finders.iter_mut().enumerate() {
        let pairs = near.len() * k / count..near.len() * (k + 1) / count;
        let envs = &collision.environments;
        finder.begin(&near[pairs], candidates, axes, envs, &collision.clock);
    }
    let multiccd = settings.flags.multiccd;
    threads.for_each(finders, |finder| {
        finder.find(model, params, multiccd, pos, candidates);
    });
    for finder in finders {
        finder.end(axes, &mut collision.clock);
    }
}

/// Appends a contact for each point of one candidate.
#[kernel]
fn push_contacts<T: Real>(
    (params, settings, pos): (&Params<T>, &StepSettings, &Positions<T>),
    (candidate, points): (&Candidate, &[ContactPoint<T>]),
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
    for point in points {
        // A contact that adheres has no friction within the gap.
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
