//! The solver against an independent one, on problems of all costs, well and badly conditioned.
//!
//! The reference is Clarabel, an interior-point method for conic programs; `conic.rs` derives the programs and proves
//! that they are equivalent to the problem. It computes in 106 bits: at condition numbers of 1e10 one 53-bit result
//! cannot validate another. Every reference is checked before use: its primal and its dual objective enclose the
//! minimum to 1e-13, and its objective equals the cost by MuJoCo's definition at its minimiser, which also checks the
//! derivation. Costs are evaluated in 106 bits, at the 53-bit accelerations that the solver returns.
//!
//! `cargo test -p clench-solver --test clarabel -- --nocapture` prints the worst differences.

#[allow(dead_code)] // This program uses only some of what the suite shares.
#[path = "../suite/common/mod.rs"]
mod common;
mod conic;
mod number;
mod reference;
mod sample;
mod wide;

use clench_solver::{ConstraintSolver, Problem, Settings, Solver, SolverOptions, Status, Switch};
use common::{Rng, assert_in_cone, cost_and_force, difference, norm};
use number::{Wide, wide};
use reference::{CLASSES, Reference, draw, references};
use wide::WideProblem;

/// Returns settings that iterate to the working precision.
fn exact() -> Settings {
    SolverOptions::new()
        .tolerance(0.0)
        .iterations(1000)
        .resolve::<f64>()
}

fn solve(problem: &Problem<f64>, settings: &Settings, warmstart: Option<&[f64]>) -> Solver<f64> {
    let mut solver = Solver::new(problem.tree());
    solver.solve(problem, settings, warmstart).unwrap();
    solver
}

/// The largest value of each quantity in each class.
struct Worst<const N: usize> {
    names: [&'static str; N],
    values: [[f64; N]; CLASSES.len()],
    counts: [usize; CLASSES.len()],
}

impl<const N: usize> Worst<N> {
    fn new(names: [&'static str; N]) -> Self {
        Worst {
            names,
            values: [[0.0; N]; CLASSES.len()],
            counts: [0; CLASSES.len()],
        }
    }

    fn take(&mut self, class: usize, values: [f64; N]) {
        self.counts[class] += 1;
        for (worst, value) in self.values[class].iter_mut().zip(values) {
            *worst = worst.max(value);
        }
    }
}

impl<const N: usize> Drop for Worst<N> {
    fn drop(&mut self) {
        for ((class, count), values) in CLASSES.iter().zip(self.counts).zip(self.values) {
            let values = self.names.iter().zip(values);
            let values: Vec<String> = values.map(|(name, v)| format!("{name} {v:.1e}")).collect();
            println!("{class:>10}: {count} problems, worst {}", values.join(", "));
        }
    }
}

/// The maximum effect of the rounding of an acceleration on its cost, relative to the minimum.
const ROUNDING: f64 = 1e-12;

/// Condition numbers of M and D up to 1e10.
#[test]
fn minima_agree_and_the_gap_certifies_them() {
    let mut worst = Worst::new(["cost", "gap", "iterations"]);
    for (k, reference) in references(1, 420, 1e10, 1e10).enumerate() {
        let solver = solve(&reference.problem, &exact(), None);
        let stats = solver.stats().lane(0);
        let (excess, gap) = (
            reference.excess(solver.qacc()),
            reference.relative(stats.gap),
        );
        worst.take(
            reference.class,
            [excess.abs(), gap, stats.iterations as f64],
        );
        assert!(excess.abs() < 1e-8, "problem {k}: {excess:e} {stats:?}");
        assert!(gap < 1e-8, "problem {k}: {gap:e} {stats:?}");
        assert!(
            excess <= gap + ROUNDING,
            "problem {k}: {excess:e} > {gap:e}"
        );
        let ended = matches!(stats.status, Status::Converged | Status::NoProgress);
        assert!(
            ended || stats.status == Status::Proven,
            "problem {k}: {stats:?}"
        );
        check_early_stops(k, &reference);
    }
}

/// Checks that the gap bounds the true error wherever a solve stops.
fn check_early_stops(k: usize, reference: &Reference) {
    let newton = SolverOptions::new();
    let cg = newton.constraint_solver(ConstraintSolver::Cg);
    for options in [newton.iterations(1), newton.iterations(4), newton, cg] {
        let solver = solve(&reference.problem, &options.resolve::<f64>(), None);
        let stats = solver.stats().lane(0);
        let excess = reference.excess(solver.qacc());
        let gap = reference.relative(stats.gap);
        assert!(
            excess <= gap * (1.0 + 1e-6) + ROUNDING,
            "problem {k}: {excess:e} > {gap:e} {stats:?}"
        );
    }
}

/// Condition numbers of M and D up to 1e7.
#[test]
fn accelerations_and_forces_agree_from_every_start() {
    let mut worst = Worst::new(["acceleration", "force", "warm-started"]);
    let mut rng = Rng(3);
    for (k, reference) in references(2, 420, 1e7, 1e7).enumerate() {
        let problem = &reference.problem;
        let solver = solve(problem, &exact(), None);
        let minimiser = reference.qacc();
        let qacc = difference(solver.qacc(), &minimiser);
        let force = force_difference(&reference, &solver);
        assert!(qacc < 1e-7, "problem {k}: {qacc:e}");
        assert!(force < 1e-7, "problem {k}: {force:e}");

        let far: Vec<f64> = minimiser.iter().map(|_| rng.range(-1e3, 1e3)).collect();
        let near: Vec<f64> = minimiser
            .iter()
            .map(|a| a + rng.range(-1e-3, 1e-3))
            .collect();
        let mut warm = 0.0_f64;
        for start in [&far, &near, &minimiser] {
            let solver = solve(problem, &exact(), Some(start));
            warm = warm.max(difference(solver.qacc(), &minimiser));
        }
        assert!(warm < 1e-7, "problem {k}: {warm:e}");
        worst.take(reference.class, [qacc, force, warm]);
    }
}

/// Returns ‖Jᵀf − M u‖ over ‖M u‖, or over a small part of the smooth force if hardly any constraint acts.
fn force_difference(reference: &Reference, solver: &Solver<f64>) -> f64 {
    let problem = &reference.problem;
    let expected = reference.qfrc_constraint();
    let mut smooth = vec![0.0; problem.nv()];
    problem
        .mass
        .mul(problem.tree(), &problem.qacc_smooth, &mut smooth);
    let error: Vec<f64> = expected
        .iter()
        .zip(solver.qfrc_constraint())
        .map(|(x, y)| x - y)
        .collect();
    norm(&error) / norm(&expected).max(1e-8 * norm(&smooth))
}

/// Condition numbers of M up to 1e7, of D up to 1e5, since conjugate gradients take about √condition iterations.
#[test]
fn dense_sparse_islands_and_conjugate_gradients_reach_the_same_minimiser() {
    let mut worst = Worst::new(["dense", "sparse", "islands", "CG", "CG's cost"]);
    let exact = SolverOptions::new().tolerance(0.0).iterations(10_000);
    for (k, reference) in references(4, 120, 1e7, 1e5).enumerate() {
        let minimiser = reference.qacc();
        let found = |options: SolverOptions| {
            let solver = solve(&reference.problem, &options.resolve::<f64>(), None);
            solver.qacc().to_vec()
        };
        let cg = found(exact.constraint_solver(ConstraintSolver::Cg));
        let errors = [
            difference(&found(exact.sparse_solve(Switch::Off)), &minimiser),
            difference(&found(exact.sparse_solve(Switch::On)), &minimiser),
            difference(&found(exact.islands(Switch::Off)), &minimiser),
            difference(&cg, &minimiser),
            reference.excess(&cg).abs(),
        ];
        worst.take(reference.class, errors);
        assert!(
            errors[..4].iter().all(|&e| e < 1e-7),
            "problem {k}: {errors:?}"
        );
        assert!(errors[4] < 1e-8, "problem {k}: {errors:?}");
    }
}

/// Checks the optimality conditions to the last digits: M (a − a_unc) = Jᵀf, f = −∇s(J a − aref), f in its cone.
/// Condition numbers of M and D up to 1e10.
#[test]
fn solutions_are_optimal_to_the_last_digits() {
    let mut worst = Worst::new(["imbalance", "force"]);
    let mut rng = Rng(5);
    for k in 0..600 {
        let class = k % CLASSES.len();
        let problem = draw(&mut rng, class, k / CLASSES.len(), 1e10, 1e10);
        let solver = solve(&problem, &exact(), None);
        let errors = optimality(&problem, &solver);
        worst.take(class, errors);
        assert!(
            errors[0] < 4.0 && errors[1] < 16.0,
            "problem {k}: {errors:?}"
        );
        for block in problem.blocks() {
            assert_in_cone(&block, &solver.force()[block.rows()]);
        }
    }
}

/// Returns the residual of M (a − a_unc) − Jᵀf and the largest difference between a force and that of its residual,
/// both relative to the effect of the rounding of a.
fn optimality(problem: &Problem<f64>, solver: &Solver<f64>) -> [f64; 2] {
    let wide_problem = WideProblem::new(problem);
    let (a, smooth) = (solver.qacc(), &problem.qacc_smooth);
    let u = wide_problem.relative(a);
    let mut balance = wide_problem.inertial(&u);
    let sizes: Vec<f64> = a
        .iter()
        .zip(smooth)
        .map(|(a, b)| a.abs() + b.abs())
        .collect();
    let rows = wide_problem.mass.chunks_exact(problem.nv());
    let mut rounding: Vec<f64> = rows.map(|row| magnitude(row, &sizes)).collect();
    let mut worst_force = 0.0_f64;
    for (block, wide_block) in problem.blocks().zip(&wide_problem.blocks) {
        let y: Vec<f64> = wide_block
            .residual(&u)
            .into_iter()
            .map(Wide::to_f64)
            .collect();
        let (_, expected) = cost_and_force(&block, &y);
        let force = &solver.force()[block.rows()];
        // In the norm of the cost, a force is a distance: divided by √D.
        let mut error = Vec::new();
        let mut scale = Vec::new();
        for (i, row) in wide_block.jacobian.chunks_exact(problem.nv()).enumerate() {
            let root = block.d[i].sqrt();
            error.push((force[i] - expected[i]) / root);
            scale.push(root * (magnitude(row, a) + block.aref[i].abs()));
        }
        let scale = norm(&scale);
        worst_force = worst_force.max(norm(&error) / scale);
        for (i, row) in wide_block.jacobian.chunks_exact(problem.nv()).enumerate() {
            for (k, &j) in row.iter().enumerate() {
                balance[k] -= j * wide(force[i]);
                rounding[k] += j.to_f64().abs() * block.d[i].sqrt() * scale;
            }
        }
    }
    let balance: Vec<f64> = balance.into_iter().map(Wide::to_f64).collect();
    [norm(&balance) / norm(&rounding), worst_force].map(|error| error / f64::EPSILON)
}

/// Returns Σ |row| |x|.
fn magnitude(row: &[Wide], x: &[f64]) -> f64 {
    let terms = row.iter().zip(x).map(|(m, x)| (m.to_f64() * x).abs());
    terms.sum()
}
