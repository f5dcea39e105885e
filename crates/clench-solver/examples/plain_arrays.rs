//! Solves a problem given as plain arrays, without bodies: `cargo run -p clench-solver --example plain_arrays`.
//!
//! Gravity pushes two coupled coordinates down. A soft limit keeps the acceleration of the first above −2, dry friction
//! of at most 3 acts along the second, and a soft equality pulls their difference towards zero.

use clench_solver::{Cost, PlainBlock, Problem, Solver, SolverOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mass = [2.0, 0.3, 0.3, 1.0];
    let unconstrained = [-9.81, -9.81];
    let blocks = [
        PlainBlock {
            cost: Cost::OneSided,
            jacobian: vec![1.0, 0.0],
            aref: vec![-2.0],
            r: vec![0.01],
            ..Default::default()
        },
        PlainBlock {
            cost: Cost::Huber,
            jacobian: vec![0.0, 1.0],
            aref: vec![0.0],
            r: vec![0.1],
            shape: vec![3.0],
        },
        PlainBlock {
            jacobian: vec![1.0, -1.0],
            aref: vec![0.0],
            r: vec![0.5],
            ..Default::default()
        },
    ];
    let problem = Problem::from_arrays(&mass, &unconstrained, &blocks)?;
    let mut solver = Solver::new(problem.tree());
    let stats = solver
        .solve(&problem, &SolverOptions::new().resolve::<f64>(), None)?
        .lane(0);

    println!("acceleration   {:.6?}", solver.qacc());
    for (block, name) in problem.blocks().zip(["stop", "dry friction", "difference"]) {
        println!("{name:<14} force {:.6?}", &solver.force()[block.rows()]);
    }
    println!(
        "{:?} after {} iterations; cost at most {:.1e} above its minimum",
        stats.status, stats.iterations, stats.gap
    );
    Ok(())
}
