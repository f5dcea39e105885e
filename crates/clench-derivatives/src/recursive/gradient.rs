//! The gradient of the convex problem at a constant acceleration: its derivatives by state and controls.

use super::blocks::Blocks;
use super::local::Local;
use super::step::Step;
use super::weight::Weight;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::inverse_derivatives::{Accelerated, InverseDerivatives};
use clench_dynamics::model::Model;
use clench_solver::Response;

/// The derivatives of the gradient, and the Hessian that turns them into those of the acceleration.
pub(super) struct Gradient {
    pub inverse: InverseDerivatives<f64>,
    pub local: Local,
    weight: Weight,
    pub blocks: Blocks,
    response: Response<f64>,
    /// The derivatives: nv rows of `width` numbers, by positions, velocities, activations and controls, then zeros.
    pub columns: Vec<f64>,
    pub width: usize,
}

impl Gradient {
    pub(super) fn new(model: &Model) -> Self {
        let columns = 2 * model.nv + model.na + model.nu();
        Gradient {
            inverse: InverseDerivatives::new(model),
            local: Local::new(model),
            weight: Weight::default(),
            blocks: Blocks::default(),
            response: Response::default(),
            columns: Vec::new(),
            // Rows fill whole registers.
            width: columns.max(1).next_multiple_of(16),
        }
    }

    /// Selects whether the derivatives of constraint forces are wanted.
    pub(super) fn select_forces(&mut self, wanted: bool) {
        self.blocks
            .forces
            .set_width(if wanted { self.width } else { 0 });
    }

    /// Computes the derivatives, and factors the Hessian. Returns false if recursions do not cover the contacts.
    pub(super) fn find(&mut self, step: &Step<'_>) -> bool {
        let mut columns = std::mem::take(&mut self.columns);
        columns.clear();
        columns.resize(step.model.nv * self.width, 0.0);
        let mut matrix = ForceDerivatives::Matrix {
            values: &mut columns,
            width: self.width,
        };
        let covered = self.prepare(step) && self.add(step, &mut matrix);
        self.columns = columns;
        covered
    }

    /// Factors the Hessian, and computes the derivatives of the forces of joints, tendons and actuators. Returns false
    /// if the Hessian is larger than the settings allow.
    pub(super) fn prepare(&mut self, step: &Step<'_>) -> bool {
        let (problem, settings) = (&step.plain.problem, &step.settings.solver);
        if !(self.response).factor(problem, settings, &step.plain.qacc) {
            return false;
        }
        self.local.run(step);
        true
    }

    /// Adds the derivatives. Returns false if recursions do not cover the contacts.
    fn add(&mut self, step: &Step<'_>, gradient: &mut ForceDerivatives<'_, f64>) -> bool {
        let (model, params, plain) = (step.model, step.params, step.plain);
        let moving = Accelerated {
            qacc: &plain.qacc,
            moving: Some((&plain.velocity, &step.before.qvel)),
        };
        (self.inverse).add(model, params, &plain.position, moving, gradient);
        let solution = (&self.response, &self.inverse);
        if !(self.blocks).run(step, solution, gradient) {
            return false;
        }
        self.local.subtract(gradient);
        self.weight.subtract(step, gradient);
        true
    }

    /// Adds to `row` the part of a gradient `by_acceleration`, which is overwritten. Returns false if recursions do not
    /// cover the contacts. The Hessian must be [prepared](Self::prepare).
    pub(super) fn pull_back(
        &mut self,
        step: &Step<'_>,
        by_acceleration: &mut [f64],
        row: &mut [f64],
    ) -> bool {
        self.response.solve_columns(by_acceleration, 1);
        by_acceleration.iter_mut().for_each(|x| *x = -*x);
        let mut product = ForceDerivatives::Product {
            factors: by_acceleration,
            row,
        };
        self.add(step, &mut product)
    }

    /// Replaces derivatives of the gradient, columns of `width` numbers a row, by those of the acceleration.
    pub(super) fn solve(&mut self, columns: &mut [f64]) {
        self.response.solve_columns(columns, self.width);
        columns.iter_mut().for_each(|x| *x = -*x);
    }
}
