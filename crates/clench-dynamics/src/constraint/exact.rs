//! The inverse inertia of rows in the current configuration, instead of an estimate at the initial one (MuJoCo's flag
//! `diagexact`).
//!
//! R = A (1 − d) / d, with A = J M⁻¹ Jᵀ of the row in place of A₀. One row determines R of a cone: the normal of an
//! elliptic or Coulomb one, the first edge of a pyramid, J = J_n + μ₁ J_1. The others keep their ratio to it, which
//! preserves the shape of the cone.

use super::row::Row;
use super::softness::inverse_weight;
use clench_math::Real;
use clench_solver::{Cost, Tree, TreeFactor};

/// The inputs to the computation of A.
pub(super) struct ExactDiagonal<'a, T> {
    pub tree: &'a Tree,
    /// The factor of the mass matrix.
    pub factor: &'a TreeFactor<T>,
    /// The ratio of friction to normal impedance.
    pub impratio: T,
    /// One number per dof.
    pub scratch: &'a mut Vec<T>,
}

impl<T: Real> ExactDiagonal<'_, T> {
    /// Replaces R of the rows of a block with impedance `d`.
    #[inline(always)]
    pub(super) fn regularize(
        &mut self,
        cost: Cost,
        rows: &[Row<T>],
        (jacobian, dofs): (&[T], &[u32]),
        d: T,
        r: &mut [T],
    ) {
        match cost {
            Cost::Quadratic | Cost::OneSided | Cost::Huber => {
                for (i, r) in r[..rows.len()].iter_mut().enumerate() {
                    let row = &jacobian[i * dofs.len()..];
                    *r = inverse_weight(d, self.inverse_inertia(row, &[], T::ZERO, dofs));
                }
            }
            Cost::Pyramid => {
                let mu = rows[1].shape;
                let (normal, tangent) = jacobian.split_at(dofs.len());
                let a = self.inverse_inertia(normal, tangent, mu, dofs);
                let edge = T::new(2.0) * (mu * mu / self.impratio) * inverse_weight(d, a);
                r[..rows.len()].fill(edge);
            }
            Cost::Elliptic | Cost::Coulomb => {
                let a = self.inverse_inertia(jacobian, &[], T::ZERO, dofs);
                let larger = inverse_weight(d, a) / r[0];
                r[..rows.len()].iter_mut().for_each(|r| *r *= larger);
            }
        }
    }

    /// Computes J M⁻¹ Jᵀ of J = row + factor · other.
    #[inline(always)]
    fn inverse_inertia(&mut self, row: &[T], other: &[T], factor: T, dofs: &[u32]) -> T {
        let x = &mut *self.scratch;
        x.clear();
        x.resize(self.tree.nv(), T::ZERO);
        for (&dof, &j) in dofs.iter().zip(row) {
            x[dof as usize] = j;
        }
        for (&dof, &j) in dofs.iter().zip(other) {
            x[dof as usize] += factor * j;
        }
        self.factor.solve_half(self.tree, x);
        let mut sum = T::ZERO;
        for &x in x.iter() {
            sum += x * x;
        }
        sum
    }
}
