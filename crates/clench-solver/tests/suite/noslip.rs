//! After enough sweeps, friction slips only at its limit.

use crate::common::*;
use clench_solver::{Block, Cost, Problem, Solver, SolverOptions};

fn scenes(costs: &'static [Cost]) -> impl Iterator<Item = Problem<f64>> {
    let mut rng = Rng(9);
    (0..20).map(move |_| {
        let mut shape = Shape::new(humanoid(), 6);
        shape.costs = costs.to_vec();
        random_problem(&mut rng, &shape)
    })
}

fn options(sweeps: usize) -> SolverOptions {
    SolverOptions::new()
        .tolerance(0.0)
        .iterations(100)
        .noslip_iterations(sweeps)
        .noslip_tolerance(-1.0)
}

fn solve(problem: &Problem<f64>, sweeps: usize) -> Solver<f64> {
    let mut solver = Solver::new(problem.tree());
    solver
        .solve(problem, &options(sweeps).resolve::<f64>(), None)
        .unwrap();
    solver
}

/// Returns the slip that a friction row should not have: all of it inside the limit, only that along the force at the
/// limit.
fn wrong_slip(force: f64, limit: f64, slip: f64) -> f64 {
    let at = |bound: f64| (force - bound).abs() < 1e-9 * limit;
    match () {
        _ if limit == 0.0 => 0.0,
        _ if at(limit) => slip.max(0.0),
        _ if at(-limit) => (-slip).max(0.0),
        _ => slip.abs(),
    }
}

/// Returns the remaining slip of a block, by the optimality conditions of noslip.
fn leftover(problem: &Problem<f64>, solver: &Solver<f64>, k: usize, block: &Block<f64>) -> f64 {
    let slip = residual(block, solver.qacc());
    let force = &solver.force()[block.rows()];
    match block.cost {
        Cost::Huber => (0..block.dim)
            .map(|j| wrong_slip(force[j], block.shape[j], slip[j]))
            .fold(0.0, f64::max),
        Cost::Pyramid => (1..block.dim)
            .map(|j| {
                let pair = &solver.edge_forces(problem, k)[2 * j - 2..2 * j];
                wrong_slip(force[j], block.shape[j] * (pair[0] + pair[1]), slip[j])
            })
            .fold(0.0, f64::max),
        Cost::Elliptic | Cost::Coulomb => {
            let g: Vec<f64> = (1..block.dim).map(|j| force[j] / block.shape[j]).collect();
            let s: Vec<f64> = (1..block.dim).map(|j| slip[j] * block.shape[j]).collect();
            if force[0] == 0.0 {
                return 0.0;
            }
            if norm(&g) < force[0] * (1.0 - 1e-9) {
                return norm(&s);
            }
            // On the ellipse, slip opposes the force.
            let along: f64 = g.iter().zip(&s).map(|(g, s)| g * s).sum::<f64>() / norm(&g).powi(2);
            let across: Vec<f64> = g.iter().zip(&s).map(|(g, s)| s - along * g).collect();
            norm(&across) + along.max(0.0)
        }
        _ => 0.0,
    }
}

#[test]
fn sweeps_converge_to_friction_without_slip() {
    for costs in [
        &[Cost::Huber, Cost::OneSided][..],
        &[Cost::Pyramid],
        &[Cost::Elliptic],
        &[Cost::Coulomb],
        &ALL_COSTS,
    ] {
        for (scene, problem) in scenes(costs).enumerate() {
            let solver = solve(&problem, 10_000);
            for (k, block) in problem.blocks().enumerate() {
                let slip = leftover(&problem, &solver, k, &block);
                assert!(
                    slip < 1e-5,
                    "{costs:?} scene {scene} block {k} {:?}: {slip:e}",
                    block.cost
                );
            }
        }
    }
}

/// A block of dry friction may have six rows, and its rows may act on the same dofs.
#[test]
fn rows_of_one_block_come_to_rest_together() {
    let mut rng = Rng(11);
    for _ in 0..20 {
        let mut problem = random_problem(&mut rng, &Shape::new(humanoid(), 0));
        let shape = Shape::new(humanoid(), 1);
        push_contacts(&mut rng, &shape, &mut problem, Cost::Huber, 6, 1);
        let solver = solve(&problem, 10_000);
        let slip = leftover(&problem, &solver, 0, &problem.block(0));
        assert!(slip < 1e-5, "{slip:e}");
    }
}

#[test]
fn normal_forces_stay_and_everything_stays_consistent() {
    for problem in scenes(&ALL_COSTS) {
        let (before, after) = (solve(&problem, 0), solve(&problem, 10));
        let mut applied = vec![0.0; problem.nv()];
        for (k, block) in problem.blocks().enumerate() {
            let (old, new) = (&before.force()[block.rows()], &after.force()[block.rows()]);
            match block.cost {
                Cost::Huber => assert!(new[0].abs() <= block.shape[0]),
                Cost::Pyramid | Cost::Elliptic | Cost::Coulomb => assert_eq!(old[0], new[0]),
                _ => assert_eq!(old, new),
            }
            if block.cost == Cost::Pyramid {
                let edges = after.edge_forces(&problem, k);
                assert!(edges.iter().all(|&e| e >= -1e-12 * new[0]));
                assert!((edges.iter().sum::<f64>() - new[0]).abs() <= 1e-12 * new[0]);
            }
            for (i, f) in new.iter().enumerate() {
                for (c, &dof) in block.dofs.iter().enumerate() {
                    applied[dof as usize] += f * block.jacobian[i * block.dofs.len() + c];
                }
            }
        }
        assert!(difference(&applied, after.qfrc_constraint()) < 1e-12);
        // M (a − a_unc) = Jᵀ f.
        let mut moved = vec![0.0; problem.nv()];
        let away: Vec<f64> = after
            .qacc()
            .iter()
            .zip(&problem.qacc_smooth)
            .map(|(a, b)| a - b)
            .collect();
        problem.mass.mul(problem.tree(), &away, &mut moved);
        assert!(difference(&moved, &applied) < 1e-9);
        assert!((1..=10).contains(&after.stats().lane(0).noslip_iterations));
    }
}

#[test]
fn the_tolerance_ends_the_sweeps() {
    let problem = scenes(&[Cost::Pyramid]).next().unwrap();
    let mut solver = Solver::new(problem.tree());
    let settings = options(1000).noslip_tolerance(1e-3).resolve::<f64>();
    let sweeps = solver
        .solve(&problem, &settings, None)
        .unwrap()
        .lane(0)
        .noslip_iterations;
    assert!((1..1000).contains(&sweeps), "{sweeps}");
}
