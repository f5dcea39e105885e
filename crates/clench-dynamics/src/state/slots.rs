//! The slots of a state for constraints that are added at run time. A slot ties two bodies, or is empty; lanes may tie
//! different bodies in it.

use super::State;
use crate::model::Model;
use clench_math::{Mask, Real, Scalar};

/// The `dynamic_kind` of a connect.
pub const CONNECT: f64 = 1.0;
/// The `dynamic_kind` of a weld.
pub const WELD: f64 = 2.0;

/// The contents of a slot in some lanes.
pub(crate) struct Tie<T: Real> {
    pub bodies: [usize; 2],
    /// True for a weld, false for a connect.
    pub weld: bool,
    pub lanes: T::Mask,
}

/// Calls `show` once for each pair of bodies that a slot ties, with the lanes that tie it.
#[inline(always)]
pub(crate) fn each_tie<T: Real>(
    model: &Model,
    state: &State<T>,
    slot: usize,
    mut show: impl FnMut(Tie<T>),
) {
    let kinds = state.dynamic_kind[slot];
    if !kinds.gt(T::ZERO).any() {
        return;
    }
    let (body1, body2) = (state.dynamic_body1[slot], state.dynamic_body2[slot]);
    let mut shown = T::Mask::splat(false);
    for lane in 0..T::LANES {
        if shown.lane(lane) {
            continue;
        }
        let Some((weld, bodies)) = tied(model, state, slot, lane) else {
            continue;
        };
        let same = |numbers: T| numbers.eq(T::splat(numbers.lane(lane)));
        let lanes = same(kinds) & same(body1) & same(body2);
        shown |= lanes;
        show(Tie {
            bodies,
            weld,
            lanes,
        });
    }
}

/// Returns true if a slot holds a weld in a lane, and its bodies; `None` if it is empty or does not name two bodies of
/// the model.
pub fn tied<T: Real>(
    model: &Model,
    state: &State<T>,
    slot: usize,
    lane: usize,
) -> Option<(bool, [usize; 2])> {
    let number = |x: T| x.lane(lane).to_f64();
    let kind = number(state.dynamic_kind[slot]);
    if kind != CONNECT && kind != WELD {
        return None;
    }
    let body = |x: T| (0..model.nbody()).find(|&body| number(x) == body as f64);
    let bodies = [
        body(state.dynamic_body1[slot])?,
        body(state.dynamic_body2[slot])?,
    ];
    (bodies[0] != bodies[1]).then_some((kind == WELD, bodies))
}
