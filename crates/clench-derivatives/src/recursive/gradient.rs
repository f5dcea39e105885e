//! The gradient of the convex problem at a constant acceleration: its derivatives by state and controls.

use super::blocks::Blocks;
use super::local::Local;
use super::step::Step;
use super::weight::Weight;
use crate::matrix::subtract_products;
use clench_dynamics::dynamics::inverse_derivatives::{Accelerated, Columns, InverseDerivatives};
use clench_dynamics::model::Model;
use clench_solver::Response;

/// The derivatives of the gradient, and the Hessian that turns them into those of the acceleration.
pub(super) struct Gradient {
    pub inverse: InverseDerivatives<f64>,
    pub local: Local,
    weight: Weight,
    blocks: Blocks,
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

    /// Computes the derivatives, and factors the Hessian. Returns false if recursions do not cover the contacts.
    pub(super) fn find(&mut self, step: &Step<'_>) -> bool {
        let (model, params, plain) = (step.model, step.params, step.plain);
        if !(self.response).factor(&plain.problem, &step.settings.solver, &plain.qacc) {
            return false;
        }
        self.columns.clear();
        self.columns.resize(model.nv * self.width, 0.0);
        let mut gradient = Columns {
            values: &mut self.columns,
            width: self.width,
        };
        let moving = Accelerated {
            qacc: &plain.qacc,
            moving: Some((&plain.velocity, &step.before.qvel)),
        };
        (self.inverse).add(model, params, &plain.position, moving, &mut gradient);
        let solution = (&self.response, &self.inverse);
        if !(self.blocks).run(step, solution, &mut gradient) {
            return false;
        }
        self.local.run(step, &mut gradient);
        self.weight.subtract(step, &mut gradient);
        true
    }

    /// Subtracts from `row` the part of a gradient `by_acceleration`, which is overwritten.
    pub(super) fn pull_back(&mut self, by_acceleration: &mut [f64], row: &mut [f64]) {
        self.response.solve_columns(by_acceleration, 1);
        subtract_products(by_acceleration, &self.columns, row);
    }

    /// Replaces derivatives of the gradient, columns of `width` numbers a row, by those of the acceleration.
    pub(super) fn solve(&mut self, columns: &mut [f64]) {
        self.response.solve_columns(columns, self.width);
        columns.iter_mut().for_each(|x| *x = -*x);
    }
}
