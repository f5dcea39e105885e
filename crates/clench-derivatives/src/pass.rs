//! A step in dual numbers: the derivatives along a few directions.

use crate::matrix::{InputGradient, Matrix};
use crate::reads::Reads;
use crate::recursive::{Curves, Recursive};
use crate::request::Request;
use crate::seed::{self, Seed};
use crate::source::Source;
use crate::stage::Stage;
use crate::tangent;
use clench_dynamics::model::{Integrator, Model, Params};
use clench_dynamics::{State, Workspace, check, pipeline};
use clench_math::{Dual, LaneTask, Real};
use clench_rigid::{OutputSource, SimError};
use clench_solver::{ErrorBound, ErrorBounds};

/// The number of registers of derivatives in a dual number. With one or four, a humanoid takes 20% longer.
const REGISTERS: usize = 2;

/// A step in dual numbers of a type that is known only at run time.
pub(crate) trait Pass: Send {
    /// Returns the maximum number of directions of a pass.
    fn directions(&self) -> usize;
    /// Writes the distances of constraints from a switch to another piece of their costs, in the last pass.
    fn switching(&self, out: &mut Vec<f64>);
    /// Adds bounds of the errors that the solver leaves in the last pass, along `count` directions.
    fn bound_errors(&mut self, source: Source<'_>, count: usize, bound: &mut ErrorBound);
    /// Prepares for passes with these parameters.
    fn set_params(&mut self, params: &Params<f64>);
    /// Passes the derivatives of the next state by state and controls, found by recursions, to `write`, row after row.
    /// Returns false if the step needs passes.
    fn recurse(
        &mut self,
        source: Source<'_>,
        write: &mut dyn FnMut(&[f64]),
    ) -> Result<bool, SimError>;
    /// Computes the gradients by state and controls of functions of the next state, by recursions: see
    /// [`Recursive::pull_back`]. Returns false if the step needs its derivatives.
    fn pull_back(
        &mut self,
        source: Source<'_>,
        gradient: &Matrix,
        result: &mut InputGradient,
    ) -> Result<bool, SimError>;
    /// Computes the derivatives of sensors and outputs, after recursions: see [`DualPass::read_results`].
    fn read(
        &mut self,
        source: Source<'_>,
        reads: Reads,
        directions: (&[Seed], &[usize]),
        write: &mut dyn FnMut(usize, &[f64]),
    );
    /// Writes the state after the step that was differentiated last, without measurements of delayed sensors.
    ///
    /// # Errors
    /// Returns an error if the step fails.
    fn write_next(&mut self, source: Source<'_>, next: &mut State<f64>) -> Result<(), SimError>;
    /// Runs the step along the first `count` directions, which `seeds` define. `write(row, values)` receives the
    /// derivatives of each number of the result: the next state, the sensors, the outputs.
    fn run(
        &mut self,
        source: Source<'_>,
        count: usize,
        seeds: &[Seed],
        write: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<(), SimError>;
}

/// Creates the memory of passes, in lanes.
pub(crate) struct CreatePass<'a> {
    pub model: &'a Model,
}

impl LaneTask<f64> for CreatePass<'_> {
    type Output = Box<dyn Pass>;
    fn run<T: Real<Scalar = f64>>(self) -> Box<dyn Pass> {
        let ws = Workspace::new(self.model);
        let state = State::new(self.model);
        Box::new(DualPass::<T> {
            params: self.model.params.broadcast(),
            before: state.clone(),
            state,
            ws,
            outputs: Vec::new(),
            bounds: ErrorBounds::default(),
            last: Stage::Positions,
            recursive: Recursive::new(self.model),
            recursed: false,
        })
    }
}

type Number<L> = Dual<L, REGISTERS>;

pub(crate) struct DualPass<L: Real<Scalar = f64>> {
    pub params: Params<Number<L>>,
    pub before: State<Number<L>>,
    state: State<Number<L>>,
    pub ws: Workspace<Number<L>>,
    pub outputs: Vec<Number<L>>,
    bounds: ErrorBounds<Number<L>>,
    /// The start of the last pass.
    pub last: Stage,
    pub recursive: Recursive,
    /// True if the last derivatives were computed by recursions.
    recursed: bool,
}

impl<L: Real<Scalar = f64>> DualPass<L> {
    /// Removes the derivatives of the state.
    pub(crate) fn clear_state(&mut self, model: &Model, request: &Request) {
        let State {
            qpos,
            qvel,
            act,
            ctrl,
            ..
        } = &mut self.before;
        for number in [qpos, qvel, act, ctrl].into_iter().flatten() {
            *number = Real::new(number.value);
        }
        for field in request.memory_fields() {
            for i in 0..field.count(model) {
                let number = field.number(&mut self.before, i);
                *number = Real::new(number.value);
            }
        }
        for &(field, index) in &request.inputs {
            let number = field.number(&mut self.before, index);
            *number = Real::new(number.value);
        }
    }
}

impl<L: Real<Scalar = f64>> Pass for DualPass<L> {
    fn directions(&self) -> usize {
        Number::<L>::DIRECTIONS
    }

    fn switching(&self, out: &mut Vec<f64>) {
        if self.recursed {
            let plain = &self.recursive.plain;
            plain.problem.switching_distances(&plain.qacc, out);
        } else {
            self.ws.problem.switching_distances(&self.ws.qacc, out);
        }
    }

    fn bound_errors(&mut self, source: Source<'_>, count: usize, bound: &mut ErrorBound) {
        let (problem, qacc) = (&self.ws.problem, &self.ws.qacc);
        if source.first {
            let settings = &source.settings.solver;
            self.bounds.start(problem, settings, qacc, bound);
        }
        self.bounds.push_directions(problem, qacc, count, bound);
    }

    fn set_params(&mut self, params: &Params<f64>) {
        self.params = params.broadcast();
        self.recursive.set_params(params);
    }

    fn recurse(
        &mut self,
        source: Source<'_>,
        write: &mut dyn FnMut(&[f64]),
    ) -> Result<bool, SimError> {
        self.recursed = Recursive::covers(source);
        if self.recursed {
            let numbers = (source.model, &self.params);
            let mut find_curves = |state: &State<f64>, curves: &mut Curves| {
                curves.find(numbers, state, (&mut self.before, &mut self.ws.position));
            };
            self.recursed = self.recursive.run(source, &mut find_curves, write)?;
        }
        Ok(self.recursed)
    }

    fn pull_back(
        &mut self,
        source: Source<'_>,
        gradient: &Matrix,
        result: &mut InputGradient,
    ) -> Result<bool, SimError> {
        if !Recursive::covers(source) {
            return Ok(false);
        }
        let numbers = (source.model, &self.params);
        let mut find_curves = |state: &State<f64>, curves: &mut Curves| {
            curves.find(numbers, state, (&mut self.before, &mut self.ws.position));
        };
        (self.recursive).pull_back(source, &mut find_curves, gradient, result)
    }

    fn write_next(&mut self, source: Source<'_>, next: &mut State<f64>) -> Result<(), SimError> {
        if !self.recursed {
            self.recursive.step(source)?;
        }
        next.copy_from(&self.recursive.state);
        Ok(())
    }

    fn read(
        &mut self,
        source: Source<'_>,
        reads: Reads,
        directions: (&[Seed], &[usize]),
        write: &mut dyn FnMut(usize, &[f64]),
    ) {
        self.read_results(source, reads, directions, write);
    }

    fn run(
        &mut self,
        source: Source<'_>,
        count: usize,
        seeds: &[Seed],
        write: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<(), SimError> {
        let (model, request) = (source.model, source.request);
        self.recursed = false;
        if source.first {
            self.before.set_values(source.state);
        } else {
            self.clear_state(model, request);
        }
        seed::set(model, seeds, &mut self.before, &mut self.params);
        let DualPass {
            params,
            before,
            state,
            ws,
            outputs,
            last,
            ..
        } = self;
        if source.first {
            state.copy_from(before);
        } else {
            state.copy_moving_from(before);
            state.ctrl.clone_from(&before.ctrl);
            for &(field, index) in &request.inputs {
                *field.number(state, index) = *field.number(before, index);
            }
        }
        // Buffers of delayed sensors store measurements.
        ws.sensors.wanted = !request.omits_sensors || request.memory;
        ws.constant_factor = source.constant_factor;
        remove_reused_derivatives(ws, std::mem::replace(last, source.start), source);
        let step = match source.start {
            Stage::Positions => {
                ws.invalidate_poses();
                pipeline::step
            }
            Stage::Velocities => pipeline::step_from_velocities,
            Stage::Forces => pipeline::step_from_forces,
        };
        outputs.clear();
        let mut read_outputs = |ws: &mut Workspace<_>| {
            let mut from = OutputSource {
                model,
                params,
                state: before,
                ws,
            };
            for output in &request.outputs {
                output.read(&mut from, outputs);
            }
        };
        let context = source.context(params);
        // After a Runge-Kutta step, the workspace holds the results of its last stage.
        let stages = model.integrator == Integrator::Rk4;
        if stages && !request.outputs.is_empty() {
            pipeline::forward(context, before, ws);
            read_outputs(ws);
        }
        step(context, state, ws);
        let good = check::good_results(state, ws);
        if good {
            if !stages {
                read_outputs(ws);
            }
            let mut row = 0;
            let mut next = |values: &[f64]| {
                write(row, &values[..count]);
                row += 1;
            };
            tangent::each_motion(model, &state.qpos, &mut next);
            for number in state.qvel.iter().chain(&state.act) {
                next(L::as_scalars(&number.tangent));
            }
            for field in request.memory_fields() {
                for i in 0..field.count(model) {
                    next(L::as_scalars(&field.number(state, i).tangent));
                }
            }
            let sensors = &ws.sensors.data[..request.sensors_len(model)];
            for number in sensors.iter().chain(&*outputs) {
                next(L::as_scalars(&number.tangent));
            }
        }
        let fault =
            (!good).then(|| check::result_fault(model, source.state.time, state, ws, 0).into());
        seed::clear_params(model, seeds, params);
        fault.map_or(Ok(()), Err)
    }
}

/// Removes the derivatives of the stages that the pass reuses from the last one, which began with stage `last`.
pub(crate) fn remove_reused_derivatives<T: Real>(
    ws: &mut Workspace<T>,
    last: Stage,
    source: Source<'_>,
) {
    let reused = last..source.start;
    if reused.contains(&Stage::Positions) && source.constant_factor {
        ws.remove_position_derivatives();
    }
    if reused.contains(&Stage::Velocities) {
        ws.remove_velocity_derivatives();
    }
    // Displacements of friction that sticks are found with the constraints.
    ws.reuse_constraints =
        source.start == Stage::Forces && source.constant_factor && !source.settings.stiction;
    if ws.reuse_constraints && !reused.is_empty() {
        ws.remove_constraint_derivatives();
    }
}
