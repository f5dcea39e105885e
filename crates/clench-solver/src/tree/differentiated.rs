//! Solutions of linear systems in dual numbers, with one factorization of the values.
//!
//! The derivative of x = A⁻¹ b is that of a system with the same matrix:
//!
//! ```text
//! A dx = db − dA x
//! ```

use super::{Tree, TreeFactor, TreeMatrix};
use clench_math::{Real, Scalar, kernel};

/// Solves A x = b, where `x` holds b at first. Returns false in lanes in which A is not positive definite.
#[kernel]
pub fn solve_differentiated<T: Real>(tree: &Tree, matrix: &TreeMatrix<T>, x: &mut [T]) -> T::Mask {
    let (factor, positive) = factor_values(tree, matrix);
    let mut solution = Vec::from_iter(x.iter().map(|x| x.value()));
    factor.solve(tree, &mut solution);
    for i in 0..tree.nv() {
        let own = constant(solution[i]);
        let dofs = tree.row(i);
        for (&j, &entry) in dofs.iter().zip(matrix.row(tree, i)) {
            let j = j as usize;
            x[i] -= entry.scale(constant(solution[j]));
            if j < i {
                x[j] -= entry.scale(own);
            }
        }
    }
    factor.solve_varying(tree, x);
    for (x, &value) in x.iter_mut().zip(&solution) {
        x.set_value(value);
    }
    positive
}

/// Factors the values of a matrix.
fn factor_values<T: Real>(tree: &Tree, matrix: &TreeMatrix<T>) -> (TreeFactor<T::Value>, T::Mask) {
    let values = matrix.values.iter().map(|x| x.value()).collect();
    let mut factor = TreeFactor::zeros(tree);
    let positive = factor.factor(tree, &TreeMatrix { values });
    (factor, positive)
}

/// Returns a number without derivatives, which has one lane.
#[inline(always)]
fn constant<V: Real>(x: V) -> f64 {
    x.lane(0).to_f64()
}

impl<T: Real> TreeFactor<T> {
    /// Factors the values of a matrix; the factor has no derivatives. Returns false in lanes in which the matrix is not
    /// positive definite.
    pub fn factor_values(&mut self, tree: &Tree, matrix: &TreeMatrix<T>) -> T::Mask {
        let (factor, positive) = factor_values(tree, matrix);
        for (to, from) in [
            (&mut self.lower, &factor.lower),
            (&mut self.diagonal, &factor.diagonal),
            (&mut self.inverse, &factor.inverse),
        ] {
            to.clear();
            to.extend(from.iter().map(|&x| T::from_value(x)));
        }
        positive
    }
}

impl<V: Real> TreeFactor<V> {
    /// Computes `x ← A⁻¹ x` in numbers with derivatives.
    #[kernel]
    pub(crate) fn solve_varying<T: Real<Value = V>>(&self, tree: &Tree, x: &mut [T]) {
        let row = |i: usize| {
            let multipliers = &self.lower[tree.row_start(i)..][..tree.depth(i)];
            tree.row(i).iter().zip(multipliers)
        };
        for i in (0..tree.nv()).rev() {
            let own = x[i];
            for (&j, &multiplier) in row(i) {
                x[j as usize] -= own.scale(constant(multiplier));
            }
        }
        for i in 0..tree.nv() {
            let mut own = x[i].scale(constant(self.inverse[i]));
            for (&j, &multiplier) in row(i) {
                own -= x[j as usize].scale(constant(multiplier));
            }
            x[i] = own;
        }
    }
}
