#[path = "../tests/common/mod.rs"]
mod common;
use clench_solver::*;
use common::*;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let dense = std::env::args().nth(2).unwrap() == "dense";
    let cost = if std::env::args().nth(3).unwrap() == "e" {
        Cost::Elliptic
    } else {
        Cost::Pyramid
    };
    let mut rng = Rng(n as u64 * 31 + 3);
    let mut shape = Shape::new(humanoid(), 0);
    shape.cross = 0.0;
    shape.stiffness = (50.0, 500.0);
    let ps: Vec<_> = (0..64)
        .map(|_| {
            let mut p = random_problem(&mut rng, &shape);
            push_contacts(&mut rng, &shape, &mut p, cost, 3, n);
            p
        })
        .collect();
    let s = RigidOptions::new()
        .sparse_solve(if dense { Switch::Off } else { Switch::On })
        .resolve::<f64>();
    let mut solver = Solver::new(ps[0].tree());
    let mut it = 0;
    let mut ls = 0;
    let mut f = 0;
    let mut best = f64::MAX;
    for _ in 0..300 {
        let t = std::time::Instant::now();
        for p in &ps {
            let st = solver.solve(p, &s, None).unwrap().lane(0);
            it += st.iterations;
            ls += st.ls_evaluations;
            f += st.factorizations;
        }
        best = best.min(t.elapsed().as_secs_f64());
    }
    println!("best {} us/solve", best * 1e6 / 64.0);
    println!("iterations {it} ls {ls} f {f}");
}
