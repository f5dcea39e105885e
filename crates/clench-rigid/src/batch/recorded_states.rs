//! The positions and velocities for which recorded outputs hold.

use super::cells::Cells;
use super::shared::Shared;
use super::{Rows, StateRows};
use clench_dynamics::error::SimError;
use clench_dynamics::model::Model;
use clench_dynamics::state::State;
use clench_dynamics::state::kind::{Number, Quaternion, Vector};
use clench_math::{Real, Scalar};

/// Each environment's state when its outputs were last recorded, as far as they depend on it. Stored only while needed.
pub(super) struct RecordedStates<S> {
    qpos: Rows<S>,
    qvel: Rows<S>,
    mocap_pos: Rows<S>,
    mocap_quat: Rows<S>,
}

impl<S: Scalar + Shared> RecordedStates<S> {
    pub(super) fn new(model: &Model, count: usize) -> Result<Self, SimError> {
        // NaN differs from every number, including itself.
        let rows = |width| Rows::new(count, width, S::new(f64::NAN));
        Ok(RecordedStates {
            qpos: rows(model.nq)?,
            qvel: rows(model.nv)?,
            mocap_pos: rows(3 * model.nmocap)?,
            mocap_quat: rows(4 * model.nmocap)?,
        })
    }

    /// Returns the bytes per environment.
    pub(super) fn row_bytes(&self) -> usize {
        let tables = [&self.qpos, &self.qvel, &self.mocap_pos, &self.mocap_quat];
        tables.iter().map(|rows| rows.row_bytes()).sum()
    }

    /// Returns true if the recorded outputs of environment `env` hold for its state.
    pub(super) fn holds(&self, env: usize, state: &StateRows<S>) -> bool {
        self.qpos.row(env) == state.qpos.row(env)
            && self.qvel.row(env) == state.qvel.row(env)
            && self.mocap_pos.row(env) == state.mocap_pos.row(env)
            && self.mocap_quat.row(env) == state.mocap_quat.row(env)
    }

    /// Records that the outputs of environment `env` hold for the state in its rows.
    pub(super) fn record_row(&mut self, env: usize, state: &StateRows<S>) {
        self.qpos.row_mut(env).copy_from_slice(state.qpos.row(env));
        self.qvel.row_mut(env).copy_from_slice(state.qvel.row(env));
        (self.mocap_pos.row_mut(env)).copy_from_slice(state.mocap_pos.row(env));
        (self.mocap_quat.row_mut(env)).copy_from_slice(state.mocap_quat.row(env));
    }

    /// Invalidates the recorded outputs of environment `env`.
    pub(super) fn invalidate(&mut self, env: usize) {
        self.qpos.row_mut(env).fill(S::new(f64::NAN));
        self.qvel.row_mut(env).fill(S::new(f64::NAN));
    }

    pub(super) fn share(&mut self) -> RecordedStateCells<'_, S> {
        RecordedStateCells {
            qpos: Cells::new(&mut self.qpos),
            qvel: Cells::new(&mut self.qvel),
            mocap_pos: Cells::new(&mut self.mocap_pos),
            mocap_quat: Cells::new(&mut self.mocap_quat),
        }
    }
}

/// The tables in the form that a step writes.
pub struct RecordedStateCells<'a, S: Scalar + Shared> {
    qpos: Cells<'a, S>,
    qvel: Cells<'a, S>,
    mocap_pos: Cells<'a, S>,
    mocap_quat: Cells<'a, S>,
}

impl<S: Scalar + Shared> RecordedStateCells<'_, S> {
    /// Records the state of an environment whose outputs were recorded.
    pub fn record<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &State<T>) {
        self.qpos.write::<Number, T>(env, lane, &state.qpos);
        self.qvel.write::<Number, T>(env, lane, &state.qvel);
        (self.mocap_pos).write::<Vector, T>(env, lane, &state.mocap_pos);
        (self.mocap_quat).write::<Quaternion, T>(env, lane, &state.mocap_quat);
    }
}
