//! Queries of the states of environments, answered in lanes.

use super::cells::Cells;
use super::env_rows::EnvRows;
use super::group::Group;
use super::shared::Shared;
use crate::ik::{Ik, Search};
use crate::query::{Query, QueryInput, geom_of};
use crate::sensor;
use crate::sensor::bodies::update as update_body_forces;
use clench_dynamics::Step;
use clench_dynamics::context::StepContext;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, Scalar, write_lane};

/// The query of a call.
pub enum BatchQuery<'a, S> {
    /// A query of the table.
    Table(Query<'a>),
    /// Inverse kinematics. Input: goals, and optional start positions instead of the present ones.
    Kinematics {
        ik: &'a Ik,
        start: Option<QueryInput<'a, S>>,
    },
}

impl<S> BatchQuery<'_, S> {
    /// Returns the geoms without which there is no answer.
    pub(super) fn geoms(&self) -> Vec<usize> {
        match *self {
            BatchQuery::Table(query) => query.geoms(),
            BatchQuery::Kinematics { ik, .. } => {
                let tasks = ik.tasks().iter();
                tasks
                    .filter_map(|task| geom_of(task.target.object()?))
                    .collect()
            }
        }
    }
}

/// A query of a group of environments.
pub struct QueryCall<'a, S: Scalar + Shared> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    pub rows: EnvRows<'a, S>,
    pub query: BatchQuery<'a, S>,
    pub input: QueryInput<'a, S>,
    /// The number of input values per environment.
    pub width: usize,
    pub answers: Cells<'a, S>,
}

impl<S: Scalar + Shared> QueryCall<'_, S> {
    /// Appends the answer for environments whose states are in lanes, and returns the lanes in which it is valid.
    pub fn answer<T: Real<Scalar = S>>(
        &self,
        group: &Group<T>,
        (params, state, ws): (&Params<T>, &State<T>, &mut Workspace<T>),
        memory: &mut QueryMemory<T>,
        out: &mut Vec<T>,
    ) -> T::Mask {
        let QueryMemory { input, search } = memory;
        self.gather(group, &self.input, self.width, input);
        let everywhere = T::Mask::splat(true);
        let query = match &self.query {
            BatchQuery::Table(query) => *query,
            BatchQuery::Kinematics { ik, start } => {
                let memory = search.take().filter(|memory| memory.fits(self.model, ik));
                let search = search.insert(memory.unwrap_or_else(|| Search::new(self.model, ik)));
                search.state.copy_from(state);
                if let Some(start) = start {
                    self.gather(group, start, self.model.nq, &mut search.state.qpos);
                }
                search.goals.copy_from_slice(input);
                search.run(self.model, params, ik);
                search.write(out);
                return everywhere;
            }
        };
        let context = StepContext {
            model: self.model,
            params,
            settings: self.settings,
            sensors: sensor::evaluate,
        };
        if let Query::Inverse(kind) = query {
            out.resize(self.model.nv, T::ZERO);
            let input = (&input[..], kind);
            (Step::compiled().inverse)(context, state, input, ws, out);
            return clench_dynamics::check::good_results(state, ws);
        }
        if let Query::Acceleration(..) = query {
            ws.invalidate_poses();
            (Step::compiled().forward)(context, state, ws);
            update_body_forces(self.model, params, state, ws);
        } else {
            (Step::compiled().position_stage)(self.model, params, state, ws);
        }
        if let Query::Velocity(..) | Query::JacobianRate(_) = query {
            let parts = ws.sleep.computed();
            let (pos, vel) = (&ws.position, &mut ws.velocity);
            (Step::compiled().velocities)(self.model, parts, pos, &state.qvel, vel);
        }
        query.write((self.model, params, ws), input, out);
        if let Query::Acceleration(..) = query {
            return clench_dynamics::check::good_results(state, ws) & !ws.collision.overflow;
        }
        if let Query::SolveMass = query {
            return !ws.singular;
        }
        everywhere
    }

    fn gather<T: Real<Scalar = S>>(
        &self,
        group: &Group<T>,
        input: &QueryInput<S>,
        width: usize,
        lanes: &mut Vec<T>,
    ) {
        lanes.resize(width, T::ZERO);
        for (lane, env) in group.fill() {
            write_lane(input.row(env, width), lane, lanes);
        }
    }
}

/// Scratch memory of queries.
pub struct QueryMemory<T: Real> {
    input: Vec<T>,
    search: Option<Search<T>>,
}

impl<T: Real> QueryMemory<T> {
    pub fn new() -> Self {
        QueryMemory {
            input: Vec::new(),
            search: None,
        }
    }
}
