//! Bounds of the errors of a minimiser and of its derivative.
//!
//! A solve ends at a point â near the minimiser a*. There the implicit function theorem gives a derivative d̂ near the
//! exact one, d* = −H(a*)⁻¹ ∂g/∂θ dθ. The bounds use the norms |x|² = xᵀ M x of accelerations and |f|² = fᵀ M⁻¹ f of
//! forces, and that H ⪰ M: no eigenvalue of H relative to M is below 1.
//!
//! The cost is strongly convex with modulus 1, so every point a is near the minimiser (½ |g|² is the duality gap):
//!
//! ```text
//! |a − a*| ≤ |g(a)|                                  (1)
//! ```
//!
//! Let φ(a) = H(a) d̂ + ∂g/∂θ(a) dθ, the derivative of g along d̂ and dθ. It is zero for the exact derivative at a*,
//! so H(a*) (d̂ − d*) = φ(a*), and
//!
//! ```text
//! |d̂ − d*| ≤ |φ(a*)|                                (2)
//! ```
//!
//! a* is replaced by ã, the result of a second solve that starts at â and goes on as far as the working precision
//! allows. By (1) it is within r = |g(ã)| of a*, which is at the level of rounding errors, and |â − a*| ≤ |â − ã| + r.
//! φ(ã) is the derivative of one gradient in dual numbers, at the value ã with the derivative d̂.
//!
//! Since |J_i (ã − a*)| ≤ |J_iᵀ| r, no row is on another piece at a* than at ã if none is that near to a switch.
//! Otherwise the exact derivative is in doubt, and the bound is infinite. On equal pieces φ(ã) and φ(a*) differ by
//! O(r), rounding errors. So (2) covers the tolerance and the limits of the solve, rows that switch between â and a*,
//! and the rounding errors of the linear solves for d̂; it does not cover those of the problem's data.

use super::Implicit;
use crate::block_index::BlockIndex;
use crate::costs::Cost;
use crate::iterate::{Iterate, dot};
use crate::options::{ConstraintSolver, Settings};
use crate::problem::Problem;
use crate::stats::Status;
use clench_math::Real;

/// The maximum number of iterations of the second solve.
const ITERATIONS: usize = 200;

/// Bounds of the errors of a minimiser and of its derivatives, in the norm √(xᵀ M x). Not covered: rounding errors of
/// the problem's data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorBound {
    /// The bound of the distance of the acceleration from the minimiser; infinite if it is not known.
    pub acceleration: f64,
    /// For each direction, the bound of the error of the derivative of the acceleration; infinite if the minimiser may
    /// be at a switch, where there is none.
    pub directions: Vec<f64>,
    /// √(M⁻¹)ᵢᵢ for each dof: the largest component of a vector of norm 1.
    pub dofs: Vec<f64>,
    /// For each number of [`Problem::switching_distances`], the bound of its difference from that of the minimiser. A
    /// row whose distance is larger is on the piece on which it is at the minimiser.
    pub reach: Vec<f64>,
}

/// Computes error bounds of a problem in dual numbers, and reuses its memory.
#[derive(Clone, Debug)]
pub struct ErrorBounds<T: Real<Value = f64, Mask = bool>> {
    /// The second solve.
    refined: Implicit<f64>,
    /// The dual numbers at its result.
    iterate: Iterate<T>,
    /// True if the exact derivative exists.
    exists: bool,
    scratch: Vec<f64>,
}

impl<T: Real<Value = f64, Mask = bool>> Default for ErrorBounds<T> {
    fn default() -> Self {
        ErrorBounds {
            refined: Implicit::default(),
            iterate: Iterate::default(),
            exists: false,
            scratch: Vec::new(),
        }
    }
}

impl<T: Real<Value = f64, Mask = bool>> ErrorBounds<T> {
    /// Bounds the error of a solution. [`push_directions`](Self::push_directions) then adds those of its derivatives.
    /// A problem with Coulomb blocks has no minimiser, so its bounds are infinite.
    pub fn start(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        qacc: &[T],
        bound: &mut ErrorBound,
    ) {
        let settings = Settings {
            constraint_solver: ConstraintSolver::Newton,
            tolerance: 0.0,
            iterations: ITERATIONS,
            ls_iterations: settings.ls_iterations.max(ITERATIONS),
            ..*settings
        };
        let refined = &mut self.refined;
        let is_refined = refined.solve_values(problem, &settings, Some(qacc))
            && is_exact(refined.state.stats.status(0))
            && (problem.blocks()).all(|block| block.cost != Cost::Coulomb);
        let (problem, iterate) = (&refined.problem, &mut refined.state.iterate);
        iterate.evaluate_at_qacc(problem);
        let mut offset = Vec::from_iter(qacc.iter().map(|a| a.value()));
        for (offset, exact) in offset.iter_mut().zip(&iterate.qacc) {
            *offset -= exact;
        }
        let mut force = vec![0.0; offset.len()];
        problem.mass.mul(problem.tree(), &offset, &mut force);
        let rest = force_norm(problem, &mut iterate.gradient.clone());
        let radius = dot(&offset, &force).max(0.0).sqrt() + rest;
        bound.acceleration = if is_refined { radius } else { f64::INFINITY };
        bound.directions.clear();
        bound.dofs.clear();
        for dof in 0..problem.nv() {
            force.fill(0.0);
            force[dof] = 1.0;
            bound.dofs.push(force_norm(problem, &mut force));
        }
        push_slopes(problem, &mut bound.reach);
        problem.switching_distances(&iterate.qacc, &mut self.scratch);
        let mut rows = self.scratch.iter().zip(&bound.reach);
        self.exists = is_refined && rows.all(|(&distance, &slope)| distance > slope * rest);
        for reach in &mut bound.reach {
            *reach = if is_refined {
                *reach * radius
            } else {
                f64::INFINITY
            };
        }
    }

    /// Appends the bounds of the derivatives along the first `count` directions of dual numbers. The values of the
    /// problem and of its solution are those of [`start`](Self::start).
    pub fn push_directions(
        &mut self,
        problem: &Problem<T>,
        qacc: &[T],
        count: usize,
        bound: &mut ErrorBound,
    ) {
        let (refined, iterate) = (&self.refined, &mut self.iterate);
        iterate.qacc.clear();
        let exact = refined.state.iterate.qacc.iter();
        iterate
            .qacc
            .extend(qacc.iter().zip(exact).map(|(&a, &exact)| {
                let mut a = a;
                a.set_value(exact);
                a
            }));
        iterate.evaluate_at_qacc(problem);
        let end = bound.directions.len() + count;
        T::map_tangents(&mut iterate.gradient, &mut self.scratch, |rate| {
            if bound.directions.len() < end {
                let error = force_norm(&refined.problem, rate);
                (bound.directions).push(if self.exists { error } else { f64::INFINITY });
            }
        });
    }
}

impl ErrorBound {
    /// Sets all bounds to infinity: of a solution that is not the minimiser of a problem.
    pub fn set_unknown(&mut self, nv: usize, directions: usize, rows: usize) {
        self.acceleration = f64::INFINITY;
        for (bounds, count) in [
            (&mut self.directions, directions),
            (&mut self.dofs, nv),
            (&mut self.reach, rows),
        ] {
            bounds.clear();
            bounds.resize(count, f64::INFINITY);
        }
    }
}

/// Returns true if a solve with a tolerance of zero came as near to the minimiser as the precision allows.
fn is_exact(status: Status) -> bool {
    match status {
        Status::Unconstrained | Status::Proven | Status::Converged | Status::NoProgress => true,
        Status::IterationLimit | Status::NonFinite | Status::TooLarge => false,
    }
}

/// Returns √(fᵀ M⁻¹ f); `force` is overwritten.
fn force_norm(problem: &Problem<f64>, force: &mut [f64]) -> f64 {
    problem.mass_factor.solve_half(problem.tree(), force);
    dot(force, force).sqrt()
}

/// Writes the largest change of each switching distance under a change of the acceleration of norm 1.
fn push_slopes(problem: &Problem<f64>, out: &mut Vec<f64>) {
    out.clear();
    let acts = |b: &&BlockIndex| problem.d[b.row] > 0.0;
    for b in problem.constraints_and_terms().0.iter().filter(acts) {
        let (dofs, jacobian) = (problem.jacobian.dofs(b), problem.jacobian.values(b));
        let mut force = vec![0.0; problem.nv()];
        let rows = jacobian.chunks_exact(dofs.len().max(1)).map(|row| {
            force.fill(0.0);
            for (&dof, &j) in dofs.iter().zip(row) {
                force[dof as usize] = j;
            }
            force_norm(problem, &mut force)
        });
        let rows = Vec::from_iter(rows);
        let shape = problem.rows(b).shape;
        match b.cost {
            Cost::Quadratic | Cost::OneSided | Cost::Huber => out.extend(rows),
            Cost::Pyramid => {
                let edges = (1..b.dim).flat_map(|i| [rows[0] + shape[i].abs() * rows[i]; 2]);
                out.extend(edges);
            }
            Cost::Elliptic => {
                // The distances are y₀ − T and μ y₀ + T/μ.
                let squares = (1..b.dim).map(|i| (shape[i] * rows[i]).powi(2));
                let (mu, slip) = (shape[0], squares.sum::<f64>().sqrt());
                let slope = (rows[0] + slip).max(mu * rows[0] + slip / mu);
                out.extend(rows.iter().map(|_| slope));
            }
            Cost::Coulomb => out.extend(rows.iter().map(|_| f64::INFINITY)),
        }
    }
}
