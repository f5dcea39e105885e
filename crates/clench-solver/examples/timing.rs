//! Times solves of a 23-dof humanoid in contact: `cargo run --release -p clench-solver --example timing`.
//!
//! Each line is a family of 64 random problems, cold-started. Sparse and dense factors are timed in turn.

#[allow(dead_code)] // This program uses only some of what the suite shares.
#[path = "../tests/suite/common/mod.rs"]
mod common;

use clench_math::{Lanes, Real};
use clench_solver::{Cost, Problem, Settings, Solver, SolverOptions, Switch};
use common::{Rng, Shape, humanoid, random_problem};
use std::hint::black_box;
use std::time::Instant;

const PROBLEMS: usize = 64;
const ROUNDS: usize = 60;

fn problems(cost: Cost, dim: usize, contacts: usize, cross: f64) -> Vec<Problem<f64>> {
    let mut rng = Rng(contacts as u64 * 31 + dim as u64);
    let mut shape = Shape::new(humanoid(), 0);
    shape.cross = cross;
    shape.stiffness = (50.0, 500.0);
    (0..PROBLEMS)
        .map(|_| {
            let mut problem = random_problem(&mut rng, &shape);
            common::push_contacts(&mut rng, &shape, &mut problem, cost, dim, contacts);
            problem
        })
        .collect()
}

/// Returns the microseconds per solve in the fastest round, and the iterations per solve.
fn time<T: Real>(problems: &[Problem<T>], settings: &Settings) -> (f64, f64) {
    let mut solver = Solver::new(problems[0].tree());
    let mut best = f64::INFINITY;
    let mut iterations = 0;
    for _ in 0..ROUNDS {
        iterations = 0;
        let start = Instant::now();
        for problem in problems {
            if let Ok(stats) = solver.solve(black_box(problem), settings, None) {
                iterations += (0..T::LANES)
                    .map(|lane| stats.lane(lane).iterations)
                    .max()
                    .unwrap_or(0);
            }
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    (
        best * 1e6 / problems.len() as f64,
        iterations as f64 / problems.len() as f64,
    )
}

/// Returns a problem with the same numbers in every lane.
fn widen(problem: &Problem<f64>) -> Problem<Lanes<f64, 8>> {
    let mut wide: Problem<Lanes<f64, 8>> = Problem::new(problem.tree().clone());
    let splat = |to: &mut [Lanes<f64, 8>], from: &[f64]| {
        to.iter_mut()
            .zip(from)
            .for_each(|(to, &from)| *to = Lanes::splat(from));
    };
    splat(&mut wide.mass.values, &problem.mass.values);
    splat(&mut wide.qacc_smooth, &problem.qacc_smooth);
    wide.factor_mass();
    for block in problem.blocks() {
        let to = wide.push(block.cost, block.dim, block.dofs);
        splat(to.jacobian, block.jacobian);
        splat(to.aref, block.aref);
        splat(to.r, block.r);
        splat(to.d, block.d);
        splat(to.shape, block.shape);
    }
    wide
}

fn main() {
    println!(
        "cost       dim contacts cross  iterations   sparse µs  /iteration    dense µs  /iteration   8 lanes, each"
    );
    for (cost, dim) in [
        (Cost::Pyramid, 3),
        (Cost::Elliptic, 3),
        (Cost::OneSided, 1),
        (Cost::Pyramid, 6),
    ] {
        for (contacts, cross) in [(4, 0.0), (10, 0.0), (10, 0.2)] {
            let problems = problems(cost, dim, contacts, cross);
            let settings = |sparse| SolverOptions::new().sparse_solve(sparse).resolve::<f64>();
            let (sparse, iterations) = time(&problems, &settings(Switch::On));
            let (dense, _) = time(&problems, &settings(Switch::Off));
            let wide: Vec<_> = problems.iter().map(widen).collect();
            let (lanes, _) = time(&wide, &settings(Switch::On));
            println!(
                "{:<10} {dim:>3} {contacts:>8} {cross:>5} {iterations:>11.2} {sparse:>11.2} {:>11.2} {dense:>11.2} {:>11.2} {:>15.2}",
                format!("{cost:?}"),
                sparse / iterations,
                dense / iterations,
                lanes / 8.0,
            );
        }
    }
}
