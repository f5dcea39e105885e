//! Sharing a solve among threads changes no bit of the result.

use crate::common::*;
use clench_solver::{Solver, SolverOptions, Threads};

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut rng = Rng(11);
    let crews = [2, 3, 5].map(|count| Threads::new(count).expect("threads start"));
    let settings = SolverOptions::new().resolve::<f64>();
    let (mut several, mut large) = (0, 0);
    for k in 0..40 {
        let shape = Shape::heap(30, if k % 2 == 0 { 25 } else { 90 });
        let problem = random_problem(&mut rng, &shape);
        let mut alone = Solver::new(problem.tree());
        alone.solve(&problem, &settings, None).expect("well-formed");
        let stats = alone.stats().lane(0);
        several += u32::from(stats.islands > 2);
        large += u32::from(stats.islands == 1 && stats.factorizations > 0);
        for crew in &crews {
            let mut shared = Solver::new(problem.tree());
            shared.set_threads(crew.clone());
            // The second solve reuses the memory of the first.
            for _ in 0..2 {
                shared
                    .solve(&problem, &settings, None)
                    .expect("well-formed");
                assert_eq!(shared.qacc(), alone.qacc(), "scene {k}, {}", crew.count());
                assert_eq!(shared.force(), alone.force());
                assert_eq!(shared.stats().lane(0), stats);
            }
        }
    }
    assert!(
        several >= 10 && large >= 10,
        "{several} scenes of islands, {large} of one"
    );
}
