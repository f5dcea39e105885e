//! Accelerations in a metric that has terms in addition to M.
//!
//! The matrix of the motion is M̂ = M + Σ s j jᵀ, with one term for each of the last blocks of a problem
//! ([`Problem::begin_metric_terms`]). With J the rows √s jᵀ of all terms, Woodbury's identity gives
//!
//! ```text
//! M̂⁻¹ q = x − M⁻¹Jᵀ (I + J M⁻¹ Jᵀ)⁻¹ J x        x = M⁻¹ q
//! ```

use crate::iterate::dot;
use crate::problem::Problem;
use crate::tree::{Tree, TreeFactor, TreeMatrix};
use clench_math::{Real, kernel};

/// Memory for the terms of one problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct MetricTerms<T> {
    /// Jᵀ and M⁻¹Jᵀ, nv numbers per term.
    rows: Vec<T>,
    responses: Vec<T>,
    /// I + J M⁻¹ Jᵀ. It is dense, so its pattern is a chain.
    chain: Tree,
    gram: TreeMatrix<T>,
    factor: TreeFactor<T>,
    /// (I + J M⁻¹ Jᵀ)⁻¹ J x.
    pulls: Vec<T>,
}

impl<T: Real> MetricTerms<T> {
    /// Computes a_unc + M̂⁻¹ q in `qacc`, which holds the forces q on entry. In `lanes`, writes the force of each term
    /// to `force`: −s (jᵀa − jᵀa_unc).
    #[kernel]
    pub(crate) fn accelerate(
        &mut self,
        problem: &Problem<T>,
        lanes: T::Mask,
        qacc: &mut [T],
        force: &mut [T],
    ) {
        problem.mass_factor.solve(problem.tree(), qacc);
        let (_, terms) = problem.constraints_and_terms();
        if !terms.is_empty() {
            self.factor_gram(problem);
            let nv = problem.nv();
            self.pulls.clear();
            (self.pulls).extend(self.rows.chunks_exact(nv).map(|row| dot(row, qacc)));
            self.factor.solve(&self.chain, &mut self.pulls);
            let responses = self.responses.chunks_exact(nv);
            for ((block, &pull), response) in terms.iter().zip(&self.pulls).zip(responses) {
                let force = &mut force[block.row];
                *force = T::select(lanes, -pull * problem.d[block.row].sqrt(), *force);
                for (a, &response) in qacc.iter_mut().zip(response) {
                    *a -= response * pull;
                }
            }
        }
        for (a, &smooth) in qacc.iter_mut().zip(&problem.qacc_smooth) {
            *a += smooth;
        }
    }

    #[inline(always)]
    fn factor_gram(&mut self, problem: &Problem<T>) {
        let (_, terms) = problem.constraints_and_terms();
        let nv = problem.nv();
        self.rows.clear();
        self.responses.clear();
        for block in terms {
            let root = problem.d[block.row].sqrt();
            let start = self.rows.len();
            self.rows.resize(start + nv, T::ZERO);
            let dofs = problem.jacobian.dofs(block);
            for (&dof, &j) in dofs.iter().zip(problem.jacobian.values(block)) {
                self.rows[start + dof as usize] = root * j;
            }
            self.responses.extend_from_slice(&self.rows[start..]);
            let response = &mut self.responses[start..];
            problem.mass_factor.solve(problem.tree(), response);
        }
        if self.chain.nv() != terms.len() {
            let chain = self.chain.rebuild(terms.len(), |i| i.checked_sub(1));
            debug_assert!(chain.is_ok(), "a chain is a valid tree");
        }
        let entries = self.chain.nnz();
        self.gram.values.resize(entries, T::ZERO);
        for (i, row) in self.rows.chunks_exact(nv).enumerate() {
            let responses = self.responses.chunks_exact(nv);
            let gram = self.gram.row_mut(&self.chain, i);
            for (entry, response) in gram.iter_mut().zip(responses) {
                *entry = dot(row, response);
            }
            gram[i] += T::ONE;
        }
        self.factor.factor(&self.chain, &self.gram);
    }
}
