//! The state of a simulation in the number type that it is computed in, see [`Scalar::SingleEnv`]: the state itself, or
//! a copy in lanes.

use clench_dynamics::Step;
use clench_dynamics::model::Model;
use clench_dynamics::state::State;
use clench_math::{Real, Scalar};
use std::any::Any;

/// Memory for a copy in lanes, if one is needed.
pub(super) type LaneCopy<S> = Option<Box<State<<S as Scalar>::SingleEnv>>>;

/// Allocates memory for the states of a model.
pub(super) fn lane_copy<S: Scalar>(model: &Model) -> LaneCopy<S> {
    (S::SingleEnv::LANES > 1).then(|| Box::new(State::new(model)))
}

/// Calls `pass` with a state.
pub(super) fn read<S: Scalar, R>(
    state: &State<S>,
    lane_copy: &mut LaneCopy<S>,
    pass: impl FnOnce(&State<S::SingleEnv>) -> R,
) -> R {
    if let Some(copy) = lane_copy {
        (Step::compiled().splat_state)(copy, state);
        return pass(copy);
    }
    match (state as &dyn Any).downcast_ref() {
        Some(same) => pass(same),
        None => unreachable!("lanes have room for a copy"),
    }
}

/// Calls `pass` with a state that it advances.
pub(super) fn change<S: Scalar, R>(
    state: &mut State<S>,
    lane_copy: &mut LaneCopy<S>,
    pass: impl FnOnce(&mut State<S::SingleEnv>) -> R,
) -> R {
    if let Some(copy) = lane_copy {
        (Step::compiled().splat_state)(copy, state);
        let result = pass(copy);
        copy.write_moving(state);
        return result;
    }
    match (state as &mut dyn Any).downcast_mut() {
        Some(same) => pass(same),
        None => unreachable!("lanes have room for a copy"),
    }
}
