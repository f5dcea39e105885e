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
mod gyroscopic;
mod implicit;
mod local;
mod pair;
mod rows;
mod scope;
mod slopes;
mod step;
mod tendons;
mod weight;

use crate::source::Source;
use advance::Advance;
use blocks::Blocks;
use clench_dynamics::dynamics::inverse_derivatives::{Accelerated, Columns, InverseDerivatives};
use clench_dynamics::model::{Model, Params};
use clench_dynamics::{State, Workspace, check};
use clench_rigid::SimError;
use clench_solver::Response;
use curves::Curves;
use implicit::is_implicit;
use local::Local;
use step::Step;
use weight::Weight;

/// The memory of derivatives by recursion.
pub(crate) struct Recursive {
    /// The state after the step.
    pub(crate) state: State<f64>,
    pub(crate) plain: Workspace<f64>,
    inverse: InverseDerivatives<f64>,
    local: Local,
    weight: Weight,
    blocks: Blocks,
    advance: Advance,
    pub(crate) curves: Curves,
    response: Response<f64>,
    /// The gradient, then the acceleration, then the new velocity: nv rows.
    columns: Vec<f64>,
    /// The derivatives of the acceleration, likewise; only with sensors.
    acceleration: Vec<f64>,
}

impl Recursive {
    pub(crate) fn new(model: &Model) -> Self {
        let compiled = clench_dynamics::Step::<f64>::compiled();
        Recursive {
            state: State::new(model),
            plain: (compiled.workspace)(model),
            inverse: InverseDerivatives::new(model),
            local: Local::new(model),
            weight: Weight::default(),
            blocks: Blocks::default(),
            advance: Advance::default(),
            curves: Curves::new(model),
            response: Response::default(),
            columns: Vec::new(),
            acceleration: Vec::new(),
        }
    }

    /// Returns the derivatives of the acceleration of a dof by state and controls, before the step makes it implicit.
    pub(crate) fn acceleration(&self, dof: usize) -> &[f64] {
        let width = self.acceleration.len() / self.plain.qacc.len();
        &self.acceleration[dof * width..][..width]
    }

    pub(crate) fn set_params(&mut self, params: &Params<f64>) {
        self.plain.invalidate_poses();
        self.local.set_params(params);
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
        let (model, params, settings) = (source.model, source.params, source.settings);
        self.state.copy_from(source.state);
        let step = clench_dynamics::Step::<f64>::compiled().step;
        let (state, plain) = (&mut self.state, &mut self.plain);
        step(model, params, settings, state, plain, |_, _, _, _, _| {});
        if check::good_results(state, plain) {
            return Ok(());
        }
        let fault = check::result_fault(model, source.state.time, state, plain, 0);
        Err(fault.into())
    }

    /// Passes the derivatives of the next state by state and controls to `write`, row after row. The [curves](Curves)
    /// must be those of the state, and recursions must [cover](Self::covers) the step. Returns false if they do not
    /// cover its contacts.
    pub(crate) fn run(
        &mut self,
        source: Source<'_>,
        write: &mut dyn FnMut(&[f64]),
    ) -> Result<bool, SimError> {
        self.step(source)?;
        let (model, settings) = (source.model, source.settings);
        let step = Step {
            model,
            params: source.params,
            settings,
            before: source.state,
            after: &self.state,
            plain: &self.plain,
            curves: &self.curves,
        };
        let columns = 2 * model.nv + model.na + model.nu();
        // Rows fill whole registers.
        let width = columns.max(1).next_multiple_of(16);
        self.columns.clear();
        self.columns.resize(model.nv * width, 0.0);
        let mut gradient = Columns {
            values: &mut self.columns,
            width,
        };
        if !(self.response).factor(&step.plain.problem, &settings.solver, &step.plain.qacc) {
            return Ok(false);
        }
        let moving = Accelerated {
            qacc: &step.plain.qacc,
            moving: Some((&step.plain.velocity, &source.state.qvel)),
        };
        let pos = &step.plain.position;
        self.inverse
            .add(model, source.params, pos, moving, &mut gradient);
        let solution = (&self.response, &self.inverse);
        if !(self.blocks).run(&step, solution, &mut gradient) {
            return Ok(false);
        }
        self.local.run(&step, &mut gradient);
        self.weight.subtract(&step, &mut gradient);
        self.response.solve_columns(&mut self.columns, width);
        self.columns.iter_mut().for_each(|x| *x = -*x);
        self.acceleration.clear();
        if source.request.sensors_len(model) > 0 {
            self.acceleration.extend_from_slice(&self.columns);
        }
        if is_implicit(&step) {
            let implicit = &mut self.local.implicit;
            implicit.replace(&step, &mut self.inverse, &mut self.columns, width);
        }
        self.advance.run(&step);
        let h = source.params.timestep;
        for (i, row) in self.columns.chunks_exact_mut(width).enumerate() {
            row.iter_mut().for_each(|x| *x *= h);
            row[model.nv + i] += 1.0;
        }
        let velocity = self.columns.chunks_exact(width).map(|row| &row[..columns]);
        self.advance.write_positions(model, velocity.clone(), write);
        velocity.for_each(&mut *write);
        self.local.write_activations(model, columns, write);
        Ok(true)
    }
}
