//! Opposing forces cancel, and leave rounding of single precision in place of a slope or a gradient.

use crate::common::*;
use clench_math::{Real, Scalar};
use clench_solver::{Cost, LaneStats, PlainBlock, Problem, Solver, SolverOptions};

/// A problem of clamped bodies: the two rows of each pair push against each other, with forces thousands of times as
/// large as their sum.
struct Clamped {
    mass: Vec<f64>,
    qacc_smooth: Vec<f64>,
    /// J, aref and R of each row.
    rows: Vec<(Vec<f64>, f64, f64)>,
}

impl Clamped {
    fn new(rng: &mut Rng) -> Self {
        let nv = 2 + rng.below(5);
        let mut mass = vec![0.0; nv * nv];
        for i in 0..nv {
            mass[i * nv + i] = rng.scale(0.1, 10.0);
        }
        let mut rows = Vec::new();
        for _ in 0..3 + rng.below(6) {
            let j: Vec<f64> = (0..nv).map(|_| rng.range(-1.0, 1.0)).collect();
            let against = j.iter().map(|j| -j).collect();
            let (aref, r) = (rng.scale(1e3, 1e5), rng.scale(0.1, 1.0));
            rows.push((j, aref, r));
            rows.push((against, aref * rng.range(0.5, 1.0), r));
        }
        Clamped {
            mass,
            qacc_smooth: (0..nv).map(|_| rng.range(-10.0, 10.0)).collect(),
            rows,
        }
    }

    fn solve<T: Real>(&self) -> (Vec<f64>, LaneStats) {
        let all = |x: &[f64]| x.iter().map(|&x| T::new(x)).collect::<Vec<T>>();
        let row = |(j, aref, r): &(Vec<f64>, f64, f64)| PlainBlock {
            cost: Cost::OneSided,
            jacobian: all(j),
            aref: all(&[*aref]),
            r: all(&[*r]),
            shape: Vec::new(),
        };
        let blocks: Vec<_> = self.rows.iter().map(row).collect();
        let problem = Problem::from_arrays(&all(&self.mass), &all(&self.qacc_smooth), &blocks);
        let problem = problem.unwrap();
        let mut solver = Solver::new(problem.tree());
        let settings = SolverOptions::new().resolve::<T>();
        let stats = solver.solve(&problem, &settings, None).unwrap().lane(0);
        let qacc = solver.qacc().iter().map(|a| a.lane(0).to_f64()).collect();
        (qacc, stats)
    }
}

#[test]
fn a_solve_ends_where_nothing_but_rounding_is_left() {
    let mut rng = Rng(3);
    let (mut single, mut double, mut evaluations) = (0, 0, 0);
    for k in 0..300 {
        let clamped = Clamped::new(&mut rng);
        let (expected, exact) = clamped.solve::<f64>();
        let (found, stats) = clamped.solve::<f32>();
        let error = difference(&found, &expected);
        assert!(error < 5e-5, "problem {k}: {error:e} {stats:?}");
        single += stats.iterations;
        double += exact.iterations;
        evaluations += stats.ls_evaluations;
    }
    assert!(single <= double + double / 10, "{single} {double}");
    assert!(evaluations <= 2 * single, "{evaluations} {single}");
}
