//! Threads that share the steps of one simulation change only its speed.

use crate::common::model;
use crate::scenes::{add, everything, free, heap_of_boxes, shake, sphere};
use clench_rigid::builder::ModelBuilder;
use clench_rigid::{Precision, Sim, SimError};

/// Builds a large island, and balls that are islands of their own.
fn heap_and_balls() -> ModelBuilder {
    let mut builder = heap_of_boxes();
    for i in 0..12 {
        let pos = [-0.5 - 0.3 * f64::from(i), 0.0, 0.099];
        add(&mut builder, 0, "", pos, free(), vec![sphere(0.1)]);
    }
    builder
}

/// Returns the positions and contact counts of some steps with `threads` threads.
fn run<T: Precision>(builder: &ModelBuilder, threads: usize) -> Vec<(Vec<T>, usize)> {
    let mut sim = Sim::<T>::new(model(builder)).expect("valid");
    sim.set_threads(threads).expect("threads start");
    assert_eq!(sim.threads(), threads);
    (0..25)
        .map(|step| {
            match step % 2 {
                0 => sim.step(),
                _ => sim.step1().and_then(|()| sim.step2()),
            }
            .expect("the motion stays finite");
            (sim.state.qpos.clone(), sim.contacts().len())
        })
        .collect()
}

#[test]
fn a_heap_moves_to_the_bit_as_on_one_thread() {
    let builder = heap_and_balls();
    let alone = run::<f64>(&builder, 1);
    assert!(alone.iter().all(|(_, contacts)| *contacts > 300));
    for threads in [2, 3, 8] {
        assert!(run::<f64>(&builder, threads) == alone, "{threads} threads");
    }
    assert!(run::<f32>(&builder, 2) == run::<f32>(&builder, 1));
}

#[test]
fn every_kind_of_constraint_moves_to_the_bit_as_on_one_thread() {
    let step = |threads| {
        let mut sim = Sim::<f64>::new(model(&everything())).expect("valid");
        sim.set_threads(threads).expect("threads start");
        shake(&mut sim, 4);
        (0..50).for_each(|_| sim.step().expect("the motion stays finite"));
        (sim.state.qpos, sim.state.qvel)
    };
    assert_eq!(step(1), step(3));
}

#[test]
fn no_threads_and_too_many_are_errors() {
    let mut sim = Sim::<f64>::new(model(&heap_and_balls())).expect("valid");
    for count in [0, 1025, usize::MAX] {
        let refused = sim.set_threads(count);
        assert!(
            matches!(refused, Err(SimError::OutOfRange { .. })),
            "{count}"
        );
    }
    assert_eq!(sim.threads(), 1);
    sim.step().expect("it steps on");
}
