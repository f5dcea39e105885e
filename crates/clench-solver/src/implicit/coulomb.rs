//! The part of Coulomb's law in the derivative of the minimiser: friction that slides follows the normal force.
//!
//! With Y = H⁻¹ B and V = D J_n, the inverse of H − B V is (Sherman, Morrison & Woodbury):
//!
//! ```text
//! (H − B V)⁻¹ x = y + Y (I − V Y)⁻¹ V y,   y = H⁻¹ x
//! ```

use crate::block_index::BlockIndex;
use crate::costs::{Cost, Coulomb};
use crate::iterate::Iterate;
use crate::newton::Newton;
use crate::prediction::normal_product;
use crate::problem::Problem;
use clench_math::{Mask, Real};

/// The contacts that press and slide, and the factor of I − V Y.
#[derive(Clone, Debug)]
pub(super) struct Sliding<V> {
    /// A block and its weight D.
    contacts: Vec<(BlockIndex, V)>,
    /// Y, one row of nv numbers for each contact.
    responses: Vec<V>,
    /// The factor, row-major, and the row that was the pivot of each column.
    factor: Vec<V>,
    pivots: Vec<usize>,
    right: Vec<V>,
}

impl<V> Default for Sliding<V> {
    fn default() -> Self {
        Sliding {
            contacts: Vec::new(),
            responses: Vec::new(),
            factor: Vec::new(),
            pivots: Vec::new(),
            right: Vec::new(),
        }
    }
}

impl<V: Real> Sliding<V> {
    /// Returns true if no contact slides.
    pub(super) fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Prepares for a solved iterate and the factor of its Hessian.
    pub(super) fn prepare(
        &mut self,
        problem: &Problem<V>,
        iterate: &Iterate<V>,
        newton: &mut Newton<V>,
    ) {
        let nv = problem.nv();
        self.contacts.clear();
        self.responses.clear();
        let blocks = problem.jacobian.blocks.iter();
        for b in blocks.filter(|b| b.cost == Cost::Coulomb) {
            let presses = iterate.active_set[b.active_start].gt(V::ZERO);
            let slides = iterate.active_set[b.active_start + 1].gt(V::ZERO);
            if !(slides & presses).any() {
                continue;
            }
            let weight = V::select(presses, problem.d[b.row], V::ZERO);
            let rows = Coulomb::slip_direction(problem.rows(b), &iterate.residual[b.rows()]);
            let start = self.responses.len();
            self.responses.resize(start + nv, V::ZERO);
            let response = &mut self.responses[start..];
            let (dofs, jacobian) = (problem.jacobian.dofs(b), problem.jacobian.values(b));
            for (row, jacobian) in rows.iter().zip(jacobian.chunks_exact(dofs.len())) {
                for (&dof, &j) in dofs.iter().zip(jacobian) {
                    response[dof as usize] += j * *row;
                }
            }
            newton.solve(response);
            self.contacts.push((*b, weight));
        }
        let count = self.contacts.len();
        self.factor.clear();
        for (b, weight) in &self.contacts {
            for response in self.responses.chunks_exact(nv) {
                self.factor
                    .push(-(*weight * normal_product(problem, b, response)));
            }
        }
        for i in 0..count {
            self.factor[i * count + i] += V::ONE;
        }
        self.eliminate();
    }

    /// Factors by Gaussian elimination with partial pivoting. A pivot of zero, where friction jams and the derivative
    /// does not exist, is replaced by one.
    fn eliminate(&mut self) {
        let (n, a) = (self.contacts.len(), &mut self.factor);
        self.pivots.clear();
        for column in 0..n {
            let mut pivot = column;
            for row in column + 1..n {
                if (a[row * n + column].abs().gt(a[pivot * n + column].abs())).any() {
                    pivot = row;
                }
            }
            self.pivots.push(pivot);
            if pivot != column {
                for k in 0..n {
                    a.swap(column * n + k, pivot * n + k);
                }
            }
            let diagonal = &mut a[column * n + column];
            *diagonal = V::select(diagonal.eq(V::ZERO), V::ONE, *diagonal);
            let diagonal = *diagonal;
            for row in column + 1..n {
                let factor = a[row * n + column] / diagonal;
                a[row * n + column] = factor;
                for k in column + 1..n {
                    let above = a[column * n + k];
                    a[row * n + k] -= factor * above;
                }
            }
        }
    }

    /// Completes `y = H⁻¹ x` to (H − B V)⁻¹ x.
    pub(super) fn correct(&mut self, problem: &Problem<V>, y: &mut [V]) {
        let n = self.contacts.len();
        self.right.clear();
        for (b, weight) in &self.contacts {
            self.right.push(*weight * normal_product(problem, b, y));
        }
        let (x, a) = (&mut self.right, &self.factor);
        for column in 0..n {
            x.swap(column, self.pivots[column]);
        }
        for row in 0..n {
            for k in 0..row {
                let above = x[k];
                x[row] -= a[row * n + k] * above;
            }
        }
        for row in (0..n).rev() {
            for k in row + 1..n {
                let below = x[k];
                x[row] -= a[row * n + k] * below;
            }
            x[row] /= a[row * n + row];
        }
        for (&x, response) in x.iter().zip(self.responses.chunks_exact(y.len())) {
            for (y, &response) in y.iter_mut().zip(response) {
                *y += x * response;
            }
        }
    }
}
