//! Each environment of a batch moves as a simulation alone, to the bit, however the batch is stepped.

mod scenes;

use clench_math::Instructions;
use clench_rigid::builder::{GeomSpec, ModelBuilder};
use clench_rigid::model::JointKind;
use clench_rigid::{Batch, BatchOptions, Model, Precision, Sim, State};
use clench_solver::RigidOptions;
use scenes::{Numbers, add, cuboid, free, joint, plane, sphere, world};
use std::sync::Arc;

/// A jointed pair, a ball and a box above a floor.
fn loose_parts() -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new().constraint_timeconst(0.0);
    b.bodies[0].geoms.push(plane());
    let base = add(
        &mut b,
        0,
        "base",
        [0.0, 0.0, 0.15],
        free(),
        vec![sphere(0.1)],
    );
    let mut hinge = joint(JointKind::Hinge, "hinge", [0.0, 1.0, 0.0]);
    hinge.range = [-0.6, 0.3];
    hinge.frictionloss = 0.1;
    add(
        &mut b,
        base,
        "link",
        [0.25, 0.0, 0.0],
        vec![hinge],
        vec![sphere(0.08)],
    );
    let rolling = GeomSpec {
        condim: 6,
        ..sphere(0.1)
    };
    add(&mut b, 0, "ball", [0.3, 0.1, 0.3], free(), vec![rolling]);
    add(
        &mut b,
        0,
        "box",
        [-0.3, 0.1, 0.2],
        free(),
        vec![cuboid([0.1, 0.08, 0.06])],
    );
    b
}

/// The initial state of environment `env`: thrown in a direction of its own.
fn throw<S: Precision>(env: usize, qvel: &mut [S]) {
    let mut numbers = Numbers(env as u64);
    for v in qvel {
        *v = S::new(1.5 * numbers.next());
    }
}

fn bits<S: Precision>(values: &[S]) -> Vec<u64> {
    values.iter().map(|x| x.to_f64().to_bits()).collect()
}

/// What simulations alone do: the state of each environment at the end, and its contacts on the way.
fn alone<S: Precision>(
    model: &Arc<Model>,
    options: RigidOptions,
    envs: usize,
    steps: usize,
) -> Vec<State<S>> {
    let mut contacts = 0;
    let states = (0..envs).map(|env| {
        let mut sim = Sim::<S>::with_options(model.clone(), options).expect("valid");
        throw(env, &mut sim.state.qvel);
        for _ in 0..steps {
            sim.step().expect("finite");
            contacts += sim.contacts().len();
        }
        sim.state.clone()
    });
    let states: Vec<_> = states.collect();
    assert!(contacts > envs * steps, "they touch: {contacts}");
    states
}

fn assert_same<S: Precision>(batch: &Batch<S>, expected: &[State<S>], what: &str) {
    for (env, state) in expected.iter().enumerate() {
        for (field, found, expected) in [
            ("qpos", &batch.state.qpos, &state.qpos),
            ("qvel", &batch.state.qvel, &state.qvel),
            ("act", &batch.state.act, &state.act),
            (
                "qacc_warmstart",
                &batch.state.qacc_warmstart,
                &state.qacc_warmstart,
            ),
        ] {
            assert_eq!(
                bits(found.row(env)),
                bits(expected),
                "{what}: {field} of {env}: {:?} alone {expected:?}",
                found.row(env)
            );
        }
        assert_eq!(batch.state.time.row(env)[0].to_f64(), state.time.to_f64());
    }
}

fn compare<S: Precision>(builder: &ModelBuilder, options: RigidOptions, envs: usize, steps: usize) {
    let model = scenes::model(builder);
    let expected = alone::<S>(&model, options, envs, steps);
    for instructions in Instructions::all_available() {
        for threads in [1, 2, 3] {
            let grouping = threads != 2;
            let batch_options = BatchOptions {
                options,
                instructions: Some(instructions),
                threads: Some(threads),
                grouping,
            };
            let mut batch =
                Batch::<S>::with_options(model.clone(), envs, batch_options).expect("valid");
            for env in 0..envs {
                throw(env, batch.state.qvel.row_mut(env));
            }
            for _ in 0..steps {
                let summary = batch.step().expect("valid");
                assert_eq!((summary.failed, summary.running), (0, envs));
            }
            assert_same(
                &batch,
                &expected,
                &format!("{instructions:?}, {threads} threads"),
            );
        }
    }
}

#[test]
fn newton_with_pyramids() {
    compare::<f64>(&loose_parts(), RigidOptions::new(), 11, 300);
}
