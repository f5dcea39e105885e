//! Times the solve of a heap on one and on several threads:
//! `cargo run --release -p clench-solver --example threads -- 8 8 8 2`.
//!
//! The heap is a lattice of free bodies. The first three arguments are the numbers of bodies along x, y and z. Each
//! body touches its neighbours and, in the lowest layer, the world at two points. The last argument is the number of
//! threads.

#[allow(dead_code)] // This program uses only some of what the suite shares.
#[path = "../tests/suite/common/mod.rs"]
mod common;

use clench_solver::{Cost, Problem, Solver, SolverOptions, Threads, Tree, TreeMatrix};
use common::Rng;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const ROUNDS: usize = 20;
const POINTS: usize = 2;

fn heap([nx, ny, nz]: [usize; 3]) -> Result<Problem<f64>, Box<dyn Error>> {
    let nv = 6 * nx * ny * nz;
    let parents = Vec::from_iter((0..nv).map(|dof| (dof % 6 > 0).then(|| dof - 1)));
    let tree = Arc::new(Tree::new(&parents)?);
    let mut problem = Problem::new(tree.clone());
    problem.mass = TreeMatrix::zeros(&tree);
    for dof in 0..nv {
        if let Some(diagonal) = problem.mass.row_mut(&tree, dof).last_mut() {
            *diagonal = 1.0;
        }
    }
    problem.factor_mass();
    let mut random = Rng(1);
    problem
        .qacc_smooth
        .iter_mut()
        .for_each(|a| *a = random.range(-0.5, 0.5));
    let body = |x: usize, y: usize, z: usize| (z * ny + y) * nx + x;
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let neighbors = [
                    (x + 1 < nx).then(|| Some(body(x + 1, y, z))),
                    (y + 1 < ny).then(|| Some(body(x, y + 1, z))),
                    (z + 1 < nz).then(|| Some(body(x, y, z + 1))),
                    (z == 0).then_some(None),
                ];
                for neighbor in neighbors.into_iter().flatten() {
                    touch(&mut problem, &mut random, body(x, y, z), neighbor);
                }
            }
        }
    }
    Ok(problem)
}

/// Adds contacts of a body with a later one or with the world.
fn touch(problem: &mut Problem<f64>, random: &mut Rng, one: usize, other: Option<usize>) {
    let bodies = [Some(one), other].into_iter().flatten();
    let dofs = Vec::from_iter(bodies.flat_map(|body| 6 * body as u32..6 * body as u32 + 6));
    for _ in 0..POINTS {
        let block = problem.push(Cost::Pyramid, 3, &dofs);
        block
            .jacobian
            .iter_mut()
            .for_each(|j| *j = random.range(-0.5, 0.5));
        block.aref[0] = 1.0;
        for i in 0..3 {
            (block.r[i], block.d[i], block.shape[i]) = (0.01, 100.0, 0.7);
        }
    }
}

/// Returns the median time of a solve, ms.
fn time(problem: &Problem<f64>, threads: &Threads) -> Result<f64, Box<dyn Error>> {
    let settings = SolverOptions::new().resolve::<f64>();
    let mut solver = Solver::new(problem.tree());
    solver.set_threads(threads.clone());
    let mut times = Vec::new();
    for _ in 0..=ROUNDS {
        let start = Instant::now();
        threads.run_awake(|| solver.solve(problem, &settings, None).map(|_| ()))?;
        times.push(1e3 * start.elapsed().as_secs_f64());
    }
    // The first solve allocates.
    times.remove(0);
    times.sort_by(f64::total_cmp);
    Ok(times[ROUNDS / 2])
}

fn main() -> Result<(), Box<dyn Error>> {
    let given = std::env::args().skip(1).map(|text| text.parse());
    let given = given.collect::<Result<Vec<usize>, _>>()?;
    let [nx, ny, nz, count] = given[..] else {
        return Err("four numbers are needed: bodies along x, y and z, and threads".into());
    };
    let problem = heap([nx, ny, nz])?;
    let alone = time(&problem, &Threads::default())?;
    let shared = time(&problem, &Threads::new(count)?)?;
    println!(
        "{} bodies, {} contacts: {alone:.1} ms on one thread, {shared:.1} ms on {count}, {:.2} times as fast",
        nx * ny * nz,
        problem.nblock(),
        alone / shared
    );
    Ok(())
}
