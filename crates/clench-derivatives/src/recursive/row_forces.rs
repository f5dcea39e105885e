//! The derivatives of the forces of constraint rows.
//!
//! The force f(y, r) of a block at a constant acceleration has derivatives by position and velocity. Then the
//! acceleration adds ∂f/∂y J da.

use clench_dynamics::constraint::at_distance::MAX_DIM;
use clench_math::Real;
use clench_solver::{Block, Problem};

/// The derivatives of the force of each row, in the columns of the derivatives of the acceleration.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowForces {
    /// The length of a row; zero if no derivatives are wanted.
    width: usize,
    values: Vec<f64>,
    /// The derivatives of each force by the residuals of its block.
    by_residual: Vec<[f64; MAX_DIM]>,
    /// J da of a row.
    rates: Vec<f64>,
}

impl RowForces {
    /// Selects the length of rows; zero if no derivatives are wanted.
    pub(super) fn set_width(&mut self, width: usize) {
        self.width = width;
    }

    /// Returns the derivatives of the force of a row.
    pub(crate) fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.width..][..self.width]
    }

    /// Starts with forces that do not change.
    pub(super) fn clear(&mut self, rows: usize) {
        self.values.clear();
        self.by_residual.clear();
        self.values.resize(rows * self.width, 0.0);
        self.by_residual.resize(rows, [0.0; MAX_DIM]);
    }

    /// Adds the derivatives of the forces of a block in a column.
    pub(super) fn add(&mut self, block: &Block<'_, f64>, column: usize, changes: &[f64]) {
        if self.width > 0 {
            for (row, change) in block.rows().zip(changes) {
                self.values[row * self.width + column] += change;
            }
        }
    }

    /// Sets the derivatives of the forces of a block by its residuals.
    pub(super) fn set_slopes(&mut self, block: &Block<'_, f64>, slopes: &[[f64; MAX_DIM]]) {
        self.by_residual[block.rows()].copy_from_slice(&slopes[..block.dim]);
    }

    /// Adds what follows from the derivatives of the acceleration, nv rows.
    pub(super) fn complete(&mut self, problem: &Problem<f64>, acceleration: &[f64]) {
        let RowForces {
            width,
            values,
            by_residual,
            rates,
        } = self;
        let width = *width;
        if width == 0 {
            return;
        }
        f64::vectorize_rows(|| {
            for block in problem.blocks() {
                let arms = block.jacobian.chunks_exact(block.dofs.len().max(1));
                for (k, arms) in arms.enumerate() {
                    rates.clear();
                    rates.resize(width, 0.0);
                    for (&dof, &arm) in block.dofs.iter().zip(arms) {
                        add_row(rates, arm, &acceleration[dof as usize * width..][..width]);
                    }
                    for row in block.rows() {
                        let sum = &mut values[row * width..][..width];
                        add_row(sum, by_residual[row][k], rates);
                    }
                }
            }
        });
    }
}

/// Computes `sum += factor · row`.
#[inline(always)]
pub(super) fn add_row(sum: &mut [f64], factor: f64, row: &[f64]) {
    // Many entries are zero: dofs of different branches do not affect each other.
    if factor != 0.0 {
        sum.iter_mut().zip(row).for_each(|(x, &y)| *x += factor * y);
    }
}
