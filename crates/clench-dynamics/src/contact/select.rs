//! The pairs of geoms that may collide, selected by MuJoCo 4.0's rules.
//!
//! A pair of bodies cannot collide if both are welded together, if neither can move, if one is the parent of the other
//! (after welding; the world does not count as a parent, and the flag `filterparent` can be off), or if it is excluded.
//! Geoms of the remaining pairs collide if the type bits of one overlap the affinity bits of the other. Explicit pairs
//! always collide, once, with their own parameters.
//!
//! Candidates are in the order in which MuJoCo lists contacts: by body pair, explicit pairs first, then by geoms.

use crate::Model;
use crate::error::UnsupportedPair;
use crate::model::Geom;
use clench_collide::{ShapeKind, supported};

/// Two geoms that may collide, the one with the smaller shape kind first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// The geoms.
    pub geoms: [u32; 2],
    /// Their shapes.
    pub kinds: [ShapeKind; 2],
    /// The explicit pair, if any.
    pub pair: Option<u32>,
}

/// The maximum number of listed pairs: a list grows with the square of the geoms. Beyond, the broad phase runs in each
/// step.
const MAX_LISTED_PAIRS: usize = 1 << 13;
/// The same for static geoms: beyond, a tree over them finds the few that are near.
const MAX_LISTED_STATICS: usize = 128;
/// The same for all geoms, without counting pairs.
const MAX_COUNTED_GEOMS: usize = 1 << 10;

/// Returns all candidates of a model if comparing a list of them in each step is the fastest method.
#[cold] // Compiled for size.
#[inline(never)]
pub(super) fn listed_candidates(model: &Model) -> Option<Vec<Candidate>> {
    let stands = |geom: &Geom| model.bodies[model.bodies[geom.body].weld].dofs.is_empty();
    let roles = model.geoms.iter().zip(match_any(model));
    let (mut all, mut statics) = (0, 0);
    for (geom, _) in roles.filter(|&(_, meets)| meets) {
        all += 1;
        statics += usize::from(stands(geom));
    }
    let few = all <= MAX_COUNTED_GEOMS && statics <= MAX_LISTED_STATICS;
    few.then(|| candidates_up_to(model, MAX_LISTED_PAIRS))?
}

/// Returns all candidates of a model, in canonical order.
pub fn candidates(model: &Model) -> Vec<Candidate> {
    candidates_up_to(model, usize::MAX).unwrap_or_default()
}

/// Returns all candidates in canonical order; `None` if there are more than `limit`.
fn candidates_up_to(model: &Model, limit: usize) -> Option<Vec<Candidate>> {
    let meets = match_any(model);
    let collides = |&body: &usize| model.bodies[body].geoms.clone().any(|g| meets[g]);
    let bodies = Vec::from_iter((0..model.nbody()).filter(collides));
    let explicit = (0..model.pairs.len()).map(|p| explicit(model, p as u32));
    let mut found = Vec::from_iter(explicit);
    for (index, &body1) in bodies.iter().enumerate() {
        for &body2 in &bodies[index + 1..] {
            if !bodies_may_collide(model, body1, body2) {
                continue;
            }
            for g1 in model.bodies[body1].geoms.clone() {
                for g2 in model.bodies[body2].geoms.clone() {
                    if masks_match(model, g1, g2) && !is_explicit(model, g1, g2) {
                        found.push(Candidate::new(model, [g1, g2], None));
                    }
                }
            }
            if found.len() > limit {
                return None;
            }
        }
    }
    sort(model, &mut found);
    Some(found)
}

/// Brings candidates into canonical order, in which no two are equal.
pub(super) fn sort(model: &Model, candidates: &mut [Candidate]) {
    candidates.sort_unstable_by_key(|c| c.order(model));
}

/// Returns, for each geom, true if its type or affinity bits overlap those of any geom, including itself; false for
/// visual geoms.
pub(super) fn match_any(model: &Model) -> Vec<bool> {
    let (mut contypes, mut conaffinities) = (0, 0);
    for geom in &model.geoms {
        contypes |= geom.contype;
        conaffinities |= geom.conaffinity;
    }
    let meets = |geom: &Geom| geom.contype & conaffinities != 0 || geom.conaffinity & contypes != 0;
    model.geoms.iter().map(meets).collect()
}

/// Returns the candidate of explicit pair `pair`.
pub(super) fn explicit(model: &Model, pair: u32) -> Candidate {
    Candidate::new(model, model.pairs[pair as usize].geoms, Some(pair))
}

/// Returns true if two geoms that are no explicit pair may collide.
pub(super) fn geoms_may_collide(model: &Model, g1: usize, g2: usize) -> bool {
    masks_match(model, g1, g2)
        && bodies_may_collide(model, model.geoms[g1].body, model.geoms[g2].body)
        && !is_explicit(model, g1, g2)
}

/// Checks that the narrow phase supports all pairs of shapes that may collide.
///
/// # Errors
/// Returns the first unsupported pair.
pub fn check_supported(model: &Model) -> Result<(), UnsupportedPair> {
    let unsupported = |c: &Candidate| !supported(c.kinds[0], c.kinds[1]);
    let mut explicit = (0..model.pairs.len()).map(|p| explicit(model, p as u32));
    let found = explicit.find(unsupported);
    let Some(candidate) = found.or_else(|| find_unsupported(model)) else {
        return Ok(());
    };
    let geoms = candidate.geoms.map(|g| g as usize);
    let name = |g: usize| match model.geoms[g].name.as_str() {
        "" => format!("{g}"),
        name => format!("\"{name}\""),
    };
    let [a, b] = geoms.map(|g| &model.geoms[g]);
    let location = match b.origin.as_ref().or(a.origin.as_ref()) {
        Some(origin) => format!("{origin}: "),
        None => String::new(),
    };
    Err(UnsupportedPair {
        location,
        first: name(geoms[0]),
        second: name(geoms[1]),
        kinds: format!("{:?} against {:?}", a.kind, b.kind).to_lowercase(),
    })
}

/// Finds two geoms that may collide, no explicit pair, of unsupported kinds. Such kinds are few, so few geoms are
/// compared.
fn find_unsupported(model: &Model) -> Option<Candidate> {
    let of_kind = |kind: ShapeKind| {
        let geoms = model.geoms.iter().enumerate();
        let geoms = geoms.filter(|(_, geom)| geom.kind == kind);
        (kind, Vec::from_iter(geoms.map(|(g, _)| g)))
    };
    let kinds = ShapeKind::ALL.map(of_kind);
    for (i, (kind1, geoms1)) in kinds.iter().enumerate() {
        for (kind2, geoms2) in &kinds[i..] {
            if supported(*kind1, *kind2) {
                continue;
            }
            for &g1 in geoms1 {
                let mut others = geoms2.iter().copied();
                if let Some(g2) = others.find(|&g2| geoms_may_collide(model, g1, g2)) {
                    return Some(Candidate::new(model, [g1.min(g2), g1.max(g2)], None));
                }
            }
        }
    }
    None
}

impl Candidate {
    /// Creates a candidate of two geoms in any order; geoms of equal kind keep their order.
    pub(super) fn new(model: &Model, geoms: [usize; 2], pair: Option<u32>) -> Self {
        let [g1, g2] = geoms;
        let swap = model.geoms[g1].kind > model.geoms[g2].kind;
        let geoms = if swap { [g2, g1] } else { [g1, g2] };
        Candidate {
            geoms: geoms.map(|g| g as u32),
            kinds: geoms.map(|g| model.geoms[g].kind),
            pair,
        }
    }

    /// Returns the sort key of the canonical order.
    pub(super) fn order(&self, model: &Model) -> (usize, usize, u32, [u32; 2]) {
        let [a, b] = self.geoms.map(|g| model.geoms[g as usize].body);
        (
            a.min(b),
            a.max(b),
            self.pair.unwrap_or(u32::MAX),
            self.geoms,
        )
    }
}

fn masks_match(model: &Model, g1: usize, g2: usize) -> bool {
    let (a, b) = (&model.geoms[g1], &model.geoms[g2]);
    a.contype & b.conaffinity != 0 || b.contype & a.conaffinity != 0
}

fn is_explicit(model: &Model, g1: usize, g2: usize) -> bool {
    let same = |geoms: [usize; 2]| geoms == [g1, g2] || geoms == [g2, g1];
    model.pairs.iter().any(|pair| same(pair.geoms))
}

fn bodies_may_collide(model: &Model, body1: usize, body2: usize) -> bool {
    let weld = |body: usize| model.bodies[body].weld;
    let (weld1, weld2) = (weld(body1), weld(body2));
    let moves = |body: usize| !model.bodies[body].dofs.is_empty();
    if weld1 == weld2 || !(moves(weld1) || moves(weld2)) {
        return false;
    }
    let parent = |body: usize| weld(model.bodies[body].parent);
    let related = weld1 == parent(weld2) || weld2 == parent(weld1);
    if model.flags.filterparent && weld1 != 0 && weld2 != 0 && related {
        return false;
    }
    let key = (body1.min(body2) as u32, body1.max(body2) as u32);
    !model.excludes.contains(&key)
}
