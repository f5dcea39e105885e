//! A loose tolerance terminates a solve earlier, never later.

use crate::common::*;
use clench_solver::{ConstraintSolver, Cost, Problem, Solver, SolverOptions, Status, Tree};
use std::sync::Arc;

/// Returns a bent chain of links whose masses differ by orders of magnitude. Each dof has dry friction or a one-sided
/// limit.
fn chain(rng: &mut Rng, nv: usize) -> Problem<f64> {
    let parents: Vec<Option<usize>> = (0..nv).map(|i: usize| i.checked_sub(1)).collect();
    let tree = Arc::new(Tree::new(&parents).unwrap());
    let mut problem = Problem::<f64>::new(tree.clone());
    let mut tips = vec![[0.0, 0.0]];
    let mut heading: f64 = 0.0;
    for _ in 0..nv {
        heading += rng.range(-1.0, 1.0);
        let [x, y] = tips[tips.len() - 1];
        tips.push([x + heading.cos(), y + heading.sin()]);
    }
    for k in 0..nv {
        let mass = rng.scale(1e-3, 1e3);
        let centre = [0, 1].map(|c| 0.5 * (tips[k][c] + tips[k + 1][c]));
        let arm = |i: usize| [0, 1].map(|c| centre[c] - tips[i][c]);
        for i in 0..=k {
            for (j, value) in problem.mass.row_mut(&tree, i).iter_mut().enumerate() {
                *value += mass * (arm(i)[0] * arm(j)[0] + arm(i)[1] * arm(j)[1] + 1.0 / 12.0);
            }
        }
    }
    assert!(problem.factor_mass());
    let size = rng.scale(1.0, 1e6);
    for a in &mut problem.qacc_smooth {
        *a = size * rng.range(-1.0, 1.0);
    }
    for dof in 0..nv {
        let mut unit = vec![0.0; nv];
        unit[dof] = 1.0;
        problem.mass_factor.solve(&tree, &mut unit);
        let d = rng.scale(1.0, 1e4) / unit[dof];
        let (sign, aref) = (rng.range(-1.0, 1.0).signum(), size * rng.range(-1.0, 1.0));
        let friction = rng.unit() < 0.3;
        let cost = if friction {
            Cost::Huber
        } else {
            Cost::OneSided
        };
        let block = problem.push(cost, 1, &[dof as u32]);
        block.jacobian[0] = if friction { 1.0 } else { sign };
        block.aref[0] = if friction { 0.0 } else { aref };
        block.shape[0] = if friction {
            0.1 * size / unit[dof]
        } else {
            0.0
        };
        block.d[0] = d;
        block.r[0] = 1.0 / d;
    }
    problem.check().unwrap();
    problem
}

/// Returns the total iterations of 1,000 solves with this tolerance, all of which must reach it.
fn iterations(algorithm: ConstraintSolver, tolerance: f64) -> usize {
    let mut rng = Rng(13);
    let mut sum = 0;
    for k in 0..1000 {
        let problem = chain(&mut rng, 2 + k % 19);
        let options = SolverOptions::new().constraint_solver(algorithm);
        let settings = options.iterations(1000).tolerance(tolerance);
        let mut solver = Solver::new(problem.tree());
        let stats = solver.solve(&problem, &settings.resolve::<f64>(), None);
        let stats = stats.unwrap().lane(0);
        assert!(
            matches!(stats.status, Status::Converged | Status::Proven),
            "problem {k}, {algorithm:?} to {tolerance:e}: {stats:?}"
        );
        if algorithm == ConstraintSolver::Cg {
            let trace: f64 = (0..problem.nv())
                .map(|i| problem.mass.row(problem.tree(), i)[i])
                .sum();
            assert!(
                stats.gap <= 1.001 * tolerance * trace,
                "problem {k}: {stats:?}"
            );
        }
        sum += stats.iterations;
    }
    sum
}

#[test]
fn a_loose_tolerance_takes_fewer_iterations_than_a_tight_one() {
    for algorithm in [ConstraintSolver::Newton, ConstraintSolver::Cg] {
        let tolerances = [1e-8, 1e-6, 1e-4, 1e-2, 1e-1, 1.0];
        let counts = tolerances.map(|tolerance| iterations(algorithm, tolerance));
        assert!(
            counts.is_sorted_by(|a, b| a >= b),
            "{algorithm:?}: {counts:?}"
        );
    }
}

#[test]
fn conjugate_gradients_start_anew_where_limits_come_and_go() {
    let mean = iterations(ConstraintSolver::Cg, 1e-8) as f64 / 1000.0;
    assert!(mean < 40.0, "{mean} iterations");
}
