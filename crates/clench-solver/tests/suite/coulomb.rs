//! Contacts by Coulomb's law: the solution satisfies it, whatever the normal forces do.

use crate::common::*;
use clench_solver::{Block, ConstraintSolver, Cost, Problem, Solver, SolverOptions, Switch, Tree};
use std::sync::Arc;

/// Returns problems of Coulomb contacts, half of them with other constraints.
fn problems(count: usize, stiffness: f64) -> impl Iterator<Item = Problem<f64>> {
    let mut rng = Rng(3);
    (0..count).map(move |k| {
        let parents = match k % 3 {
            0 => humanoid(),
            _ => {
                let nv = 1 + rng.below(30);
                random_forest(&mut rng, nv)
            }
        };
        let mut shape = Shape::new(parents, 1 + rng.below(12));
        shape.costs = match k % 2 {
            0 => vec![Cost::Coulomb],
            _ => vec![Cost::Coulomb, Cost::Huber, Cost::Quadratic, Cost::OneSided],
        };
        shape.stiffness = (1.0, stiffness);
        random_problem(&mut rng, &shape)
    })
}

/// Returns the number of problems that converge to the tolerance, after checking that all of those satisfy the law and
/// that all of the others report it.
fn converged(solver: ConstraintSolver, tolerance: f64, count: usize) -> usize {
    // Conjugate gradients take about √condition iterations.
    let stiffness = match solver {
        ConstraintSolver::Newton => 1e4,
        ConstraintSolver::Cg => 30.0,
    };
    let options = SolverOptions::new()
        .constraint_solver(solver)
        .iterations(300)
        .tolerance(tolerance);
    let mut converged = 0;
    for problem in problems(count, stiffness) {
        let mut solver = Solver::new(problem.tree());
        let stats = solver
            .solve(&problem, &options.resolve::<f64>(), None)
            .unwrap()
            .lane(0);
        if !matches!(stats.status.name(), "converged" | "no_progress" | "proven") {
            assert_eq!(stats.status.name(), "iteration_limit");
            continue;
        }
        converged += 1;
        assert_eq!(stats.normal_residual, 0.0);
        // The forces follow from the acceleration by the definition of the law, and balance it.
        let (_, gradient) = cost_and_gradient(&problem, solver.qacc());
        let size = norm(solver.qfrc_constraint()).max(1.0);
        assert!(norm(&gradient) < 1e-5 * size, "{:e}", norm(&gradient));
        for block in problem.blocks() {
            let force = &solver.force()[block.rows()];
            let expected = cost_and_force(&block, &residual(&block, solver.qacc())).1;
            // The solver updates residuals from step to step; stiff rows magnify their rounding.
            let d = difference(force, &expected);
            assert!(d < 1e-7, "{d:e} {force:?} {expected:?}");
            assert_in_cone(&block, force);
        }
    }
    converged
}

#[test]
fn forces_obey_coulombs_law() {
    let count = 300;
    let done = converged(ConstraintSolver::Newton, 1e-8, count);
    assert!(done >= 297, "{done} of {count}");
}

#[test]
fn conjugate_gradients_obey_it_too() {
    let count = 100;
    let done = converged(ConstraintSolver::Cg, 1e-14, count);
    assert!(done >= 80, "{done} of {count}");
}

#[test]
fn conjugate_gradients_obey_it_to_the_working_precision() {
    let count = 100;
    let done = converged(ConstraintSolver::Cg, 0.0, count);
    assert!(done >= 60, "{done} of {count}");
}

#[test]
fn what_a_short_solve_leaves_does_no_work() {
    let mut rng = Rng(11);
    let mut short = 0;
    for mut problem in problems(60, 1e3) {
        problem.rest = (0..problem.nv()).map(|_| rng.range(-1e3, 1e3)).collect();
        let options = SolverOptions::new()
            .constraint_solver(ConstraintSolver::Cg)
            .islands(Switch::Off)
            .iterations(3);
        let mut solver = Solver::new(problem.tree());
        let stats = solver.solve(&problem, &options.resolve::<f64>(), None);
        let stats = stats.expect("well-formed").lane(0);
        if stats.status.name() != "iteration_limit" {
            continue;
        }
        short += 1;
        let less =
            |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x - y).collect() };
        let displacement = less(solver.qacc(), &problem.qacc_smooth);
        let mut inertial = vec![0.0; problem.nv()];
        (problem.mass).mul(problem.tree(), &displacement, &mut inertial);
        let gradient = less(&inertial, solver.qfrc_constraint());
        let velocity = less(solver.qacc(), &problem.rest);
        let work: f64 = gradient.iter().zip(&velocity).map(|(g, w)| g * w).sum();
        let size = norm(&gradient) * norm(&velocity);
        assert!(work.abs() < 1e-6 * size, "{work:e} of {size:e}");
    }
    assert!(short > 30, "{short} solves reach the limit");
}

/// Returns the problem of a contact with a plane, of two dofs, along it and away from it: with the lower triangle of
/// the mass matrix, the unconstrained acceleration, D, the coefficient of friction, and aref along the plane.
fn on_plane(
    mass: [f64; 3],
    qacc_smooth: [f64; 2],
    (d, friction): (f64, f64),
    aref: f64,
) -> Problem<f64> {
    let tree = Tree::new(&[None, Some(0)]).expect("a chain");
    let mut problem = Problem::new(Arc::new(tree));
    problem.mass.values.copy_from_slice(&mass);
    problem.qacc_smooth.copy_from_slice(&qacc_smooth);
    assert!(problem.factor_mass());
    let block = problem.push(Cost::Coulomb, 2, &[0, 1]);
    block.jacobian.copy_from_slice(&[0.0, 1.0, 1.0, 0.0]);
    block.aref[1] = aref;
    block.r.fill(1.0 / d);
    block.d.fill(d);
    block.shape[1] = friction;
    problem.check().expect("well-formed");
    problem
}

#[test]
fn friction_does_not_change_the_normal_force() {
    // A block that slides along x: no coupling.
    let sliding = |aref: f64| {
        let problem = on_plane([2.0, 0.0, 2.0], [0.0, -10.0], (10.0, 0.5), aref);
        let mut solver = Solver::new(problem.tree());
        let settings = SolverOptions::new().resolve::<f64>();
        solver.solve(&problem, &settings, None).unwrap();
        [solver.force()[0], solver.force()[1]]
    };
    let [normal, none] = sliding(0.0);
    assert_eq!(none, 0.0);
    for aref in [-1e3, -1e1, 1e1, 1e3] {
        let [pressed, friction] = sliding(aref);
        assert!((pressed - normal).abs() < 1e-12 * normal);
        assert!((friction - 0.5 * normal * aref.signum()).abs() < 1e-12 * normal);
    }
}

#[test]
fn every_form_of_the_hessian_gives_the_same_bits() {
    let mut rng = Rng(5);
    let mut many = 0;
    for k in 0..30 {
        // The Hessian is stored by filled entries or as a dense matrix.
        let mut shape = Shape::heap(12, 6 + 3 * k);
        shape.costs = vec![Cost::Coulomb];
        let problem = random_problem(&mut rng, &shape);
        let [sparse, dense] = [Switch::On, Switch::Off].map(|choice| {
            let options = SolverOptions::new()
                .sparse_solve(choice)
                .islands(Switch::Off);
            let mut solver = Solver::new(problem.tree());
            let solved = solver.solve(&problem, &options.resolve::<f64>(), None);
            solved.expect("well-formed");
            solver
        });
        assert_eq!(sparse.qacc(), dense.qacc(), "problem {k}");
        assert_eq!(sparse.force(), dense.force(), "problem {k}");
        let slides = |block: &Block<f64>| {
            let force = &sparse.force()[block.rows()];
            let shares = force[1..]
                .iter()
                .zip(&block.shape[1..])
                .map(|(f, mu)| f / mu);
            let friction = shares.map(|x| x * x).sum::<f64>().sqrt();
            force[0] > 0.0 && friction > 0.999 * force[0]
        };
        let sliding = problem.blocks().filter(slides).count();
        many += usize::from(sliding > 16);
    }
    assert!(many > 5, "{many} problems of many contacts");
}

#[test]
fn a_contact_that_jams_sticks() {
    // Friction presses the contact more than it yields, like a rod that is pushed over a rough floor. While it slides, the
    // normal force exceeds the limit of friction slightly more with each larger limit.
    let problem = on_plane([1.0, 0.8, 1.0], [-2000.0, -1.0], (20.0, 1.3), 0.0);
    let mut solver = Solver::new(problem.tree());
    let settings = SolverOptions::new().resolve::<f64>();
    let stats = solver.solve(&problem, &settings, None);
    let stats = stats.expect("well-formed").lane(0);
    assert_eq!(stats.status.name(), "converged", "{stats:?}");
    assert!(stats.iterations <= 35, "{stats:?}");
    assert_eq!(stats.normal_residual, 0.0);
    let [normal, friction] = [solver.force()[0], solver.force()[1]];
    assert!(friction.abs() < 1.3 * normal, "{normal} {friction}");
}
