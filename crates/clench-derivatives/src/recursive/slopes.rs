//! The derivatives of the force of a constraint by its distance and residual.

use super::step::Step;
use clench_dynamics::constraint::at_distance::{MAX_DIM, rows_at_distance};
use clench_dynamics::contact::Contact;
use clench_dynamics::record::ConstraintSource;
use clench_math::{Dual, Real};
use clench_solver::{Block, block_force};

/// The derivatives of the force of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    pub by_distance: [f64; MAX_DIM],
    pub by_residual: [[f64; MAX_DIM]; MAX_DIM],
    pub damping: [f64; MAX_DIM],
}

/// A number with its derivatives by the distance and by the residual of each row.
type RowDual = Dual<f64, { 1 + MAX_DIM }>;

impl Slopes {
    /// Computes the derivatives of the force of a block at the residual `y`. Returns `None` if it has more than one
    /// coordinate.
    pub(super) fn new(
        step: &Step<'_>,
        block: &Block<'_, f64>,
        of: (ConstraintSource, Option<&Contact<f64>>),
        y: &[f64],
    ) -> Option<Self> {
        let (dim, record) = (block.dim, &step.plain.record);
        let mut velocities = [RowDual::ZERO; MAX_DIM];
        for (velocity, &value) in velocities.iter_mut().zip(&record.vel[block.rows()]) {
            velocity.value = value;
        }
        let mut distance = RowDual::new(record.pos[block.row]);
        distance.tangent[0] = 1.0;
        let of_model = (step.model, step.params, step.settings);
        let rows = rows_at_distance(of_model, of, distance, &velocities[..dim])?;
        let mut residual = [RowDual::ZERO; MAX_DIM];
        let mut d = [RowDual::ZERO; MAX_DIM];
        for k in 0..dim {
            d[k] = RowDual::ONE / rows.r[k];
            residual[k] = -rows.aref[k];
            residual[k].value = y[k];
            residual[k].tangent[1 + k] = 1.0;
        }
        let mut force = [RowDual::ZERO; MAX_DIM];
        let numbers = [&d[..dim], &rows.r[..dim], &rows.shape[..dim]];
        block_force(rows.cost, numbers, &residual[..dim], &mut force[..dim]);
        let mut slopes = Slopes {
            by_distance: [0.0; MAX_DIM],
            by_residual: [[0.0; MAX_DIM]; MAX_DIM],
            damping: rows.damping.map(|damping| damping.value),
        };
        for (k, force) in force[..dim].iter().enumerate() {
            let [by_distance, by_residual @ ..] = force.tangent;
            (slopes.by_distance[k], slopes.by_residual[k]) = (by_distance, by_residual);
        }
        Some(slopes)
    }

    /// Returns the change of the force with the distance and the residual.
    pub(super) fn force(
        &self,
        dim: usize,
        distance: f64,
        residual: &[f64; MAX_DIM],
    ) -> [f64; MAX_DIM] {
        let mut force = [0.0; MAX_DIM];
        for (k, force) in force[..dim].iter_mut().enumerate() {
            *force = self.by_distance[k] * distance;
            for (slope, y) in self.by_residual[k][..dim].iter().zip(residual) {
                *force += slope * y;
            }
        }
        force
    }
}
