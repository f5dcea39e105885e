//! Validation of problems.

use crate::costs::Cost;
use crate::error::ProblemError;
use crate::problem::{Block, Problem};
use crate::tree::TreeFactor;
use clench_math::{Mask, Real, Scalar};

impl<T: Real> Problem<T> {
    /// Checks the sizes that a solve indexes by.
    pub(crate) fn check_sizes(&self) -> Result<(), ProblemError> {
        check_length("qacc_smooth", self.qacc_smooth.len(), self.nv())?;
        check_length("mass", self.mass.values.len(), self.tree().nnz())?;
        match self.malformed {
            Some((block, reason)) => Err(ProblemError::Block { block, reason }),
            None => Ok(()),
        }
    }

    /// Checks everything that a solve relies on: lengths, finite numbers, a positive definite M, and the parameter
    /// ranges of each block. A solve itself does not check, so that a caller that constructs valid blocks pays nothing.
    ///
    /// # Errors
    /// Returns the first error found.
    pub fn check(&self) -> Result<(), ProblemError> {
        self.check_sizes()?;
        for (what, values) in [
            ("qacc_smooth", &self.qacc_smooth),
            ("mass", &self.mass.values),
            ("jacobian", &self.jacobian.values),
            ("aref", &self.aref),
            ("r", &self.r),
            ("d", &self.d),
            ("shape", &self.shape),
        ] {
            check_finite(what, values)?;
        }
        let positive = TreeFactor::zeros(self.tree()).factor(self.tree(), &self.mass);
        if let Some(lane) = (0..T::LANES).find(|&lane| !positive.lane(lane)) {
            return Err(ProblemError::MassNotPositiveDefinite { lane });
        }
        for (block, view) in self.blocks().enumerate() {
            check_block(&view).map_err(|reason| ProblemError::Block { block, reason })?;
        }
        Ok(())
    }
}

pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), ProblemError> {
    if found == expected {
        Ok(())
    } else {
        Err(ProblemError::WrongLength {
            what,
            found,
            expected,
        })
    }
}

fn check_finite<T: Real>(what: &'static str, values: &[T]) -> Result<(), ProblemError> {
    for (index, value) in values.iter().enumerate() {
        let finite = value.is_finite();
        if let Some(lane) = (0..T::LANES).find(|&lane| !finite.lane(lane)) {
            return Err(ProblemError::NotFinite { what, index, lane });
        }
    }
    Ok(())
}

/// The relative tolerance of D against 1 / R, and of the rows of an elliptic block against their common scale.
const CONSISTENT: f64 = 1e-4;

/// Checks the ranges of a block's parameters, lane by lane; a lane without the constraint has D = 0.
fn check_block<T: Real>(block: &Block<T>) -> Result<(), &'static str> {
    for lane in 0..T::LANES {
        let at = |values: &[T], row: usize| values[row].lane(lane).to_f64();
        for row in 0..block.dim {
            let (r, d) = (at(block.r, row), at(block.d, row));
            if d < 0.0 {
                return Err("D is negative");
            }
            if d > 0.0 && (d * r - 1.0).abs() > CONSISTENT {
                return Err("D is not 1 / R");
            }
        }
        let (d, shape) = (|row| at(block.d, row), |row| at(block.shape, row));
        let exists = d(0) != 0.0;
        if exists && block.cost.is_cone() && (1..block.dim).any(|j| shape(j) <= 0.0) {
            return Err("a friction coefficient is not positive");
        }
        // Returns true if the friction rows have D_j = D_row (μ_j / μ_row)².
        let consistent = |row: usize| {
            let scale = d(row) / shape(row).powi(2);
            let expected = |j| scale * shape(j).powi(2);
            (1..block.dim).all(|j| (d(j) / expected(j) - 1.0).abs() < CONSISTENT)
        };
        match block.cost {
            Cost::Huber if (0..block.dim).any(|row| shape(row) < 0.0) => {
                return Err("a friction loss is negative");
            }
            Cost::Pyramid if exists && (1..block.dim).any(|j| d(j) != d(0)) => {
                return Err("the rows of a pyramid need the same D");
            }
            Cost::Elliptic if exists && shape(0) <= 0.0 => {
                return Err("the regularized friction coefficient is not positive");
            }
            Cost::Elliptic if exists && !consistent(0) => {
                return Err("the rows of an elliptic cone need D_j = D_0 (mu_j / mu)²");
            }
            Cost::Coulomb if exists && !consistent(1) => {
                return Err("the friction rows of a Coulomb contact need D_j = D_1 (mu_j / mu_1)²");
            }
            Cost::Quadratic
            | Cost::OneSided
            | Cost::Huber
            | Cost::Pyramid
            | Cost::Elliptic
            | Cost::Coulomb => {}
        }
    }
    Ok(())
}
