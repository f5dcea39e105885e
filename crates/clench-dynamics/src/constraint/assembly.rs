//! The assembly of the convex problem: computes aref, R and D of each row, and records the rows for readers.

use super::exact::ExactDiagonal;
use super::implicit::ImplicitRows;
use super::row::Row;
use super::softness::least_regularization;
use crate::record::{BlockRecord, ConstraintRecord, ConstraintSource};
use clench_math::{Mask, Real, Scalar, kernel};
use clench_solver::{Cost, Problem};

/// The maximum rows of a block.
const MAX_DIM: usize = 6;

/// The problem under construction.
pub(super) struct Assembly<'a, T: Real> {
    pub problem: &'a mut Problem<T>,
    pub record: &'a mut ConstraintRecord<T>,
    pub qvel: &'a [T],
    /// The inverse inertia of each dof in the initial configuration (nv).
    pub dof_invweight0: &'a [T],
    /// Computes the current inverse inertia of each row, with the flag `diagexact`.
    pub exact: Option<ExactDiagonal<'a, T>>,
    /// Evaluates rows at the end of the step, with the integrator `discrete`.
    pub implicit: Option<ImplicitRows<'a, T>>,
    /// Receives the change of aref per displacement of each row, with the option `stiction`.
    pub slopes: Option<&'a mut Vec<T>>,
}

impl<T: Real> Assembly<'_, T> {
    /// Returns the dofs of the next block, to be filled in ascending order.
    #[inline(always)]
    pub(super) fn dofs(&mut self) -> &mut Vec<u32> {
        &mut self.record.dofs
    }

    /// Appends a block over the dofs in [`dofs`](Self::dofs); `fill` receives them and writes the Jacobian (rows ×
    /// dofs, row-major, initially zero). As in MuJoCo with dense Jacobians, a block other than a contact is inactive in
    /// lanes with an all-zero Jacobian: the limit of a tendon whose path misses the only geom that moves, or a connect
    /// at a point on its body's only rotation axis.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        cost: Cost,
        block: BlockRecord<T>,
        rows: &[Row<T>],
        fill: impl FnOnce(&[u32], &mut [T]),
    ) {
        let dofs = &self.record.dofs;
        let target = self.problem.push(cost, rows.len(), dofs);
        fill(dofs, target.jacobian);
        self.finish(cost, block, rows);
    }

    /// Completes the last block of the problem, whose Jacobian is filled.
    #[kernel]
    fn finish(&mut self, cost: Cost, mut block: BlockRecord<T>, rows: &[Row<T>]) {
        let ConstraintRecord {
            blocks,
            pos,
            vel,
            dofs,
        } = &mut *self.record;
        let target = self.problem.last_block_mut();
        let is_contact = matches!(block.source, ConstraintSource::Contact(_));
        if !is_contact {
            block.active &= any_nonzero(target.jacobian);
        }
        blocks.push(block);
        let mut r = [T::ZERO; MAX_DIM];
        for (r, row) in r.iter_mut().zip(rows) {
            *r = row.r;
        }
        if let Some(exact) = &mut self.exact {
            let matrix = (&*target.jacobian, &dofs[..]);
            exact.regularize(cost, rows, matrix, block.impedance, &mut r);
        }
        if let Some(implicit) = &self.implicit {
            let estimated = self.exact.is_none();
            let matrix = (&*target.jacobian, &dofs[..]);
            implicit.regularize(cost, rows, matrix, (block.impedance, estimated), &mut r);
        }
        if T::Scalar::IS_SINGLE {
            raise_regularization(
                cost,
                rows,
                target.jacobian,
                dofs,
                self.dof_invweight0,
                &mut r,
            );
        }
        for (i, row) in rows.iter().enumerate() {
            let jacobian = &target.jacobian[i * dofs.len()..(i + 1) * dofs.len()];
            let mut velocity = row.drift;
            for (&j, &dof) in jacobian.iter().zip(&*dofs) {
                velocity += j * self.qvel[dof as usize];
            }
            let aref = match &self.implicit {
                Some(implicit) => implicit.reference(row, velocity),
                None => row.at_velocity(velocity),
            };
            target.aref[i] = aref + r[i] * row.pull;
            target.r[i] = r[i];
            target.d[i] = T::select(block.active, T::ONE / r[i], T::ZERO);
            target.shape[i] = row.shape;
            pos.push(row.pos);
            vel.push(velocity);
            if let Some(slopes) = &mut self.slopes {
                slopes.push(match &self.implicit {
                    Some(implicit) => implicit.slope(row),
                    None => row.stiffness,
                });
            }
        }
    }
}

/// Returns the lanes in which a row is not all zero.
#[inline(always)]
fn any_nonzero<T: Real>(row: &[T]) -> T::Mask {
    let mut found = T::Mask::splat(false);
    for entry in row {
        found |= !entry.eq(T::ZERO);
    }
    found
}

/// Raises R to its minimum in single precision, see [`least_regularization`]. The rows of a cone are raised together:
/// their ratios are its shape.
#[inline(always)]
fn raise_regularization<T: Real>(
    cost: Cost,
    rows: &[Row<T>],
    jacobian: &[T],
    dofs: &[u32],
    dof_invweight0: &[T],
    r: &mut [T; MAX_DIM],
) {
    let mut inertia = [T::ZERO; MAX_DIM];
    for (i, a) in inertia[..rows.len()].iter_mut().enumerate() {
        for (&j, &dof) in jacobian[i * dofs.len()..].iter().zip(dofs) {
            *a += j * j * dof_invweight0[dof as usize];
        }
    }
    let mut factor = T::ONE;
    for i in 0..rows.len() {
        let a = match cost.has_edges() {
            // R is that of the edge y₀ + μ y_i.
            true => inertia[0] + rows[i].shape * rows[i].shape * inertia[i],
            false => inertia[i],
        };
        let least = least_regularization(a);
        factor = factor.max(least / r[i]);
        if !cost.is_cone() {
            r[i] = r[i].max(least);
        }
    }
    if cost.is_cone() {
        r.iter_mut().for_each(|r| *r *= factor);
    }
}
