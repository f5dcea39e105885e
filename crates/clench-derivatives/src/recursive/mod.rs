//! The derivatives of a step by recursions over the tree, for models whose forces permit it.
//!
//! A step in plain numbers finds the acceleration a. The gradient of the convex problem at this constant acceleration,
//!
//! ```text
//! g = M a + bias − τ − Jᵀf
//! ```
//!
//! has derivatives without matrices in dual numbers: those of inverse dynamics M a + bias follow from a recursion
//! (`clench_dynamics::dynamics::inverse_derivatives`), those of τ from dual numbers of the coordinates of each joint
//! alone (`local`) and from the motion of weights (`weight`), those of Jᵀf from the motion of each constraint
//! (`blocks`). Then da = −H⁻¹ dg, for all directions at once.

mod advance;
mod blocks;
mod contact;
mod coordinate;
mod curves;
mod frames;
mod gradient;
mod gyroscopic;
mod implicit;
mod local;
mod pair;
mod pull_back;
mod row_forces;
mod rows;
mod runge_kutta;
mod scope;
mod slopes;
mod step;
mod tendons;
mod weight;

use crate::source::Source;
use advance::Advance;
use clench_dynamics::dynamics::rk4::rk4;
use clench_dynamics::model::{Integrator, Model, Params};
use clench_dynamics::{State, Workspace, check};
use clench_rigid::SimError;
pub(crate) use curves::Curves;
use gradient::Gradient;
use implicit::is_implicit;
use row_forces::RowForces;
use runge_kutta::RungeKutta;
use step::Step;

/// The memory of derivatives by recursion.
pub(crate) struct Recursive {
    /// The state after the step.
    pub(crate) state: State<f64>,
    pub(crate) plain: Workspace<f64>,
    gradient: Gradient,
    advance: Advance,
    runge_kutta: RungeKutta,
    curves: Curves,
    /// The acceleration at the start of the step (nv), and its derivatives by state and controls, nv rows; only if y
    /// is not empty.
    pub(crate) qacc: Vec<f64>,
    acceleration: Vec<f64>,
}

/// Computes the [curves](Curves) of a state.
pub(crate) type FindCurves<'a> = dyn FnMut(&State<f64>, &mut Curves) + 'a;

impl Recursive {
    pub(crate) fn new(model: &Model) -> Self {
        let compiled = clench_dynamics::Step::<f64>::compiled();
        Recursive {
            state: State::new(model),
            plain: (compiled.workspace)(model),
            gradient: Gradient::new(model),
            advance: Advance::default(),
            runge_kutta: RungeKutta::default(),
            curves: Curves::new(model),
            qacc: Vec::new(),
            acceleration: Vec::new(),
        }
    }

    /// Returns the derivatives of the acceleration of a dof by state and controls, at the start of the step.
    pub(crate) fn acceleration(&self, dof: usize) -> &[f64] {
        &self.acceleration[dof * self.gradient.width..][..self.gradient.width]
    }

    /// Returns the derivatives of the forces of constraints at the start of the step, if y reads them.
    pub(crate) fn row_forces(&self) -> &RowForces {
        &self.gradient.blocks.forces
    }

    pub(crate) fn set_params(&mut self, params: &Params<f64>) {
        self.plain.invalidate_poses();
        self.gradient.local.set_params(params);
    }

    /// Returns true if the step is of a kind that recursions cover, as far as its contacts are too.
    pub(crate) fn covers(source: Source<'_>) -> bool {
        scope::covers(source.model, source.params, source.settings)
    }

    /// Makes the step in plain numbers, without its sensors, on which no motion depends.
    ///
    /// # Errors
    /// Returns an error if the step fails.
    pub(crate) fn step(&mut self, source: Source<'_>) -> Result<(), SimError> {
        self.state.copy_from(source.state);
        let step = clench_dynamics::Step::<f64>::compiled().step;
        let (state, plain) = (&mut self.state, &mut self.plain);
        step(source.without_sensors(), state, plain);
        self.check(source)
    }

    /// Returns an error if the step failed.
    fn check(&self, source: Source<'_>) -> Result<(), SimError> {
        if check::good_results(&self.state, &self.plain) {
            return Ok(());
        }
        let (state, plain) = (&self.state, &self.plain);
        let fault = check::result_fault(source.model, source.state.time, state, plain, 0);
        Err(fault.into())
    }

    /// Passes the derivatives of the next state by state and controls to `write`, row after row. Recursions must
    /// [cover](Self::covers) the step. Returns false if they do not cover its contacts.
    ///
    /// # Errors
    /// Returns an error if the step fails.
    pub(crate) fn run(
        &mut self,
        source: Source<'_>,
        find_curves: &mut FindCurves<'_>,
        write: &mut dyn FnMut(&[f64]),
    ) -> Result<bool, SimError> {
        match source.model.integrator {
            Integrator::Rk4 => self.run_stages(source, find_curves, write),
            Integrator::Euler
            | Integrator::ImplicitFast
            | Integrator::Implicit
            | Integrator::Discrete => self.run_stage(source, find_curves, write),
        }
    }

    /// Differentiates a step of one stage.
    fn run_stage(
        &mut self,
        source: Source<'_>,
        find_curves: &mut FindCurves<'_>,
        write: &mut dyn FnMut(&[f64]),
    ) -> Result<bool, SimError> {
        self.step(source)?;
        find_curves(source.state, &mut self.curves);
        let model = source.model;
        let step = Step::new(source, source.state, &self.plain, &self.curves);
        let reads = source.request.reads(model);
        self.gradient
            .select_forces(reads.is_some_and(|reads| reads.forces));
        if !self.gradient.find(&step) {
            return Ok(false);
        }
        // The derivatives of the acceleration, then of the new velocity.
        let mut columns = std::mem::take(&mut self.gradient.columns);
        self.gradient.solve(&mut columns);
        let width = self.gradient.width;
        if source.request.y_len(model) > 0 {
            self.qacc.clone_from(&step.plain.qacc);
            self.acceleration.clone_from(&columns);
            (self.gradient.blocks.forces).complete(&step.plain.problem, &columns);
        }
        if is_implicit(&step) {
            let Gradient { inverse, local, .. } = &mut self.gradient;
            local.implicit.replace(&step, inverse, &mut columns, width);
        }
        let h = source.params.timestep;
        for (i, row) in columns.chunks_exact_mut(width).enumerate() {
            row.iter_mut().for_each(|x| *x *= h);
            row[model.nv + i] += 1.0;
        }
        let len = 2 * model.nv + model.na + model.nu();
        let velocity = columns.chunks_exact(width).map(|row| &row[..len]);
        (self.advance).run(model, &source.state.qpos, &self.state.qvel, h);
        self.advance.write_positions(model, velocity.clone(), write);
        velocity.for_each(&mut *write);
        (self.gradient.local).write_activations(model, len, write);
        self.gradient.columns = columns;
        Ok(true)
    }

    /// Differentiates a step of several stages, as [`run`](Self::run).
    fn run_stages(
        &mut self,
        source: Source<'_>,
        find_curves: &mut FindCurves<'_>,
        write: &mut dyn FnMut(&[f64]),
    ) -> Result<bool, SimError> {
        let (model, params, context) = (source.model, source.params, source.without_sensors());
        let forward = clench_dynamics::Step::<f64>::compiled().forward;
        let Recursive {
            state,
            plain,
            gradient,
            runge_kutta,
            curves,
            qacc,
            acceleration,
            ..
        } = self;
        runge_kutta.begin(model, gradient.width);
        let mut add_stage = |runge_kutta: &mut RungeKutta, state: &_, plain: &_| {
            find_curves(state, curves);
            let step = Step::new(source, state, plain, curves);
            runge_kutta.add_stage(&step, gradient)
        };
        state.copy_from(source.state);
        forward(context, state, plain);
        let mut covered = add_stage(runge_kutta, state, plain);
        if !covered {
            return Ok(false);
        }
        if source.request.y_len(model) > 0 {
            qacc.clone_from(&plain.qacc);
            acceleration.clear();
            acceleration.extend_from_slice(runge_kutta.accelerations(model.nv));
        }
        rk4(model, params, state, plain, |state, plain| {
            let from = &plain.integration;
            let (start, rates) = (&from.start.position, &from.stage.position);
            runge_kutta.reach(model, start, rates, from.offset);
            forward(context, state, plain);
            covered = covered && add_stage(runge_kutta, state, plain);
        });
        state.qacc_warmstart.copy_from_slice(&plain.qacc);
        self.check(source)?;
        if covered {
            let slopes = (self.gradient.local).advance_slopes(model, source.state, &self.plain);
            let integration = (&self.plain.integration, &slopes[..]);
            (self.runge_kutta).write(model, integration, params.timestep, write);
        }
        Ok(covered)
    }
}
