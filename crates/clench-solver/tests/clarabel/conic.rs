//! The problem as a conic program, solved by Clarabel in 106-bit arithmetic.
//!
//! Every cost is the minimum over v of a squared distance to v plus a cost of v. With D diagonal:
//!
//! ```text
//! s(y) = min over v of  ½ (v − y)ᵀ D (v − y) + σ(v)
//!
//! quadratic   v = 0
//! one-sided   v ≥ 0
//! Huber       σ(v) = η |v|
//! pyramid     v ≥ 0, for each edge y₀ ± μ_j y_j, all with D₀
//! elliptic    v₀ ≥ |(μ_j v_j)|, the dual of the friction cone |(f_j / μ_j)| ≤ f₀
//! ```
//!
//! The first four are immediate. (Huber: the best v is 0 if |D y| ≤ η, else y ∓ Rη.) The last is exactly MuJoCo's
//! elliptic cost. MuJoCo scales to N = μ y₀, U_j = μ_j y_j, T = |U|, with μ the regularized coefficient, and sets D_j =
//! D₀ (μ_j / μ)², so that Σ D (v − y)² = (D₀ / μ²) × squared distance in (N, U). There the set of feasible v is the
//! circular cone N ≥ μT: μ cancels in v₀ ≥ |(μ_j v_j)|, so it changes the metric but not the set. Its boundary rays are
//! (μ, u), |u| = 1, so its polar cone is μN + T ≤ 0. Hence:
//!
//! ```text
//! top     N ≥ μT        y is in the cone          distance² = 0
//! bottom  μN + T ≤ 0    y is in the polar cone    distance² = N² + T²               s = ½ Σ D y²
//! middle  else          nearest to the ray        distance² = (N − μT)² / (1 + μ²)  s = ½ D₀ / (μ² (1 + μ²)) (N − μT)²
//! ```
//!
//! In terms of u = a − a_unc and t = √D (v − y), which is the force over √D, Clarabel solves
//!
//! ```text
//! minimise  ½ uᵀ M u + ½ |t|² + Σ (η / √D) ρ    over u, t, ρ    with z = √D (J u + J a_unc − aref) + t
//!
//! quadratic z = 0    one-sided, pyramid z ≥ 0    Huber |z| ≤ ρ    elliptic z₀ ≥ |(μ_j √(D₀ / D_j) z_j)|
//! ```

use crate::number::{Wide, wide};
use crate::wide::{WideBlock, WideProblem};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
    SupportedConeT::{NonnegativeConeT, SecondOrderConeT, ZeroConeT},
};
use clench_solver::Cost;
use num_traits::Float;

/// The solution found by Clarabel.
pub struct Optimum {
    /// a − a_unc.
    pub u: Vec<Wide>,
    /// The primal objective. The minimum lies between it and the dual objective.
    pub primal: Wide,
    pub dual: Wide,
}

/// Minimises the cost of `problem`, scaled by `unit` because tolerances are relative to 1.
pub fn minimise(problem: &WideProblem, unit: Wide) -> Optimum {
    let length = unit.sqrt();
    let nv = problem.nv;
    let mut program = Program::default();
    for i in 0..nv {
        program.variable(wide(0.0));
        for k in 0..=i {
            program.quadratic.push((k, i, problem.mass[k * nv + i]));
        }
    }
    for block in &problem.blocks {
        program.push(nv, block);
    }
    for x in program.linear.iter_mut().chain(&mut program.right) {
        *x /= length;
    }
    let solution = program.solve();
    Optimum {
        primal: solution.obj_val * unit,
        dual: solution.obj_val_dual * unit,
        u: solution.x[..nv].iter().map(|&u| u * length).collect(),
    }
}

/// The program: minimise ½ xᵀ P x + qᵀ x with b − A x in a product of cones. Matrices are lists of (row, column,
/// value).
#[derive(Default)]
struct Program {
    quadratic: Vec<(usize, usize, Wide)>,
    linear: Vec<Wide>,
    matrix: Vec<(usize, usize, Wide)>,
    right: Vec<Wide>,
    cones: Vec<SupportedConeT<Wide>>,
}

/// An affine function of the variables.
struct Affine {
    terms: Vec<(usize, Wide)>,
    constant: Wide,
}

impl Program {
    fn variable(&mut self, linear: Wide) -> usize {
        self.linear.push(linear);
        self.linear.len() - 1
    }

    /// Adds a variable t with the cost ½ t².
    fn force(&mut self) -> usize {
        let t = self.variable(wide(0.0));
        self.quadratic.push((t, t, wide(1.0)));
        t
    }

    /// Requires the values to be in a cone.
    fn require(&mut self, cone: fn(usize) -> SupportedConeT<Wide>, values: Vec<Affine>) {
        self.cones.push(cone(values.len()));
        for Affine { terms, constant } in values {
            let row = self.right.len();
            let entries = terms.into_iter().map(|(x, c)| (row, x, -c));
            self.matrix.extend(entries);
            self.right.push(constant);
        }
    }

    fn push(&mut self, nv: usize, block: &WideBlock) {
        let one = wide(1.0);
        let (dim, shape) = (block.d.len(), &block.shape);
        let root: Vec<Wide> = block.d.iter().map(|d| d.sqrt()).collect();
        let cone = match block.cost {
            Cost::Quadratic => ZeroConeT,
            Cost::OneSided | Cost::Huber | Cost::Pyramid => NonnegativeConeT,
            Cost::Elliptic => SecondOrderConeT,
            Cost::Coulomb => unreachable!("Coulomb's law is not a convex problem"),
        };
        match block.cost {
            Cost::Quadratic | Cost::OneSided => {
                for (i, &root) in root.iter().enumerate() {
                    let t = self.force();
                    let v = Affine::row(nv, block, i).times(root).plus(t, one);
                    self.require(cone, vec![v]);
                }
            }
            Cost::Huber => {
                for (i, &root) in root.iter().enumerate() {
                    let (t, rho) = (self.force(), self.variable(shape[i] / root));
                    let v = |sign| {
                        let v = Affine::row(nv, block, i).times(root).plus(t, one);
                        v.times(sign).plus(rho, one)
                    };
                    self.require(cone, vec![v(one), v(-one)]);
                }
            }
            Cost::Pyramid => {
                for (j, sign) in (1..dim).flat_map(|j| [(j, one), (j, -one)]) {
                    let t = self.force();
                    let side = Affine::row(nv, block, j).times(sign * shape[j]);
                    let edge = Affine::row(nv, block, 0).add(side);
                    self.require(cone, vec![edge.times(root[0]).plus(t, one)]);
                }
            }
            Cost::Elliptic => {
                let v = |i: usize| {
                    let t = self.force();
                    let v = Affine::row(nv, block, i).times(root[i]).plus(t, one);
                    v.times(if i == 0 {
                        one
                    } else {
                        shape[i] * root[0] / root[i]
                    })
                };
                let v = (0..dim).map(v).collect();
                self.require(cone, v);
            }
            Cost::Coulomb => unreachable!("Coulomb's law is not a convex problem"),
        }
    }

    /// Solves the program. Second-order cones retain their digits only if the iterates stay away from the boundary, so
    /// steps are shorter than Clarabel's default. If rounding ends an attempt early, the next takes shorter steps.
    fn solve(self) -> DefaultSolution<Wide> {
        let n = self.linear.len();
        let quadratic = sparse(n, n, self.quadratic);
        let matrix = sparse(self.right.len(), n, self.matrix);
        let (linear, right, cones) = (&self.linear, &self.right, &self.cones);
        let mut attempts = [0.8, 0.6, 0.4].into_iter().map(|step| {
            let settings = settings(step);
            let solver = DefaultSolver::new(&quadratic, linear, &matrix, right, cones, settings);
            let mut solver = solver.expect("a well-formed program");
            solver.solve();
            solver.solution
        });
        let solution = attempts
            .find(|s| matches!(s.status, SolverStatus::Solved | SolverStatus::AlmostSolved));
        solution.expect("a program that Clarabel can solve")
    }
}

impl Affine {
    /// Returns y of one row.
    fn row(nv: usize, block: &WideBlock, i: usize) -> Self {
        let row = &block.jacobian[i * nv..(i + 1) * nv];
        Affine {
            terms: row.iter().copied().enumerate().collect(),
            constant: block.offset[i],
        }
    }
    fn times(mut self, factor: Wide) -> Self {
        self.terms.iter_mut().for_each(|(_, c)| *c *= factor);
        self.constant *= factor;
        self
    }
    fn plus(mut self, variable: usize, coefficient: Wide) -> Self {
        self.terms.push((variable, coefficient));
        self
    }
    /// Returns the sum of two functions of the same variables.
    fn add(mut self, other: Affine) -> Self {
        let pairs = self.terms.iter_mut().zip(other.terms);
        pairs.for_each(|((_, c), (_, other))| *c += other);
        self.constant += other.constant;
        self
    }
}

/// Returns settings for 106 bits. Clarabel's defaults are for 53.
fn settings(step: f64) -> DefaultSettings<Wide> {
    DefaultSettings {
        verbose: false,
        presolve_enable: false,
        tol_gap_abs: wide(1e-20),
        tol_gap_rel: wide(1e-20),
        tol_feas: wide(1e-20),
        reduced_tol_gap_abs: wide(1e-13),
        reduced_tol_gap_rel: wide(1e-13),
        reduced_tol_feas: wide(1e-13),
        // The programs are always feasible.
        tol_infeas_abs: wide(1e-60),
        tol_infeas_rel: wide(1e-60),
        max_step_fraction: wide(step),
        static_regularization_constant: wide(1e-20),
        dynamic_regularization_eps: wide(1e-28),
        dynamic_regularization_delta: wide(1e-16),
        iterative_refinement_reltol: wide(1e-28),
        iterative_refinement_abstol: wide(1e-28),
        equilibrate_min_scaling: wide(1e-10),
        equilibrate_max_scaling: wide(1e10),
        ..DefaultSettings::default()
    }
}

fn sparse(rows: usize, columns: usize, entries: Vec<(usize, usize, Wide)>) -> CscMatrix<Wide> {
    let entries = entries
        .into_iter()
        .filter(|(.., value)| *value != wide(0.0));
    let (mut i, mut j, mut v) = (Vec::new(), Vec::new(), Vec::new());
    for (row, column, value) in entries {
        i.push(row);
        j.push(column);
        v.push(value);
    }
    CscMatrix::new_from_triplets(rows, columns, i, j, v)
}
