//! Removes the slow slip that soft friction allows.
//!
//! After the solve, only the friction forces are solved again without regularization (R = 0), with fixed normal forces:
//!
//! ```text
//! minimise over the friction forces f:  ½ fᵀ A f + fᵀ b,    A = J M⁻¹ Jᵀ,    A f + b = J a(f) − aref
//! ```
//!
//! by Gauss–Seidel sweeps, block by block: dry friction within ±η; elliptic and Coulomb friction within its ellipse; in
//! a pyramid, each pair of opposing edges with its sum σ fixed, so that friction along one row is free within ±μ σ. The
//! acceleration a is updated along the way, so an update costs one row of J and one of M⁻¹Jᵀ. As in MuJoCo, the dropped
//! regularization cost counts towards the first sweep's improvement.
//!
//! If the metric has terms in addition to M, MuJoCo's sweeps use another matrix instead ([`Problem::noslip_factor`]).
//! The acceleration is then a_unc + M'⁻¹Jᵀf during the sweeps, and the effect of the forces in the whole metric is
//! computed after them.

use crate::block_index::BlockIndex;
use crate::costs::{Cost, MAX_DIM};
use crate::iterate::{Iterate, dot};
use crate::jacobian::Jacobian;
use crate::metric_terms::MetricTerms;
use crate::options::Settings;
use crate::problem::Problem;
use crate::stats::SolveStats;
use clench_math::{Mask, Real, Scalar, kernel};

/// The maximum number of Newton steps for the multiplier of an ellipse, which converges quadratically from below.
const MULTIPLIER_STEPS: usize = 20;

/// One block's part of A, and M⁻¹Jᵀ of its friction rows.
#[derive(Clone, Debug)]
struct Friction<T> {
    block: BlockIndex,
    /// The first friction row within the block.
    first: usize,
    a: [[T; MAX_DIM]; MAX_DIM],
    response: usize,
}

/// The memory of the sweeps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Noslip<T> {
    frictions: Vec<Friction<T>>,
    /// M⁻¹Jᵀ, one row of nv numbers for each friction row.
    responses: Vec<T>,
    terms: MetricTerms<T>,
    /// The acceleration at the end of the solve, in a metric.
    solved: Vec<T>,
}

impl<T: Real> Noslip<T> {
    /// Runs the sweeps on the solved `iterate`. `edges` holds the edge forces of pyramids and is updated.
    #[kernel]
    pub fn run(
        &mut self,
        problem: &Problem<T>,
        settings: &Settings,
        scale: T,
        iterate: &mut Iterate<T>,
        edges: &mut [T],
        stats: &mut SolveStats<T>,
    ) {
        self.prepare(problem);
        if self.frictions.is_empty() {
            return;
        }
        let mut live = self
            .frictions
            .iter()
            .fold(T::Mask::splat(false), |live, f| {
                live | problem.rows(&f.block).d[0].gt(T::ZERO)
            });
        let frictional = live;
        self.leave_metric(problem, iterate);
        let tolerance = T::new(settings.noslip_tolerance);
        let mut improvement = regularization_cost(problem, &iterate.force, edges);
        for _ in 0..settings.noslip_iterations {
            for k in 0..self.frictions.len() {
                improvement += self.update(k, problem, iterate, edges, live);
            }
            stats.noslip_iterations += T::select(live, T::ONE, T::ZERO);
            live &= (scale * improvement).ge(tolerance);
            if !live.any() {
                break;
            }
            improvement = T::ZERO;
        }
        write_edges(problem, &iterate.force, edges);
        self.return_to_metric(problem, iterate, frictional);
        iterate.qfrc_constraint.fill(T::ZERO);
        problem
            .jacobian
            .add_transposed(&iterate.force, &mut iterate.qfrc_constraint);
    }

    /// Replaces the acceleration in the metric by the initial one of the sweeps.
    #[inline(always)]
    fn leave_metric(&mut self, problem: &Problem<T>, iterate: &mut Iterate<T>) {
        if problem.noslip_factor.is_empty() {
            return;
        }
        self.solved.clone_from(&iterate.qacc);
        pull_of_constraints(problem, &iterate.force, &mut iterate.qacc);
        (problem.noslip_factor).solve(problem.tree(), &mut iterate.qacc);
        for (a, &smooth) in iterate.qacc.iter_mut().zip(&problem.qacc_smooth) {
            *a += smooth;
        }
    }

    /// Computes the effect of the final forces in the metric, in the lanes that have friction.
    #[inline(always)]
    fn return_to_metric(&mut self, problem: &Problem<T>, iterate: &mut Iterate<T>, lanes: T::Mask) {
        if problem.noslip_factor.is_empty() {
            return;
        }
        pull_of_constraints(problem, &iterate.force, &mut iterate.qacc);
        (self.terms).accelerate(problem, lanes, &mut iterate.qacc, &mut iterate.force);
        for (a, &solved) in iterate.qacc.iter_mut().zip(&self.solved) {
            *a = T::select(lanes, *a, solved);
        }
    }

    /// Lists the friction rows, dry friction first, and computes their responses.
    #[inline(always)]
    fn prepare(&mut self, problem: &Problem<T>) {
        self.frictions.clear();
        self.responses.clear();
        for first in [0, 1] {
            let blocks = problem.jacobian.blocks.iter();
            for block in blocks.filter(|b| b.cost.first_friction() == Some(first)) {
                self.push(problem, block, first);
            }
        }
    }

    #[inline(always)]
    fn push(&mut self, problem: &Problem<T>, block: &BlockIndex, first: usize) {
        let response = self.responses.len();
        let nv = problem.nv();
        let (dofs, values) = (problem.jacobian.dofs(block), problem.jacobian.values(block));
        let row = |i: usize| {
            dofs.iter()
                .zip(&values[i * block.ndof..(i + 1) * block.ndof])
        };
        let mut a = [[T::ZERO; MAX_DIM]; MAX_DIM];
        for i in first..block.dim {
            let start = self.responses.len();
            self.responses.resize(start + nv, T::ZERO);
            for (&dof, &j) in row(i) {
                self.responses[start + dof as usize] = j;
            }
            let factor = match problem.noslip_factor.is_empty() {
                true => &problem.mass_factor,
                false => &problem.noslip_factor,
            };
            factor.solve(problem.tree(), &mut self.responses[start..]);
            for k in first..block.dim {
                for (&dof, &j) in row(k) {
                    a[k - first][i - first] += j * self.responses[start + dof as usize];
                }
            }
        }
        self.frictions.push(Friction {
            block: *block,
            first,
            a,
            response,
        });
    }

    /// Improves one block's friction in the lanes of `live`; returns the decrease of the objective.
    #[inline(always)]
    fn update(
        &self,
        k: usize,
        problem: &Problem<T>,
        iterate: &mut Iterate<T>,
        edges: &[T],
        live: T::Mask,
    ) -> T {
        let friction = &self.frictions[k];
        let Friction {
            block, first, a, ..
        } = friction;
        let (first, count) = (*first, block.dim - first);
        let exists = live & problem.rows(block).d[0].gt(T::ZERO);
        let force = &iterate.force[block.rows()];
        let residual = residual(problem, block, first, &iterate.qacc);
        let target = friction.target(problem, force, edges, residual);
        let mut delta = [T::ZERO; MAX_DIM];
        for j in 0..count {
            delta[j] = T::select(exists, target[j] - force[first + j], T::ZERO);
        }
        let nv = problem.nv();
        let mut change = T::ZERO;
        for j in 0..count {
            iterate.force[block.row + first + j] += delta[j];
            let start = friction.response + j * nv;
            for (a, &r) in iterate
                .qacc
                .iter_mut()
                .zip(&self.responses[start..start + nv])
            {
                *a += r * delta[j];
            }
            let mut curvature = T::ZERO;
            for i in 0..count {
                curvature += a[j][i] * delta[i];
            }
            change += delta[j] * (residual[j] + T::new(0.5) * curvature);
        }
        -change
    }
}

impl<T: Real> Friction<T> {
    /// Computes the target friction forces from all forces of the block and the J a − aref of its friction rows.
    #[inline(always)]
    fn target(
        &self,
        problem: &Problem<T>,
        force: &[T],
        edges: &[T],
        mut residual: [T; MAX_DIM],
    ) -> [T; MAX_DIM] {
        let Friction {
            block, first, a, ..
        } = self;
        let shape = problem.rows(block).shape;
        let edges = match block.cost {
            Cost::Elliptic | Cost::Coulomb => {
                return on_ellipse(a, &residual, &force[1..], &shape[1..], force[0]);
            }
            Cost::Pyramid => Some(&edges[block.active_start..]),
            Cost::Quadratic | Cost::OneSided | Cost::Huber => None,
        };
        // Rows are solved one after the other, each with the changes of those before it.
        let mut target = [T::ZERO; MAX_DIM];
        let count = block.dim - first;
        for j in 0..count {
            let limit = match edges {
                Some(edges) => shape[j + 1] * (edges[2 * j] + edges[2 * j + 1]),
                None => shape[j],
            };
            let old = force[first + j];
            target[j] = within(old, residual[j], a[j][j], limit);
            let delta = target[j] - old;
            for i in 0..count {
                residual[i] += a[i][j] * delta;
            }
        }
        target
    }
}

/// Computes Jᵀ f of the constraints, without the forces of the metric's terms.
#[inline(always)]
fn pull_of_constraints<T: Real>(problem: &Problem<T>, force: &[T], out: &mut [T]) {
    out.fill(T::ZERO);
    let (constraints, _) = problem.constraints_and_terms();
    problem.jacobian.add_transposed_of(constraints, force, out);
}

/// Computes J a − aref of a block's friction rows.
#[inline(always)]
fn residual<T: Real>(
    problem: &Problem<T>,
    block: &BlockIndex,
    first: usize,
    qacc: &[T],
) -> [T; MAX_DIM] {
    let (dofs, values) = (problem.jacobian.dofs(block), problem.jacobian.values(block));
    let mut residual = [T::ZERO; MAX_DIM];
    for i in first..block.dim {
        let mut sum = -problem.aref[block.row + i];
        for (&dof, &j) in dofs.iter().zip(&values[i * block.ndof..]) {
            sum += j * qacc[dof as usize];
        }
        residual[i - first] = sum;
    }
    residual
}

/// Computes the optimal force of one row within ±bound.
#[inline(always)]
fn within<T: Real>(force: T, residual: T, a: T, limit: T) -> T {
    let free = T::select(a.gt(T::ZERO), force - residual / a, T::ZERO);
    free.clamp(-limit, limit)
}

/// Computes the optimal friction within Σ (f_j / μ_j)² ≤ normal².
///
/// In g = f / μ the ellipse is a ball of radius r, and g minimises ½ gᵀBg + gᵀc with B = diag(μ) A diag(μ). If the
/// minimiser is outside the ball, g(λ) = −(B + λ I)⁻¹ c with |g(λ)| = r: Newton's method on 1/r − 1/|g|, nearly linear
/// in λ.
#[inline(always)]
fn on_ellipse<T: Real>(
    a: &[[T; MAX_DIM]; MAX_DIM],
    residual: &[T; MAX_DIM],
    force: &[T],
    mu: &[T],
    normal: T,
) -> [T; MAX_DIM] {
    let n = mu.len();
    let mut b = [[T::ZERO; MAX_DIM]; MAX_DIM];
    let mut c = [T::ZERO; MAX_DIM];
    for i in 0..n {
        let mut linear = residual[i];
        for j in 0..n {
            linear -= a[i][j] * force[j];
            b[i][j] = mu[i] * a[i][j] * mu[j];
        }
        c[i] = mu[i] * linear;
    }
    let mut trace = T::ZERO;
    for i in 0..n {
        trace += b[i][i];
    }
    let presses = normal.gt(T::ZERO) & trace.gt(T::ZERO);
    let floor = trace * T::splat(T::Scalar::EPSILON);
    let radius = T::select(presses, normal, T::ONE);
    let mut lambda = T::ZERO;
    let mut g = [T::ZERO; MAX_DIM];
    let mut open = presses;
    for _ in 0..MULTIPLIER_STEPS {
        let (point, squared, slope) = shifted_minimum(&b, &c, lambda, floor, n);
        for (g, &point) in g.iter_mut().zip(&point) {
            *g = T::select(open, point, *g);
        }
        let length = squared.sqrt();
        // Newton's step for 1/r − 1/|g(λ)|; λ only grows, so a step back means that the root is reached.
        let step = squared / slope * (length - radius) / radius;
        open &= step.gt(lambda * T::splat(T::Scalar::EPSILON)) & step.is_finite();
        if !open.any() {
            break;
        }
        lambda = T::select(open, lambda + step, lambda);
    }
    // Scales back onto the ball if rounding left g outside.
    let length = dot(&g[..n], &g[..n]).sqrt();
    let shrink = T::select(length.gt(radius), radius / length, T::ONE);
    let mut force = [T::ZERO; MAX_DIM];
    for i in 0..n {
        force[i] = T::select(presses, g[i] * shrink * mu[i], T::ZERO);
    }
    force
}

/// Computes g = −(B + λ I)⁻¹ c, with |g|² and −½ d|g|²/dλ = gᵀ (B + λ I)⁻¹ g.
#[kernel]
fn shifted_minimum<T: Real>(
    b: &[[T; MAX_DIM]; MAX_DIM],
    c: &[T; MAX_DIM],
    lambda: T,
    floor: T,
    n: usize,
) -> ([T; MAX_DIM], T, T) {
    // Cholesky factorization of B + λ I; pivots lost to rounding are replaced by `floor`.
    let mut l = *b;
    for j in 0..n {
        let mut pivot = l[j][j] + lambda;
        for k in 0..j {
            pivot -= l[j][k] * l[j][k];
        }
        let root = pivot.max(floor).sqrt();
        l[j][j] = root;
        for i in j + 1..n {
            let mut sum = b[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            l[i][j] = sum / root;
        }
    }
    let forward = |x: &mut [T; MAX_DIM]| {
        for i in 0..n {
            for k in 0..i {
                let lik = l[i][k];
                let xk = x[k];
                x[i] -= lik * xk;
            }
            x[i] /= l[i][i];
        }
    };
    let mut g = *c;
    for g in &mut g {
        *g = -*g;
    }
    forward(&mut g);
    for i in (0..n).rev() {
        for k in i + 1..n {
            let gk = g[k];
            g[i] -= l[k][i] * gk;
        }
        g[i] /= l[i][i];
    }
    let mut half = g;
    forward(&mut half);
    (g, dot(&g[..n], &g[..n]), dot(&half[..n], &half[..n]))
}

/// Computes ½ Σ R f² over all rows of constraints, for pyramids over their edges.
#[inline(always)]
fn regularization_cost<T: Real>(problem: &Problem<T>, force: &[T], edges: &[T]) -> T {
    let mut sum = T::ZERO;
    let (constraints, _) = problem.constraints_and_terms();
    for b in constraints {
        if b.cost.has_edges() {
            let edges = &edges[b.active_start..b.active_start + 2 * (b.dim - 1)];
            sum += problem.r[b.row] * dot(edges, edges);
        } else {
            for row in b.rows() {
                sum += problem.r[row] * force[row] * force[row];
            }
        }
    }
    T::new(0.5) * sum
}

/// Splits the friction of each pyramid row over its two edges, whose sum does not change.
#[inline(always)]
fn write_edges<T: Real>(problem: &Problem<T>, force: &[T], edges: &mut [T]) {
    let blocks = problem.jacobian.blocks.iter();
    for b in blocks.filter(|b| b.cost.has_edges()) {
        let rows = problem.rows(b);
        let exists = rows.d[0].gt(T::ZERO);
        for j in 1..b.dim {
            let pair = &mut edges[b.active_start + 2 * j - 2..b.active_start + 2 * j];
            let sum = pair[0] + pair[1];
            let difference = T::select(exists, force[b.row + j] / rows.shape[j], T::ZERO);
            pair[0] = T::new(0.5) * (sum + difference);
            pair[1] = T::new(0.5) * (sum - difference);
        }
    }
}
