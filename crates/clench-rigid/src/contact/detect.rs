//! Finds the contacts of a configuration: bounding spheres, then the narrow phase, in slots that all lanes share.

use super::select::{explicit, geoms_may_collide};
use super::{Candidate, Contact, candidates, contact_params, contact_range};
use crate::model::{Model, Params};
use crate::settings::StepSettings;
use crate::workspace::{Positions, Workspace};
use clench_collide::{Bound, Contacts, Pose, Shape, ShapeKind, Sweep, collide, near};
use clench_math::{Mask, Real};
use clench_solver::MaxContacts;

/// Above this many geoms the pairs are not listed but swept for: a list grows with the square.
const MOST_LISTED_GEOMS: usize = 128;

/// What detection keeps between steps: the pairs of a small model, or the sweep of a large one.
#[derive(Clone, Debug)]
pub struct Collision<T: Real> {
    /// The workspace's contacts were given by the user: detection leaves them alone.
    pub given: bool,
    /// Lanes in which the last step found more contacts than the options allow.
    pub overflow: T::Mask,
    pairs: Pairs<T>,
    points: Contacts<T>,
    count: T,
}

#[derive(Clone, Debug)]
enum Pairs<T> {
    Listed(Vec<Candidate>),
    Swept {
        sweep: Sweep,
        bounds: Vec<Bound<T>>,
        poses: Vec<Pose<T>>,
        margins: Vec<T>,
        hits: Vec<(u32, u32)>,
        candidates: Vec<Candidate>,
    },
}

impl<T: Real> Collision<T> {
    /// Prepares detection for a model.
    pub fn new(model: &Model) -> Self {
        let pairs = if model.geoms.len() <= MOST_LISTED_GEOMS {
            Pairs::Listed(candidates(model))
        } else {
            Pairs::Swept {
                sweep: Sweep::new(),
                bounds: Vec::new(),
                poses: Vec::new(),
                margins: Vec::new(),
                hits: Vec::new(),
                candidates: Vec::new(),
            }
        };
        Collision {
            given: false,
            overflow: T::Mask::splat(false),
            pairs,
            points: Contacts::new(),
            count: T::ZERO,
        }
    }
}

/// Fills `ws.contacts` from the geoms' poses, in canonical order.
pub fn detect<T: Real>(
    model: &Model,
    params: &Params<T>,
    settings: &StepSettings,
    ws: &mut Workspace<T>,
) {
    let (collision, contacts) = (&mut ws.collision, &mut ws.contacts);
    if collision.given {
        return;
    }
    contacts.clear();
    collision.overflow = T::Mask::splat(false);
    collision.count = T::ZERO;
    if !settings.flags.constraint || !settings.flags.contact {
        return;
    }
    collision.pairs.update(model, params, &ws.position);
    let (Pairs::Listed(candidates) | Pairs::Swept { candidates, .. }) = &collision.pairs;
    for candidate in candidates {
        narrow(
            model,
            params,
            &ws.position,
            candidate,
            &mut collision.points,
        );
        if collision.points.as_slice().is_empty() {
            continue;
        }
        let mixed = contact_params(model, params, candidate);
        for point in collision.points.as_slice() {
            let mut active = point.active;
            if let MaxContacts::Limit(most) = settings.solver.max_contacts {
                let full = collision.count.ge(T::new(most as f64));
                collision.overflow |= active & full;
                active &= !full;
                collision.count += T::select(active, T::ONE, T::ZERO);
            }
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
    points.clear();
    let [a, b] = candidate.geoms.map(|g| g as usize);
    let (pose_a, pose_b) = (pose(pos, a), pose(pos, b));
    let (_, range) = contact_range(model, params, candidate);
    let (bound_a, bound_b) = (bound(model, params, a), bound(model, params, b));
    if !near(&bound_a, &pose_a, &bound_b, &pose_b, range).any() {
        return;
    }
    let shape = |g: usize| Shape {
        kind: model.geoms[g].kind,
        size: params.geom_size[g],
    };
    collide(&shape(a), &pose_a, &shape(b), &pose_b, range, points);
}

#[inline(always)]
fn pose<T: Real>(pos: &Positions<T>, geom: usize) -> Pose<T> {
    Pose {
        position: pos.geom_xpos[geom],
        rotation: pos.geom_xmat[geom],
    }
}

#[inline(always)]
fn bound<T: Real>(model: &Model, params: &Params<T>, geom: usize) -> Bound<T> {
    Bound {
        radius: params.geom_rbound[geom],
        plane: model.geoms[geom].kind == ShapeKind::Plane,
    }
}

impl<T: Real> Pairs<T> {
    /// Brings the candidates of a swept model up to date; a list always is.
    fn update(&mut self, model: &Model, params: &Params<T>, pos: &Positions<T>) {
        let Pairs::Swept {
            sweep,
            bounds,
            poses,
            margins,
            hits,
            candidates,
        } = self
        else {
            return;
        };
        let ngeom = model.geoms.len();
        bounds.clear();
        poses.clear();
        margins.clear();
        bounds.extend((0..ngeom).map(|g| bound(model, params, g)));
        poses.extend((0..ngeom).map(|g| pose(pos, g)));
        margins.extend((0..ngeom).map(|g| {
            let margin = if model.override_contacts {
                params.override_margin * T::new(0.5)
            } else {
                params.geom_margin[g]
            };
            margin + params.geom_gap[g]
        }));
        let allowed = |g1: u32, g2: u32| geoms_may_collide(model, g1 as usize, g2 as usize);
        sweep.pairs(bounds, poses, margins, allowed, hits);
        candidates.clear();
        candidates.extend((0..model.pairs.len()).map(|p| explicit(model, p as u32)));
        candidates.extend(
            hits.iter()
                .map(|&(g1, g2)| Candidate::new(model, [g1 as usize, g2 as usize], None)),
        );
        candidates.sort_unstable_by_key(|c| c.order(model));
    }
}
