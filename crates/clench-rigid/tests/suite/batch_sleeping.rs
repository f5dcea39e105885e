//! Environments of a batch sleep independently, equal to single simulations to the bit.

use crate::batches::*;
use clench_math::{Instructions, Real};
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::SleepPolicy;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions, EnvStatus, Precision, Sim};

const ENVS: usize = 19;

/// Builds boxes that fall from different heights and come to rest, singly or stacked, and one that starts asleep.
fn clutter() -> ModelBuilder {
    let mut b = world();
    b.physics.flags.sleep = true;
    b.physics.timestep = 0.004;
    b.options = RigidOptions::new();
    b.bodies[0].geoms.push(plane());
    for (k, x) in [0.0, 0.0, 0.6, 1.2].into_iter().enumerate() {
        let pos = [x, 0.0, 0.1 + 0.21 * (k % 2) as f64];
        add(&mut b, 0, "", pos, free(), vec![cuboid([0.1; 3])]);
    }
    b.bodies[3].sleep = SleepPolicy::Init;
    b
}

/// Disturbs environment `env` before a step: throws it at the start, and pushes it twice at times of its own.
fn disturb<S: Precision>(env: usize, step: usize, qvel: &mut [S], qfrc_applied: &mut [S]) {
    if step == 0 {
        let mut numbers = Numbers(env as u64 + 1);
        for v in &mut qvel[..6 * (env % 3)] {
            *v = S::new(0.3 * numbers.next());
        }
    }
    if step == 120 + 7 * env && env.is_multiple_of(2) {
        qvel[12 + env % 3] = S::new(0.2);
    }
    qfrc_applied[18] = S::new(if step == 150 + 3 * env { -0.0 } else { 0.0 });
}

fn compare<S: Precision>(steps: usize, outputs: &[&str]) {
    let model = model(&clutter());
    let mut asleep = 0;
    let alone: Vec<Sim<S>> = (0..ENVS)
        .map(|env| {
            let mut sim: Sim<S> = Sim::new(model.clone()).expect("valid");
            for step in 0..steps {
                disturb(env, step, &mut sim.state.qvel, &mut sim.state.qfrc_applied);
                sim.step().expect("finite");
                asleep += sim
                    .state
                    .tree_asleep
                    .iter()
                    .filter(|&&x| Real::ge(x, S::ZERO))
                    .count();
            }
            sim
        })
        .collect();
    let most = ENVS * steps * model.ntree();
    assert!(
        asleep > most / 5 && asleep < 9 * most / 10,
        "{asleep} of {most}: nothing to compare"
    );
    for (i, instructions) in Instructions::all_available::<S>().enumerate() {
        let options = with(instructions, 1 + i % 3, RigidOptions::new());
        let mut batch: Batch<S> = Batch::with_options(model.clone(), ENVS, options).expect("valid");
        batch.record(outputs).expect("there");
        for step in 0..steps {
            for env in 0..ENVS {
                let qfrc_applied = &mut batch.state.qfrc_applied;
                disturb(
                    env,
                    step,
                    batch.state.qvel.row_mut(env),
                    qfrc_applied.row_mut(env),
                );
            }
            batch.step().expect("valid");
        }
        for (env, sim) in alone.iter().enumerate() {
            assert_eq!(batch.status(env), EnvStatus::Running);
            assert_state(&batch, env, &sim.state, &|| format!("{instructions:?}"));
        }
    }
}

#[test]
fn lanes_sleep_as_alone() {
    compare::<f64>(400, &[]);
    compare::<f32>(400, &[]);
}

#[test]
fn lanes_sleep_as_alone_with_any_recorded_outputs() {
    compare::<f64>(400, &["xpos", "qacc", "contact_count"]);
}

/// Recorded outputs of sleeping environments equal those of single simulations.
#[test]
fn outputs_of_sleeping_bodies_are_valid() {
    let model = model(&clutter());
    let outputs = [
        "xpos",
        "geom_xmat",
        "cvel",
        "qacc",
        "qfrc_bias",
        "subtree_com",
        "cinert",
    ];
    let mut batch: Batch = Batch::new(model.clone(), 9).expect("valid");
    batch.record(&outputs).expect("there");
    for _ in 0..40 {
        batch.step_n(7).expect("valid");
        for env in 0..9 {
            let mut sim = Sim::new(model.clone()).expect("valid");
            batch.state.read(env, &mut sim.state).expect("there");
            batch.forward().expect("valid");
            sim.forward().expect("finite");
            for name in outputs {
                let found = batch.output(name).expect("recorded").row(env);
                assert_bits(found, &sim.output(name).expect("there"), &|| name.into());
            }
        }
    }
    assert!(
        batch
            .state
            .tree_asleep
            .as_slice()
            .iter()
            .all(|&tree| tree >= 0)
    );
}

#[test]
fn a_reset_environment_sleeps_as_it_began() {
    let model = model(&clutter());
    let mut batch: Batch =
        Batch::with_options(model.clone(), 5, BatchOptions::default()).expect("valid");
    let begun = batch.state.tree_asleep.row(0).to_vec();
    assert_eq!(begun, [-10, -10, 2, -10]);
    let saved = batch.save().expect("room");
    batch.step_n(300).expect("valid");
    assert_ne!(batch.state.tree_asleep.row(3), begun);
    let other = batch.state.tree_asleep.row(2).to_vec();
    batch.reset(3).expect("there");
    assert_eq!(batch.state.tree_asleep.row(3), begun);
    assert_eq!(batch.state.tree_asleep.row(2), other);
    batch.restore(&saved).expect("fits");
    assert_eq!(batch.state.tree_asleep.row(2), begun);
}
