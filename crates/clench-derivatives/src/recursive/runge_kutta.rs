//! Runge–Kutta: the derivatives of a step by the chain rule over its stages.
//!
//! A stage starts at the positions q₀ exp(c r), the velocities v₀ + c a and the activations α₀ + c ρ, which the rates
//! r, a and ρ of the stage before reach in the time c. Each stage has its own gradient g of the convex problem and its
//! own Hessian,
//!
//! ```text
//! da = −H⁻¹ (∂g/∂q dq + ∂g/∂v dv + ∂g/∂α dα + ∂g/∂u du),
//! ```
//!
//! in which dq, dv, dα and du are by the state at the start of the step and by the controls.

use super::advance::{Advance, rotation};
use super::gradient::Gradient;
use super::row_forces::add_row;
use super::step::Step;
use clench_dynamics::dynamics::integration::Integration;
use clench_dynamics::dynamics::rk4::{WEIGHTS, increment_rate};
use clench_dynamics::model::Model;
use clench_math::{Dual, Real, Vec3};
use std::mem::swap;

/// A number with its derivatives by the increment of an orientation and by the angular velocity.
type Number = Dual<f64, 6>;

/// The derivatives of the current stage by the state at the start of the step and by the controls: matrices with a row
/// for each position, velocity and activation.
#[derive(Debug, Default)]
pub(super) struct RungeKutta {
    width: usize,
    /// The number of stages before.
    stage: usize,
    /// The time after the start of the step, s.
    time: f64,
    /// The rates that reached this stage, times this time (nv).
    increment: Vec<f64>,
    advance: Advance,
    /// The derivatives of the state of the stage.
    state: Vec<f64>,
    /// The derivatives of its rates. Until they are computed, those of the stage before.
    rates: Vec<f64>,
    /// The derivatives of the weighted mean of the rates.
    mean: Vec<f64>,
}

impl RungeKutta {
    /// Starts a step.
    pub(super) fn begin(&mut self, model: &Model, width: usize) {
        (self.width, self.stage, self.time) = (width, 0, 0.0);
        self.increment.clear();
        self.increment.resize(model.nv, 0.0);
        let rows = 2 * model.nv + model.na;
        for matrix in [&mut self.state, &mut self.rates, &mut self.mean] {
            matrix.clear();
            matrix.resize(rows * width, 0.0);
        }
        add_identity(&mut self.state, width, 0);
    }

    /// Returns the derivatives of the accelerations.
    pub(super) fn accelerations(&self, nv: usize) -> &[f64] {
        &self.rates[nv * self.width..][..nv * self.width]
    }

    /// Begins the next stage. The last rates reach it in a time, s, from the positions `start` and the other numbers of
    /// the state at the start of the step.
    pub(super) fn reach(&mut self, model: &Model, start: &[f64], rates: &[f64], time: f64) {
        self.time = time;
        self.increment.clear();
        self.increment.extend(rates.iter().map(|rate| time * rate));
        self.state.clear();
        self.write_positions(model, (start, rates), time);
        let others = &self.rates[model.nv * self.width..];
        self.state.extend(others.iter().map(|rate| time * rate));
        add_identity(
            &mut self.state[model.nv * self.width..],
            self.width,
            model.nv,
        );
    }

    /// Adds the present stage, as a step from its state. Returns false if recursions do not cover its contacts.
    pub(super) fn add_stage(&mut self, step: &Step<'_>, gradient: &mut Gradient) -> bool {
        if !gradient.find(step) {
            return false;
        }
        let (model, rows) = (step.model, 2 * step.model.nv + step.model.na);
        self.find_position_rates(model, &step.before.qvel);
        let (positions, others) = self.rates.split_at_mut(model.nv * self.width);
        let (accelerations, activations) = others.split_at_mut(positions.len());
        let width = self.width;
        let state = self.state.chunks_exact(width);
        f64::vectorize_rows(|| {
            let sums = accelerations.chunks_exact_mut(width);
            for (sum, slopes) in sums.zip(gradient.columns.chunks_exact(width)) {
                sum[..rows].fill(0.0);
                sum[rows..].copy_from_slice(&slopes[rows..]);
                for (&slope, row) in slopes.iter().zip(state.clone()) {
                    add_row(sum, slope, row);
                }
            }
        });
        gradient.solve(accelerations);
        activations.fill(0.0);
        for &(a, column, rate) in &gradient.local.activations {
            let sum = &mut activations[a * width..][..width];
            match column < rows {
                true => add_row(sum, rate, &self.state[column * width..][..width]),
                false => sum[column] += rate,
            }
        }
        add_row(&mut self.mean, WEIGHTS[self.stage], &self.rates);
        self.stage += 1;
        true
    }

    /// Computes the derivatives of the rates of positions from the velocities `qvel`, and from the increments that
    /// reached the stage.
    fn find_position_rates(&mut self, model: &Model, qvel: &[f64]) {
        let velocity = &self.state[model.nv * self.width..];
        for joint in &model.joints {
            let rotation = rotation(joint);
            let translation = joint.dof * self.width..rotation.start * self.width;
            self.rates[translation.clone()].copy_from_slice(&velocity[translation]);
            if rotation.is_empty() {
                continue;
            }
            let seeded = |values: &[f64], first: usize| {
                let mut numbers = [Number::ZERO; 3];
                for (k, number) in numbers.iter_mut().enumerate() {
                    *number = Number::new(values[rotation.start + k]);
                    number.set_derivative(first + k, 1.0);
                }
                Vec3::from_slice(&numbers)
            };
            let rate = increment_rate(seeded(&self.increment, 0), seeded(qvel, 3)).to_array();
            for column in 0..self.width {
                let at = |k: usize| (rotation.start + k) * self.width + column;
                let increment = [0, 1, 2].map(|k| self.time * self.rates[at(k)]);
                let omega = [0, 1, 2].map(|k| velocity[at(k)]);
                for (axis, rate) in rate.iter().enumerate() {
                    let sum = |k: usize| {
                        rate.derivative(k) * increment[k] + rate.derivative(3 + k) * omega[k]
                    };
                    self.rates[at(axis)] = sum(0) + sum(1) + sum(2);
                }
            }
        }
    }

    /// Appends to the state the derivatives of the positions that `rates` reach in a time, from `start`.
    fn write_positions(&mut self, model: &Model, (start, rates): (&[f64], &[f64]), time: f64) {
        self.advance.run(model, start, rates, time);
        let write = &mut |row: &[f64]| self.state.extend_from_slice(row);
        let rates = self.rates.chunks_exact(self.width);
        self.advance.write_positions(model, rates, write);
    }

    /// Passes the derivatives of the next state, which the mean rates reach in a time `h`, to `write`. `slopes` holds
    /// those of each new activation by itself before the step and by its mean rate.
    pub(super) fn write(
        &mut self,
        model: &Model,
        (from, slopes): (&Integration<f64>, &[[f64; 2]]),
        h: f64,
        write: &mut dyn FnMut(&[f64]),
    ) {
        let (width, nv) = (self.width, model.nv);
        swap(&mut self.rates, &mut self.mean);
        let motion = (&from.start.position[..], &from.mean.position[..]);
        self.state.clear();
        self.write_positions(model, motion, h);
        for (i, row) in self.rates.chunks_exact(width).enumerate().skip(nv) {
            let [by_state, by_rate] = match i.checked_sub(2 * nv) {
                None => [1.0, h],
                Some(a) => slopes[a],
            };
            let start = self.state.len();
            self.state.extend(row.iter().map(|rate| by_rate * rate));
            self.state[start + i] += by_state;
        }
        let len = 2 * nv + model.na + model.nu();
        let rows = self.state.chunks_exact(width);
        rows.for_each(|row| write(&row[..len]));
    }
}

/// Adds the identity to a matrix, from a column on.
fn add_identity(matrix: &mut [f64], width: usize, column: usize) {
    for (i, row) in matrix.chunks_exact_mut(width).enumerate() {
        row[column + i] += 1.0;
    }
}
