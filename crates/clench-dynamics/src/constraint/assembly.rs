//! The destination of constraint rows: the convex problem and a record of each row for readers.

use super::exact::ExactDiagonal;
use super::implicit::ImplicitRows;
use super::row::Row;
use super::softness::{is_single, least_regularization};
use crate::model::Model;
use clench_math::{Mask, Real, kernel};
use clench_solver::{Cost, Problem};

/// The maximum rows of a block.
const MAX_DIM: usize = 6;

/// The source of a constraint; the number is its index among the sources of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintSource {
    /// An equality of the model.
    Equality(usize),
    /// A constraint that was added at run time.
    Dynamic {
        /// The slot that holds it.
        slot: usize,
        /// The bodies that it ties.
        bodies: [usize; 2],
        /// True for a weld, false for a connect.
        weld: bool,
    },
    /// Dry friction of a dof.
    DofFriction(usize),
    /// Dry friction of a tendon.
    TendonFriction(usize),
    /// A limit of a joint.
    JointLimit(usize),
    /// A limit of a tendon.
    TendonLimit(usize),
    /// A contact of the workspace.
    Contact(usize),
}

impl ConstraintSource {
    /// Returns the kind of constraint as in MuJoCo, or "dynamic" if it was added at run time.
    pub fn kind(self) -> &'static str {
        match self {
            ConstraintSource::Equality(_) => "equality",
            ConstraintSource::Dynamic { .. } => "dynamic",
            ConstraintSource::DofFriction(_) => "friction_dof",
            ConstraintSource::TendonFriction(_) => "friction_tendon",
            ConstraintSource::JointLimit(_) => "limit_joint",
            ConstraintSource::TendonLimit(_) => "limit_tendon",
            ConstraintSource::Contact(_) => "contact",
        }
    }

    /// Returns the index of the source among those of its kind.
    pub fn index(self) -> usize {
        match self {
            ConstraintSource::Equality(i)
            | ConstraintSource::Dynamic { slot: i, .. }
            | ConstraintSource::DofFriction(i)
            | ConstraintSource::TendonFriction(i)
            | ConstraintSource::JointLimit(i)
            | ConstraintSource::TendonLimit(i)
            | ConstraintSource::Contact(i) => i,
        }
    }

    /// Returns the name of the source (of the joint for a dof); empty if unnamed, for contacts and if added at run
    /// time.
    pub fn name(self, model: &Model) -> &str {
        match self {
            ConstraintSource::Equality(i) => &model.equalities[i].name,
            ConstraintSource::DofFriction(i) => &model.joints[model.dofs[i].joint].name,
            ConstraintSource::TendonFriction(i) | ConstraintSource::TendonLimit(i) => {
                &model.tendons[i].name
            }
            ConstraintSource::JointLimit(i) => &model.joints[i].name,
            ConstraintSource::Dynamic { .. } | ConstraintSource::Contact(_) => "",
        }
    }
}

/// The data of a block that the problem does not store.
#[derive(Clone, Copy, Debug)]
pub struct BlockRecord<T: Real> {
    /// The source of the block.
    pub source: ConstraintSource,
    /// Lanes in which the block is active.
    pub active: T::Mask,
    /// The distance at which the block begins to act.
    pub margin: T,
    /// The impedance d, of the normal for contacts.
    pub impedance: T,
}

/// The records of all blocks and rows of the last constraint stage, in the order of the problem.
#[derive(Clone, Debug, Default)]
pub struct ConstraintRecord<T: Real> {
    /// One record per block.
    pub blocks: Vec<BlockRecord<T>>,
    /// The position of each row: violation, signed distance or angle.
    pub pos: Vec<T>,
    /// The rate of change of each position: J v plus the surfaces' own velocity.
    pub vel: Vec<T>,
    /// The dofs of the next block.
    pub(super) dofs: Vec<u32>,
}

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
        if is_single::<T>() {
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
            let asked = match &self.implicit {
                Some(implicit) => implicit.reference(row, velocity),
                None => row.aref - row.damping * velocity,
            };
            target.aref[i] = asked + r[i] * row.pull;
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
        let a = match cost {
            // R is that of the edge y₀ + μ y_i.
            Cost::Pyramid => inertia[0] + rows[i].shape * rows[i].shape * inertia[i],
            _ => inertia[i],
        };
        let least = least_regularization(a);
        factor = factor.max(least / r[i]);
        if let Cost::Quadratic | Cost::OneSided | Cost::Huber = cost {
            r[i] = r[i].max(least);
        }
    }
    if let Cost::Pyramid | Cost::Elliptic | Cost::Coulomb = cost {
        r.iter_mut().for_each(|r| *r *= factor);
    }
}

impl<T: Real> ConstraintRecord<T> {
    /// Clears all rows and retains their memory.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.pos.clear();
        self.vel.clear();
    }
}
