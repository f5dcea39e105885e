//! Problems from plain arrays, without trees, bodies or joints.

use crate::check::check_length;
use crate::costs::Cost;
use crate::error::ProblemError;
use crate::problem::Problem;
use crate::tree::Tree;
use clench_math::{Mask, Real};
use std::sync::Arc;

/// A constraint block as plain arrays; see [`BlockMut`](crate::BlockMut) for their meaning.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlainBlock<T> {
    /// The shape of the cost.
    pub cost: Cost,
    /// J, dim × nv row-major.
    pub jacobian: Vec<T>,
    /// aref, length dim.
    pub aref: Vec<T>,
    /// R > 0, length dim.
    pub r: Vec<T>,
    /// Huber: η. Pyramid and Coulomb: unused, then μ_j. Elliptic: regularized μ, then μ_j. Otherwise empty.
    pub shape: Vec<T>,
}

impl<T: Real> Problem<T> {
    /// Creates a problem from a dense mass matrix (nv × nv row-major, symmetric; its lower triangle is read), the
    /// unconstrained acceleration (length nv) and blocks. The problem is checked and ready to be solved.
    ///
    /// # Errors
    /// Returns an error if an array has the wrong length, or any error of [`check`](Self::check).
    pub fn from_arrays(
        mass: &[T],
        qacc_smooth: &[T],
        blocks: &[PlainBlock<T>],
    ) -> Result<Self, ProblemError> {
        let nv = qacc_smooth.len();
        check_length("mass", mass.len(), nv * nv)?;
        let tree = Arc::new(Tree::dense(nv));
        let mut problem = Problem::new(tree.clone());
        for (i, row) in mass.chunks_exact(nv.max(1)).enumerate() {
            problem.mass.row_mut(&tree, i).copy_from_slice(&row[..=i]);
        }
        problem.qacc_smooth.copy_from_slice(qacc_smooth);
        for block in blocks {
            problem.push_plain(block)?;
        }
        problem.check()?;
        problem.factor_mass();
        Ok(problem)
    }

    fn push_plain(&mut self, plain: &PlainBlock<T>) -> Result<(), ProblemError> {
        let (nv, dim) = (self.nv(), plain.aref.len());
        check_length("jacobian", plain.jacobian.len(), dim * nv)?;
        check_length("r", plain.r.len(), dim)?;
        if !plain.shape.is_empty() || plain.cost.has_shape() {
            check_length("shape", plain.shape.len(), dim)?;
        }
        if !plain.r.iter().all(|r| r.gt(T::ZERO).all()) {
            return Err(ProblemError::Block {
                block: self.nblock(),
                reason: "R is not positive",
            });
        }
        let acts = |dof: &u32| {
            (0..dim).any(|i| (!plain.jacobian[i * nv + *dof as usize].eq(T::ZERO)).any())
        };
        let dofs: Vec<u32> = (0..nv as u32).filter(acts).collect();
        let block = self.push(plain.cost, dim, &dofs);
        let columns = (0..dim).flat_map(|i| {
            dofs.iter()
                .map(move |&dof| plain.jacobian[i * nv + dof as usize])
        });
        block
            .jacobian
            .iter_mut()
            .zip(columns)
            .for_each(|(to, from)| *to = from);
        block.aref.copy_from_slice(&plain.aref);
        block.r.copy_from_slice(&plain.r);
        block
            .d
            .iter_mut()
            .zip(&plain.r)
            .for_each(|(d, &r)| *d = T::ONE / r);
        block.shape[..plain.shape.len()].copy_from_slice(&plain.shape);
        Ok(())
    }
}
