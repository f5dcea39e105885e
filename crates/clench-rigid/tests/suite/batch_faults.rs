//! An environment that fails keeps its last good state and reports why; others are unaffected.

use crate::batches::*;
use clench_math::Instructions;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::{Integrator, JointKind};
use clench_rigid::options::{MaxContacts, RigidOptions};
use clench_rigid::{Batch, EnvStatus, Fault, Precision, Sim, SimError, State};

/// The fields that are poisoned.
const FIELDS: [&str; 7] = [
    "qpos",
    "qvel",
    "ctrl",
    "qfrc_applied",
    "xfrc_applied",
    "qacc_warmstart",
    "time",
];

/// Draws an integer below `n`.
fn draw(numbers: &mut Numbers, n: usize) -> usize {
    ((numbers.next() + 1.0) * 0.5 * n as f64) as usize % n
}

/// Returns the numbers of a field of an environment, except for its time.
fn row<'a, S: Precision>(batch: &'a mut Batch<S>, field: &str, env: usize) -> &'a mut [S] {
    let rows = &mut batch.state;
    match field {
        "time" => &mut [],
        "qpos" => rows.qpos.row_mut(env),
        "qvel" => rows.qvel.row_mut(env),
        "ctrl" => rows.ctrl.row_mut(env),
        "qfrc_applied" => rows.qfrc_applied.row_mut(env),
        "xfrc_applied" => rows.xfrc_applied.row_mut(env),
        _ => rows.qacc_warmstart.row_mut(env),
    }
}

/// Writes a number into a field of an environment, at an index that `choose` picks.
fn put<S: Precision>(
    batch: &mut Batch<S>,
    field: &str,
    env: usize,
    poison: f64,
    choose: impl FnOnce(usize) -> usize,
) {
    match row(batch, field, env) {
        [] => batch.state.time.row_mut(env)[0] = poison,
        target => target[choose(target.len())] = S::new(poison),
    }
}

/// Compares the result of a step of a single simulation with the status of a row. The first number found to diverge
/// depends on the slots that lanes share and is not compared.
fn assert_verdict(alone: Result<(), SimError>, together: EnvStatus) {
    match (alone, together) {
        (Ok(()), EnvStatus::Running) => {}
        (
            Err(SimError::Fault(Fault::Diverged { time: expected, .. })),
            EnvStatus::Failed(Fault::Diverged { time: found, .. }),
        ) => assert_eq!(found, expected),
        (Err(SimError::Fault(expected)), EnvStatus::Failed(found)) => {
            assert_eq!(found.to_string(), expected.to_string());
        }
        (alone, together) => panic!("{together:?}, alone {alone:?}"),
    }
}

/// Steps a batch and a simulation for each environment, poisons, repairs and resets environments at random, and checks
/// that they do not affect each other.
fn soak<S: Precision>(
    builder: &ModelBuilder,
    instructions: Instructions,
    threads: usize,
    steps: usize,
) {
    let (model, options) = (model(builder), RigidOptions::new());
    let envs: Vec<usize> = (0..37).collect();
    let mut batch = batch::<S>(&model, &envs, with(instructions, threads, options));
    let mut alone: Vec<Sim<S>> = envs.iter().map(|&e| alone(&model, options, e)).collect();
    let mut numbers = Numbers(7);
    let (mut refused, mut diverged) = (0, 0);
    for step in 0..steps {
        drive(&mut batch, &envs, step);
        let env = draw(&mut numbers, envs.len());
        let field = FIELDS[draw(&mut numbers, FIELDS.len())];
        // Non-finite numbers are refused; huge ones may make the step diverge.
        let poison = [f64::NAN, f64::INFINITY, 0.1 * S::MAX.to_f64()][draw(&mut numbers, 3)];
        put(&mut batch, field, env, poison, |n| draw(&mut numbers, n));
        let mut poisoned = batch.sim(env).expect("it exists");
        batch.step().expect("valid");
        for (other, sim) in alone.iter_mut().enumerate() {
            drive_alone(sim, other, step);
            if other != env {
                sim.step().expect("finite");
                assert_eq!(batch.status(other), EnvStatus::Running);
                assert_state(&batch, other, &sim.state, &|| format!("step {step}"));
            }
        }
        assert_verdict(poisoned.step(), batch.status(env));
        if let EnvStatus::Failed(fault) = batch.status(env) {
            refused += usize::from(matches!(fault, Fault::NotFinite { .. }));
            diverged += usize::from(matches!(fault, Fault::Diverged { .. }));
        }
        if draw(&mut numbers, 2) == 0 {
            batch.reset(env).expect("it exists");
            alone[env].reset();
        } else {
            // Repaired by hand, from the last good state.
            mend(&mut batch, env, &alone[env].state);
            batch.revive(env).expect("it exists");
        }
        assert_state(&batch, env, &alone[env].state, &|| format!("step {step}"));
    }
    assert!(refused > steps / 2, "{refused} refused");
    assert!(diverged > steps / 20, "{diverged} diverged");
}

/// Writes a state into the rows of an environment.
fn mend<S: Precision>(batch: &mut Batch<S>, env: usize, state: &State<S>) {
    let rows = &mut batch.state;
    rows.time.row_mut(env)[0] = state.time;
    rows.qpos.row_mut(env).copy_from_slice(&state.qpos);
    rows.qvel.row_mut(env).copy_from_slice(&state.qvel);
    rows.ctrl.row_mut(env).copy_from_slice(&state.ctrl);
    (rows.qfrc_applied.row_mut(env)).copy_from_slice(&state.qfrc_applied);
    (rows.qacc_warmstart.row_mut(env)).copy_from_slice(&state.qacc_warmstart);
    rows.xfrc_applied.row_mut(env).fill(S::ZERO);
}

#[test]
fn poison_stays_where_it_is() {
    for (i, instructions) in Instructions::all_available::<f64>().enumerate() {
        soak::<f64>(&walker(), instructions, 1 + i % 3, 150);
    }
    soak::<f32>(&walker(), Instructions::widest(), 2, 150);
}

#[test]
fn a_poisoned_environment_with_islands_disturbs_no_other() {
    for instructions in Instructions::all_available::<f64>() {
        soak::<f64>(&loose_parts(), instructions, 1, 150);
    }
    soak::<f32>(&loose_parts(), Instructions::widest(), 2, 150);
}

#[test]
fn a_fault_equals_that_of_a_single_simulation() {
    let (model, options) = (model(&loose_parts()), RigidOptions::new());
    let envs: Vec<usize> = (0..FIELDS.len() * 3).collect();
    let wide = with(Instructions::widest(), 1, options);
    let mut batch = batch::<f64>(&model, &envs, wide);
    for &env in &envs {
        let poison = [f64::NAN, f64::NEG_INFINITY, 1e308][env / FIELDS.len()];
        let field = FIELDS[env % FIELDS.len()];
        put(&mut batch, field, env, poison, |n| n - 1);
    }
    let mut alone: Vec<Sim> = envs.iter().map(|&e| batch.sim(e).expect("valid")).collect();
    let summary = batch.step().expect("valid");
    let mut expected_failures = 0;
    for (env, sim) in alone.iter_mut().enumerate() {
        let verdict = sim.step();
        expected_failures += usize::from(verdict.is_err());
        assert_verdict(verdict, batch.status(env));
    }
    assert!(expected_failures >= 12, "{expected_failures}");
    assert_eq!(summary.failed, expected_failures);
    assert_eq!(summary.running, envs.len() - expected_failures);
    assert_eq!(batch.step().expect("valid").failed, 0, "told once");
}

#[test]
fn a_failure_on_the_way_keeps_the_last_good_state() {
    // A spring too stiff for the time step: each environment diverges at another step of the call.
    let mut b = world();
    let mut spring = joint(JointKind::Slide, "spring", [1.0, 0.0, 0.0]);
    spring.stiffness[0] = 1.7e6;
    add(&mut b, 0, "mass", [0.0; 3], vec![spring], vec![sphere(0.1)]);
    let model = model(&b);
    let options = with(Instructions::widest(), 1, RigidOptions::new());
    let mut batch = Batch::<f64>::with_options(model.clone(), 13, options).expect("valid");
    let mut alone: Vec<Sim> = Vec::new();
    for env in 0..13 {
        batch.state.qpos.row_mut(env)[0] = 10_f64.powf(0.7 * env as f64 - 4.0);
        alone.push(batch.sim(env).expect("valid"));
    }
    let summary = batch.step_n(500).expect("valid");
    assert_eq!((summary.failed, summary.running), (13, 0));
    let mut times = Vec::new();
    for (env, sim) in alone.iter_mut().enumerate() {
        let error = (0..500)
            .find_map(|_| sim.step().err())
            .expect("it diverges");
        let EnvStatus::Failed(fault) = batch.status(env) else {
            panic!("environment {env} runs");
        };
        assert_eq!(SimError::from(fault).to_string(), error.to_string());
        assert_state(&batch, env, &sim.state, &|| "last good".into());
        times.push(sim.state.time);
    }
    assert!(times.windows(2).all(|t| t[0] > t[1]), "{times:?}");
}

#[test]
fn too_many_contacts_are_a_fault_of_those_that_have_them() {
    let model = model(&loose_parts());
    let limit = RigidOptions::new().max_contacts(MaxContacts::Limit(5));
    let envs: Vec<usize> = (0..19).collect();
    let mut batch = batch::<f64>(&model, &envs, with(Instructions::widest(), 2, limit));
    let mut alone: Vec<Sim> = envs.iter().map(|&e| alone(&model, limit, e)).collect();
    let mut stopped = vec![false; envs.len()];
    for step in 0..300 {
        batch.step().expect("valid");
        for (env, sim) in alone.iter_mut().enumerate() {
            if stopped[env] {
                continue;
            }
            let before = sim.state.clone();
            sim.step().expect("finite");
            let end = if sim.contact_overflow() {
                stopped[env] = true;
                let time = before.time;
                let fault = Fault::ContactOverflow { time, limit: 5 };
                assert_eq!(batch.status(env), EnvStatus::Failed(fault));
                &before
            } else {
                assert_eq!(batch.status(env), EnvStatus::Running);
                &sim.state
            };
            assert_state(&batch, env, end, &|| format!("step {step}"));
        }
    }
    let count = stopped.iter().filter(|&&s| s).count();
    assert!((1..19).contains(&count), "{count} stopped");
}

#[test]
fn a_massless_dof_is_a_fault() {
    let model = model(&loose_parts());
    let options = with(Instructions::widest(), 1, RigidOptions::new());
    let mut batch = batch::<f64>(&model, &[0, 1, 2], options);
    let (nbody, small) = (model.nbody(), 5e-324);
    let (masses, moments) = (vec![small; nbody], vec![small; 3 * nbody]);
    batch
        .randomize("body_mass", &[1], &masses)
        .expect("positive");
    batch
        .randomize("body_inertia", &[1], &moments)
        .expect("positive");
    batch.step().expect("valid");
    let EnvStatus::Failed(Fault::Singular { time: 0.0, place }) = batch.status(1) else {
        panic!("{:?}", batch.status(1));
    };
    let place = place.expect("a joint");
    let joint = model.joints.last().expect("some");
    assert!(place.contains(&model.bodies[joint.body].name), "{place}");
    assert_eq!(batch.status(0), EnvStatus::Running);
    assert_eq!(batch.status(2), EnvStatus::Running);
}

/// Contacts that a Runge–Kutta stage omits are missing from the step, even if the last stage omits none.
#[test]
fn too_many_contacts_in_any_stage_are_a_fault() {
    let mut b = world();
    b.physics.integrator = Integrator::Rk4;
    b.bodies[0].geoms.push(plane());
    for (name, x) in [("one", 0.0), ("two", 1.0)] {
        add(&mut b, 0, name, [x, 0.0, 0.0999], free(), vec![sphere(0.1)]);
    }
    let model = model(&b);
    let limit = RigidOptions::new().max_contacts(MaxContacts::Limit(1));
    let wide = with(Instructions::widest(), 1, limit);
    let mut batch = Batch::<f64>::with_options(model, 3, wide).expect("valid");
    // Both leave the floor within half a step.
    batch.state.qvel.row_mut(1)[2] = 10.0;
    batch.state.qvel.row_mut(1)[8] = 10.0;
    // One has left it already.
    batch.state.qpos.row_mut(2)[2] = 1.0;
    let mut alone = batch.sim(1).expect("valid");
    alone.step().expect("finite");
    assert!(alone.contact_overflow());
    batch.step().expect("valid");
    let fault = Fault::ContactOverflow {
        time: 0.0,
        limit: 1,
    };
    assert_eq!(batch.status(0), EnvStatus::Failed(fault.clone()));
    assert_eq!(batch.status(1), EnvStatus::Failed(fault));
    assert_eq!(batch.status(2), EnvStatus::Running);
    assert_eq!(batch.state.qpos.row(1)[2], 0.0999, "as before the step");
}

#[test]
fn failed_environments_do_not_count_in_the_quality() {
    let model = model(&loose_parts());
    let envs: Vec<usize> = (0..5).collect();
    let quality = |poison: Option<f64>| {
        let wide = with(Instructions::widest(), 1, RigidOptions::new());
        let mut batch = batch::<f64>(&model, &envs, wide);
        if let Some(poison) = poison {
            batch.state.qvel.row_mut(4).fill(poison);
        } else {
            batch.state.qvel.row_mut(4)[0] = f64::NAN;
        }
        batch.step().expect("valid");
        assert!(matches!(batch.status(4), EnvStatus::Failed(_)));
        batch.quality()
    };
    let (refused, diverged) = (quality(None), quality(Some(1e300)));
    assert_eq!(diverged, refused);
}

/// Writes through a pointer can leave bytes other than 0 and 1 in switches.
#[test]
fn a_switch_is_on_for_any_nonzero_byte() {
    let model = model(&everything());
    let envs: Vec<usize> = (0..21).collect();
    for instructions in Instructions::all_available::<f64>() {
        let end = |on: u8| {
            let options = with(instructions, 1, RigidOptions::new());
            let mut batch = batch::<f64>(&model, &envs, options);
            let switches = batch.state.eq_active.row_mut(3);
            assert!(!switches.is_empty());
            switches.fill(on);
            assert_eq!(batch.step_n(5).expect("valid").failed, 0);
            let one = batch.sim(3).expect("it exists").state.eq_active;
            (batch.state.qpos.as_slice().to_vec(), one)
        };
        let [off, on, odd, all] = [0, 1, 2, 255].map(end);
        assert_ne!(off, on);
        assert_eq!(odd, on, "{instructions:?}");
        assert_eq!(all, on, "{instructions:?}");
    }
}
