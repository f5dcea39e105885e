//! Bad input gives an error or a status, never a panic, and the values that a solve reports are true.

use crate::common::*;
use clench_solver::{
    Cost, PlainBlock, Problem, ProblemError, Settings, Solver, SolverOptions, Status, Tree,
};
use std::sync::Arc;

fn settings() -> Settings {
    SolverOptions::new().resolve::<f64>()
}

fn stop(aref: f64, r: f64) -> PlainBlock<f64> {
    PlainBlock {
        cost: Cost::OneSided,
        jacobian: vec![1.0, 0.0],
        aref: vec![aref],
        r: vec![r],
        shape: vec![],
    }
}

fn arrays(blocks: &[PlainBlock<f64>]) -> Result<Problem<f64>, ProblemError> {
    Problem::from_arrays(&[2.0, 0.5, 0.5, 1.0], &[-1.0, 0.0], blocks)
}

#[test]
fn a_stop_gives_by_its_softness() {
    // One coordinate: minimise ½ m (a + 1)² + ½ D a² for a < 0: a = −m / (m + D).
    let block = PlainBlock {
        cost: Cost::OneSided,
        jacobian: vec![1.0],
        aref: vec![0.0],
        r: vec![0.01],
        ..Default::default()
    };
    let problem = Problem::from_arrays(&[2.0], &[-1.0], &[block]).unwrap();
    let mut solver = Solver::new(problem.tree());
    let stats = solver.solve(&problem, &settings(), None).unwrap().lane(0);
    assert_eq!(
        (stats.status, stats.iterations, stats.factorizations),
        (Status::Converged, 1, 1)
    );
    assert!((solver.qacc()[0] + 2.0 / 102.0_f64).abs() < 1e-15);
    assert!((solver.force()[0] - 200.0 / 102.0_f64).abs() < 1e-13);
}

#[test]
fn wrong_problems_are_refused_with_a_reason() {
    let message = |problem: Result<Problem<f64>, ProblemError>| problem.unwrap_err().to_string();
    assert!(message(Problem::from_arrays(&[1.0], &[0.0, 0.0], &[])).contains("mass"));
    assert!(
        message(Problem::from_arrays(
            &[1.0, 2.0, 2.0, 1.0],
            &[0.0, 0.0],
            &[]
        ))
        .contains("positive definite")
    );
    assert!(message(Problem::from_arrays(&[f64::NAN], &[0.0], &[])).contains("finite"));
    assert!(message(arrays(&[stop(f64::INFINITY, 1.0)])).contains("aref"));
    for r in [0.0, -1.0, f64::NAN] {
        let blocks = [stop(0.0, 1.0), stop(0.0, r)];
        assert!(message(arrays(&blocks)).contains("block 1: R is not positive"));
    }
    let short = PlainBlock {
        jacobian: vec![1.0],
        ..stop(0.0, 1.0)
    };
    assert!(message(arrays(&[short])).contains("jacobian"));
    let friction = PlainBlock {
        cost: Cost::Huber,
        shape: vec![-1.0],
        ..stop(0.0, 1.0)
    };
    assert!(message(arrays(&[friction])).contains("friction loss"));
    let cone = |cost, r: [f64; 2], shape: [f64; 2]| PlainBlock {
        cost,
        jacobian: vec![1.0, 0.0, 0.0, 1.0],
        aref: vec![0.0; 2],
        r: r.to_vec(),
        shape: shape.to_vec(),
    };
    assert!(
        message(arrays(&[cone(Cost::Pyramid, [1.0, 1.0], [0.0, 0.0])]))
            .contains("friction coefficient")
    );
    assert!(message(arrays(&[cone(Cost::Pyramid, [1.0, 2.0], [0.0, 1.0])])).contains("same D"));
    assert!(
        message(arrays(&[cone(Cost::Elliptic, [1.0, 1.0], [0.0, 1.0])])).contains("regularized")
    );
    assert!(message(arrays(&[cone(Cost::Elliptic, [1.0, 1.0], [0.5, 1.0])])).contains("mu_j"));
    assert!(arrays(&[cone(Cost::Elliptic, [1.0, 0.25], [0.5, 1.0])]).is_ok());
    assert!(
        message(arrays(&[PlainBlock {
            cost: Cost::Elliptic,
            shape: vec![1.0],
            ..stop(0.0, 1.0)
        }]))
        .contains("rows")
    );
    assert_eq!(
        Tree::new(&[Some(0)]),
        Err(ProblemError::ParentAfterChild { dof: 0, parent: 0 })
    );
}

#[test]
fn impossible_blocks_are_refused_by_the_solve() {
    for (dim, dofs) in [
        (0, vec![0]),
        (7, vec![0]),
        (1, vec![1, 0]),
        (1, vec![0, 0]),
        (1, vec![2]),
    ] {
        let mut problem = arrays(&[]).unwrap();
        problem.push(Cost::Quadratic, dim, &dofs);
        let mut solver = Solver::new(problem.tree());
        assert!(matches!(
            solver.solve(&problem, &settings(), None),
            Err(ProblemError::Block { block: 0, .. })
        ));
        problem.clear_constraints();
        assert!(solver.solve(&problem, &settings(), None).is_ok());
        assert!(matches!(
            solver.solve(&problem, &settings(), Some(&[0.0])),
            Err(ProblemError::WrongLength { .. })
        ));
    }
}

#[test]
fn undefined_numbers_end_as_a_status() {
    let good = arrays(&[stop(0.0, 1e-3)]).unwrap();
    let solve = |problem: &Problem<f64>| {
        Solver::new(problem.tree())
            .solve(problem, &settings(), None)
            .unwrap()
            .status(0)
    };
    assert_eq!(solve(&good), Status::Converged);
    let mut bad = good.clone();
    bad.qacc_smooth[0] = f64::NAN;
    assert_eq!(solve(&bad), Status::NonFinite);
    bad.clear_constraints();
    assert_eq!(solve(&bad), Status::NonFinite);
    let mut bad = arrays(&[]).unwrap();
    let block = bad.push(Cost::OneSided, 1, &[0]);
    (block.jacobian[0], block.aref[0], block.r[0], block.d[0]) = (1.0, f64::NAN, 1.0, 1.0);
    assert_eq!(solve(&bad), Status::NonFinite);
}

#[test]
fn a_warm_start_is_taken_only_where_it_is_better() {
    let problem = arrays(&[stop(0.0, 1e-3)]).unwrap();
    let mut solver = Solver::new(problem.tree());
    let cold = solver.solve(&problem, &settings(), None).unwrap().lane(0);
    let best = solver.qacc().to_vec();
    for bad in [[1e9, -1e9], [f64::NAN, 0.0], [f64::INFINITY, 0.0]] {
        let stats = solver
            .solve(&problem, &settings(), Some(&bad))
            .unwrap()
            .lane(0);
        assert_eq!((stats, solver.qacc()), (cold, &best[..]));
    }
    let off = SolverOptions::new().warmstart(false).resolve::<f64>();
    assert_eq!(
        solver
            .solve(&problem, &off, Some(&best))
            .unwrap()
            .lane(0)
            .iterations,
        cold.iterations
    );
    assert_eq!(
        solver
            .solve(&problem, &settings(), Some(&best))
            .unwrap()
            .lane(0)
            .iterations,
        0
    );
}

#[test]
fn limits_are_kept_and_reported() {
    let mut rng = Rng(2);
    let mut shape = Shape::new(humanoid(), 20);
    shape.stiffness = (1e2, 1e6);
    let problem = random_problem(&mut rng, &shape);
    let mut solver = Solver::new(problem.tree());
    for iterations in 0..3 {
        let settings = SolverOptions::new().iterations(iterations).resolve::<f64>();
        let stats = solver.solve(&problem, &settings, None).unwrap().lane(0);
        assert_eq!(
            (stats.status, stats.iterations),
            (Status::IterationLimit, iterations)
        );
    }
    let settings = SolverOptions::new()
        .iterations(3)
        .ls_iterations(2)
        .resolve::<f64>();
    let stats = solver.solve(&problem, &settings, None).unwrap().lane(0);
    assert!(stats.ls_evaluations <= 6);
    // Without evaluations, the line search takes its initial guess, the Newton step.
    let settings = SolverOptions::new()
        .iterations(1)
        .ls_iterations(0)
        .resolve::<f64>();
    let stats = solver.solve(&problem, &settings, None).unwrap().lane(0);
    assert_eq!((stats.iterations, stats.ls_evaluations), (1, 0));
    assert!(stats.improvement > 0.0);
}

#[test]
fn problems_of_all_sizes_pass_through_one_solver() {
    let mut rng = Rng(4);
    let mut reused = Solver::new(&Tree::dense(0));
    for k in 0..100 {
        let nv = 1 + rng.below(70);
        let shape = Shape::new(random_forest(&mut rng, nv), k % 13);
        let problem = random_problem(&mut rng, &shape);
        let stats = reused.solve(&problem, &settings(), None).unwrap().lane(0);
        let mut fresh = Solver::new(problem.tree());
        assert_eq!(
            stats,
            fresh.solve(&problem, &settings(), None).unwrap().lane(0)
        );
        assert_eq!(reused.qacc(), fresh.qacc());
        assert_eq!(reused.force(), fresh.force());
    }
    let empty: Problem<f64> = Problem::new(Arc::new(Tree::dense(0)));
    assert_eq!(
        reused.solve(&empty, &settings(), None).unwrap().status(0),
        Status::Unconstrained
    );
}
