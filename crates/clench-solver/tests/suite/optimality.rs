//! The solution satisfies the optimality conditions, and all methods agree on it.

use crate::common::*;
use clench_solver::{ConstraintSolver, Problem, Settings, Solver, SolverOptions, Status, Switch};

fn exact() -> SolverOptions {
    SolverOptions::new().tolerance(0.0).iterations(200)
}

fn solve(problem: &Problem<f64>, settings: &Settings) -> Solver<f64> {
    let mut solver = Solver::new(problem.tree());
    solver.solve(problem, settings, None).unwrap();
    solver
}

/// Returns problems of each cost separately and of all together, on trees of many shapes.
fn problems(count: usize) -> impl Iterator<Item = Problem<f64>> {
    problems_with_stiffness(count, (1.0, 1e4))
}

/// Returns better conditioned problems: conjugate gradients take about √condition iterations.
fn soft_problems(count: usize) -> impl Iterator<Item = Problem<f64>> {
    problems_with_stiffness(count, (1.0, 100.0))
}

fn problems_with_stiffness(
    count: usize,
    stiffness: (f64, f64),
) -> impl Iterator<Item = Problem<f64>> {
    let mut rng = Rng(1);
    (0..count).map(move |k| {
        let parents = if k % 4 == 0 {
            humanoid()
        } else {
            let nv = 1 + rng.below(40);
            random_forest(&mut rng, nv)
        };
        let mut shape = Shape::new(parents, 1 + rng.below(20));
        if k % 6 < 5 {
            shape.costs = vec![ALL_COSTS[k % 6]];
        }
        shape.stiffness = stiffness;
        random_problem(&mut rng, &shape)
    })
}

/// Returns the gradient norm at the solution over the size of the terms that cancel in it, in units of the working
/// precision.
fn relative_gradient(problem: &Problem<f64>, solver: &Solver<f64>) -> f64 {
    let a = solver.qacc();
    let (_, gradient) = cost_and_gradient(problem, a);
    let mut terms = vec![norm(solver.qfrc_constraint()); problem.nv()];
    for block in problem.blocks() {
        let n = block.dofs.len();
        for i in 0..block.dim {
            let row = &block.jacobian[i * n..(i + 1) * n];
            let y: f64 = row
                .iter()
                .zip(block.dofs)
                .map(|(j, &dof)| (j * a[dof as usize]).abs())
                .sum();
            for (j, &dof) in row.iter().zip(block.dofs) {
                terms[dof as usize] += j.abs() * block.d[i] * (y + block.aref[i].abs());
            }
        }
    }
    norm(&gradient) / norm(&terms) / f64::EPSILON
}

#[test]
fn newton_satisfies_the_optimality_conditions() {
    for (k, problem) in problems(600).enumerate() {
        let solver = solve(&problem, &exact().resolve::<f64>());
        let error = relative_gradient(&problem, &solver);
        let stats = solver.stats().lane(0);
        assert!(error < 4.0, "problem {k}: {error:e} {stats:?}");
        assert!(
            matches!(
                stats.status,
                Status::NoProgress | Status::Converged | Status::Proven
            ),
            "problem {k}: {stats:?}"
        );
        assert!(stats.iterations <= 100, "problem {k}: {stats:?}");
    }
}

#[test]
fn newton_reaches_the_working_precision_on_stiff_problems() {
    for (k, problem) in problems_with_stiffness(200, (1e-2, 1e10)).enumerate() {
        let solver = solve(&problem, &exact().iterations(1000).resolve::<f64>());
        let error = relative_gradient(&problem, &solver);
        let stats = solver.stats().lane(0);
        assert!(error < 4.0, "problem {k}: {error:e} {stats:?}");
        assert_ne!(
            stats.status,
            Status::IterationLimit,
            "problem {k}: {stats:?}"
        );
    }
}

#[test]
fn what_is_reported_of_a_stiff_solve_cut_short_is_true() {
    for (k, problem) in problems_with_stiffness(100, (1e6, 1e9)).enumerate() {
        let solver = solve(
            &problem,
            &SolverOptions::new().iterations(4).resolve::<f64>(),
        );
        for block in problem.blocks() {
            let (_, force) = cost_and_force(&block, &residual(&block, solver.qacc()));
            let error = difference(&force, &solver.force()[block.rows()]);
            let size = norm(&force) / block.d[0];
            assert!(
                error < 1e-5 || size < 1e-9,
                "problem {k}: {error:e} {:?}",
                block.cost
            );
        }
    }
}

#[test]
fn cg_reaches_newtons_minimiser() {
    for (k, problem) in soft_problems(200).enumerate() {
        let newton = solve(&problem, &exact().resolve::<f64>());
        let cg = solve(
            &problem,
            &exact()
                .constraint_solver(ConstraintSolver::Cg)
                .iterations(1000)
                .resolve::<f64>(),
        );
        let error = difference(newton.qacc(), cg.qacc());
        assert!(
            error < 1e-7,
            "problem {k}: {error:e} {:?}",
            cg.stats().lane(0)
        );
    }
}

#[test]
fn sparse_and_dense_agree() {
    for (k, problem) in problems(200).enumerate() {
        let sparse = solve(&problem, &exact().sparse_solve(Switch::On).resolve::<f64>());
        let dense = solve(
            &problem,
            &exact().sparse_solve(Switch::Off).resolve::<f64>(),
        );
        assert_eq!(sparse.qacc(), dense.qacc(), "problem {k}");
        assert_eq!(sparse.force(), dense.force(), "problem {k}");
    }
}

#[test]
fn default_tolerance_is_met_and_reported() {
    for (k, problem) in problems(300).enumerate() {
        let settings = SolverOptions::new().resolve::<f64>();
        let solver = solve(&problem, &settings);
        let stats = solver.stats().lane(0);
        assert!(
            matches!(stats.status, Status::Converged | Status::Proven),
            "problem {k}: {stats:?}"
        );
        assert!(
            stats.gradient <= settings.tolerance,
            "problem {k}: {stats:?}"
        );
    }
}

#[test]
fn the_gap_bounds_the_true_error() {
    for (k, problem) in problems(300).enumerate() {
        let best = solve(&problem, &exact().resolve::<f64>());
        let (minimum, _) = cost_and_gradient(&problem, best.qacc());
        for iterations in 1..4 {
            let early = solve(
                &problem,
                &SolverOptions::new().iterations(iterations).resolve::<f64>(),
            );
            let (cost, _) = cost_and_gradient(&problem, early.qacc());
            let gap = early.stats().lane(0).gap;
            assert!(
                cost - minimum <= gap * (1.0 + 1e-9) + 1e-11 * cost,
                "problem {k}: {} > {gap}",
                cost - minimum
            );
        }
    }
}

#[test]
fn a_good_warm_start_is_proven_at_once() {
    for (k, problem) in problems(200).enumerate() {
        let settings = SolverOptions::new().resolve::<f64>();
        let first = solve(&problem, &exact().resolve::<f64>());
        let mut again = Solver::new(problem.tree());
        let stats = again
            .solve(&problem, &settings, Some(first.qacc()))
            .unwrap()
            .lane(0);
        assert_eq!(
            (stats.status, stats.iterations),
            (Status::Proven, 0),
            "problem {k}: {stats:?}"
        );
        assert_eq!(again.qacc(), first.qacc(), "problem {k}");
    }
}

#[test]
fn forces_lie_in_their_cones() {
    for problem in problems(300) {
        let solver = solve(
            &problem,
            &SolverOptions::new().iterations(3).resolve::<f64>(),
        );
        for block in problem.blocks() {
            assert_in_cone(&block, &solver.force()[block.rows()]);
        }
    }
}
