//! Queries of all environments of a batch at once, answered from the states in their rows, in lanes and on several
//! threads.
//!
//! No result of an earlier step is used, so that an answer always holds for the present state, even after a step. An
//! environment whose state is invalid, or whose model lacks a geom of the query, gets NaN. Environments that do not run
//! are included.

use super::answer::{BatchQuery, QueryCall};
use super::cells::Cells;
use super::env_rows::EnvRows;
use super::run::for_each_group;
use super::{Batch, Precision, Rows};
use crate::ik::{Ik, IkSolution};
use crate::query::{Query, QueryInput};
use clench_dynamics::error::SimError;
use clench_dynamics::geometry::RayFilter;
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::FrameObject;

impl<S: Precision> Batch<S> {
    /// Answers a query about the present state of each environment; NaN where there is no answer.
    ///
    /// # Errors
    /// Returns an error if there is no such object, if the number of input values is wrong or one is not finite, or as
    /// [`step`](Self::step) does.
    pub fn answer(&mut self, query: Query<'_>, input: QueryInput<S>) -> Result<Rows<S>, SimError> {
        let width = query.check(&self.model, &input, self.count())?;
        self.run_query(BatchQuery::Table(query), input, width)
    }

    /// Returns the Jacobian of the centre of mass of a body's subtree (n, 3 × nv), see
    /// [`Sim::subtree_jacobian`](crate::Sim::subtree_jacobian).
    ///
    /// # Errors
    /// See [`jacobian`](Self::jacobian).
    pub fn subtree_jacobian(&mut self, body: usize) -> Result<Rows<S>, SimError> {
        self.answer(Query::SubtreeJacobian(body), QueryInput::Shared(&[]))
    }

    /// Returns the first hit of each ray in each environment, see [`Sim::rays`](crate::Sim::rays), as five values per
    /// ray (n, k × 5): the geom, or −1; the distance, or infinity; the normal.
    ///
    /// # Errors
    /// Returns an error if the number of values is wrong, or as [`Sim::rays`](crate::Sim::rays) and
    /// [`step`](Self::step) do.
    pub fn rays(
        &mut self,
        rays: QueryInput<S>,
        frame: Option<FrameObject>,
        filter: &RayFilter,
    ) -> Result<Rows<S>, SimError> {
        self.answer(Query::Rays { frame, filter }, rays)
    }

    /// Returns heights of a height field in each environment (n, k), see [`Sim::heights`](crate::Sim::heights).
    ///
    /// # Errors
    /// Returns an error if the number of values is wrong, or as [`Sim::heights`](crate::Sim::heights) and
    /// [`step`](Self::step) do.
    pub fn heights(
        &mut self,
        geom: usize,
        places: QueryInput<S>,
        frame: Option<FrameObject>,
    ) -> Result<Rows<S>, SimError> {
        self.answer(Query::Heights { geom, frame }, places)
    }

    /// Returns the forces along dofs (n, nv) that cause the accelerations `qacc` in the present states, see
    /// [`Sim::inverse`](crate::Sim::inverse). Environments that fail get NaN.
    ///
    /// # Errors
    /// Returns an error if the number of accelerations is wrong, if one is not finite, or if
    /// [`Sim::inverse`](crate::Sim::inverse) does not support this kind, or as [`step`](Self::step) does.
    pub fn inverse(
        &mut self,
        qacc: QueryInput<S>,
        kind: Acceleration,
    ) -> Result<Rows<S>, SimError> {
        self.answer(Query::Inverse(kind), qacc)
    }

    /// Returns joint positions that bring the tasks of `ik` to their goals in each environment, from the present states
    /// or from `start` (nq per environment), see [`Sim::ik`](crate::Sim::ik). Environments whose model lacks a geom of
    /// the tasks get NaN and [`IkStatus::NonFinite`](crate::ik::IkStatus::NonFinite).
    ///
    /// # Errors
    /// Returns an error if the tasks are of a model with other objects, if the number of goal or start values is wrong
    /// or one is not finite, or as [`step`](Self::step) does.
    pub fn ik(
        &mut self,
        ik: &Ik,
        goals: QueryInput<S>,
        start: Option<QueryInput<S>>,
    ) -> Result<Vec<IkSolution<S>>, SimError> {
        ik.check_model(&self.model)?;
        goals.check("goals", ik.goal_len(&self.model), self.count())?;
        if let Some(start) = &start {
            start.check("start", self.model.nq, self.count())?;
        }
        let width = IkSolution::<S>::width(&self.model, ik);
        let rows = self.run_query(BatchQuery::Kinematics { ik, start }, goals, width)?;
        let nq = self.model.nq;
        Ok(rows.iter().map(|row| IkSolution::read(row, nq)).collect())
    }

    fn run_query(
        &mut self,
        query: BatchQuery<S>,
        input: QueryInput<S>,
        width: usize,
    ) -> Result<Rows<S>, SimError> {
        self.check_state()?;
        self.check_threads()?;
        let count = self.count();
        let mut answers = Rows::new(count, width, S::new(f64::NAN))?;
        self.order.clear();
        let geoms = query.geoms();
        let models = 0..self.models().len();
        let answers_for = Vec::from_iter(models.map(|model| self.models.have(model, &geoms)));
        let envs = (0..count).filter(|&env| answers_for[self.models.of(env)]);
        self.order.extend(envs.map(|env| env as u32));
        let (motion, inputs) = self.state.share();
        let call = QueryCall {
            model: &self.model,
            settings: &self.settings,
            rows: EnvRows {
                motion,
                inputs,
                models: &self.models,
                params: &self.params,
            },
            query,
            width: input.width(count),
            input,
            answers: Cells::new(&mut answers),
        };
        let (steppers, order) = (&mut self.steppers, &self.order);
        self.threads.run(|| {
            for_each_group(steppers, order, |stepper, group| {
                stepper.query(group, &call)
            })
        });
        Ok(answers)
    }
}
