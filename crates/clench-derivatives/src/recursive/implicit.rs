//! Implicit steps: the acceleration a′ that advances the velocity solves (M + h B) a′ = M a, with the slopes B of
//! damping.
//!
//! So e = a − a′ solves (M + h B) e = h B a, and (M + h B) de = h B da + h dB a′ − dM e. A free body that is its own
//! tree adds to B the slope G of its gyroscopic forces (`gyroscopic`).

use super::coordinate::Coordinate;
use super::gyroscopic::Gyroscopic;
use super::step::Step;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::inverse_derivatives::{Accelerated, InverseDerivatives};
use clench_dynamics::model::{Integrator, Model};

/// The slopes of damping, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Implicit {
    /// The diagonal of B (nv).
    slopes: Vec<f64>,
    /// The other entries: the row, the column and the slope.
    couplings: Vec<(usize, usize, f64)>,
    /// The derivatives of B a′: the row, the column of a coordinate, and the derivative.
    rates: Vec<(usize, usize, f64)>,
    /// The right side of the equation, then the difference of the acceleration.
    right: Vec<f64>,
}

/// Returns true if a step solves for another acceleration to advance the velocity.
pub(super) fn is_implicit(step: &Step<'_>) -> bool {
    match step.model.integrator {
        Integrator::Euler => step.plain.integration.damped.0,
        Integrator::ImplicitFast | Integrator::Implicit | Integrator::Discrete => true,
        Integrator::Rk4 => false,
    }
}

impl Implicit {
    /// Removes all slopes.
    pub(super) fn clear(&mut self, nv: usize) {
        self.slopes.clear();
        self.slopes.resize(nv, 0.0);
        self.couplings.clear();
        self.rates.clear();
    }

    /// Adds a slope of the damping of a dof.
    pub(super) fn add(&mut self, dof: usize, slope: f64) {
        self.slopes[dof] += slope;
    }

    /// Adds the derivative of a slope of a dof by a coordinate.
    pub(super) fn add_rate(&mut self, step: &Step<'_>, dof: usize, (column, rate): (usize, f64)) {
        if rate != 0.0 {
            let rate = rate * step.plain.integration.qacc[dof];
            self.rates.push((dof, column, rate));
        }
    }

    /// Adds the slope of a damping along a coordinate, in the pattern of M.
    pub(super) fn add_along(&mut self, step: &Step<'_>, along: Coordinate<'_>, slope: f64) {
        if slope == 0.0 {
            return;
        }
        for (row, (i, arm)) in along.iter().enumerate() {
            for (column, (j, other)) in along.iter().enumerate() {
                if !is_coupled(step.model, i, j) {
                    continue;
                }
                match i == j {
                    true => self.slopes[i] += slope * arm * arm,
                    false => self.couplings.push((i, j, slope * arm * other)),
                }
                let (Some(turned), Some(others)) = (along.rates_of(row), along.rates_of(column))
                else {
                    continue;
                };
                let qacc = step.plain.integration.qacc[j];
                for (&k, (turned, others)) in along.dofs.iter().zip(turned.iter().zip(others)) {
                    let rate = slope * (turned * other + arm * others) * qacc;
                    self.rates.push((i, k as usize, rate));
                }
            }
        }
    }

    /// Adds the derivative of such a slope by a coordinate.
    pub(super) fn add_rate_along(
        &mut self,
        step: &Step<'_>,
        along: Coordinate<'_>,
        (column, rate): (usize, f64),
    ) {
        if rate == 0.0 {
            return;
        }
        for (i, arm) in along.iter() {
            let coupled = along.iter().filter(|&(j, _)| is_coupled(step.model, i, j));
            let moved = coupled.map(|(j, other)| other * step.plain.integration.qacc[j]);
            self.rates
                .push((i, column, rate * arm * moved.sum::<f64>()));
        }
    }

    /// Adds the derivative of such a slope by the length of the coordinate.
    pub(super) fn add_length_rate(&mut self, step: &Step<'_>, along: Coordinate<'_>, rate: f64) {
        if rate != 0.0 {
            for (dof, by) in along.lengths() {
                self.add_rate_along(step, along, (dof, rate * by));
            }
        }
    }

    /// Adds the derivative of such a slope by the velocity of the coordinate.
    pub(super) fn add_velocity_rate(&mut self, step: &Step<'_>, along: Coordinate<'_>, rate: f64) {
        if rate == 0.0 {
            return;
        }
        let (nv, qvel) = (step.model.nv, &step.before.qvel);
        for (dof, arm) in along.iter() {
            self.add_rate_along(step, along, (nv + dof, rate * arm));
        }
        for (dof, change) in along.velocity_changes(qvel) {
            self.add_rate_along(step, along, (dof, rate * change));
        }
    }

    /// Adds h dB a′ + dM (a′ − a).
    fn add_right(
        &self,
        step: &Step<'_>,
        inverse: &mut InverseDerivatives<f64>,
        right: &mut ForceDerivatives<'_, f64>,
    ) {
        let (model, plain) = (step.model, step.plain);
        let h = step.params.timestep;
        let change = plain.qacc.iter().zip(&plain.integration.qacc);
        let change = Vec::from_iter(change.map(|(a, implicit)| implicit - a));
        let resting = Accelerated {
            qacc: &change,
            moving: None,
        };
        inverse.add(model, step.params, &plain.position, resting, right);
        for &(dof, column, rate) in &self.rates {
            right.add(dof, column, h * rate);
        }
    }

    /// Replaces the derivatives of a in `columns` by those of a′.
    pub(super) fn replace(
        &mut self,
        step: &Step<'_>,
        inverse: &mut InverseDerivatives<f64>,
        columns: &mut [f64],
        width: usize,
    ) {
        let (model, plain) = (step.model, step.plain);
        let mut right = std::mem::take(&mut self.right);
        right.clear();
        right.resize(model.nv * width, 0.0);
        let mut matrix = ForceDerivatives::Matrix {
            values: &mut right,
            width,
        };
        self.add_right(step, inverse, &mut matrix);
        self.right = right;
        let h = step.params.timestep;
        let rows = |i: usize| i * width..(i + 1) * width;
        let mut add_row = |to: usize, from: usize, scale: f64| {
            let row = self.right[rows(to)].iter_mut().zip(&columns[rows(from)]);
            row.for_each(|(x, &y)| *x += scale * y);
        };
        for (i, slope) in self.slopes.iter().enumerate() {
            add_row(i, i, h * slope);
        }
        for &(i, j, slope) in &self.couplings {
            add_row(i, j, h * slope);
        }
        let free = Gyroscopic::of_all(step);
        for body in &free {
            body.add_rates(columns, &mut self.right, width);
        }
        let solved = Vec::from_iter(free.iter().map(|body| body.solve(&self.right, width)));
        (plain.integration.factor).solve_columns(&model.tree, &mut self.right, width);
        for (body, rows) in free.iter().zip(&solved) {
            self.right[body.rows(width)].copy_from_slice(rows);
        }
        columns
            .iter_mut()
            .zip(&self.right)
            .for_each(|(x, &y)| *x -= y);
    }

    /// Replaces the gradient by a′ of a function by that by a, and adds the rest to `row`, for a model without
    /// gyroscopic slopes.
    pub(super) fn pull_back(
        &self,
        step: &Step<'_>,
        inverse: &mut InverseDerivatives<f64>,
        gradient: &mut [f64],
        row: &mut [f64],
    ) {
        let h = step.params.timestep;
        let mut factors = gradient.to_vec();
        (step.plain.integration.factor).solve(&step.model.tree, &mut factors);
        factors.iter_mut().for_each(|x| *x = -*x);
        for ((x, &slope), &y) in gradient.iter_mut().zip(&self.slopes).zip(&factors) {
            *x += h * slope * y;
        }
        for &(i, j, slope) in &self.couplings {
            gradient[j] += h * slope * factors[i];
        }
        let mut product = ForceDerivatives::Product {
            factors: &factors,
            row,
        };
        self.add_right(step, inverse, &mut product);
    }
}

/// Returns true if the mass matrix couples two dofs.
fn is_coupled(model: &Model, i: usize, j: usize) -> bool {
    let (above, below) = (i.min(j), i.max(j));
    model.tree.row(below).binary_search(&(above as u32)).is_ok()
}
