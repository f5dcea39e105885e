//! A motion that diverges is a fault that names the joint, or resets if the options say so.

use crate::batches::*;
use clench_math::Instructions;
use clench_rigid::builder::{ModelBuilder, Origin};
use clench_rigid::model::{Integrator, JointKind};
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, EnvStatus, Fault, Precision, Sim, SimError};
use std::sync::Arc;

/// Builds two masses on sliders, the second on a spring too stiff for the time step.
fn stiff(integrator: Integrator) -> ModelBuilder {
    let mut b = world();
    b.physics.integrator = integrator;
    for (name, stiffness, y) in [("calm", 10.0, 0.0), ("stiff", 7e6, 5.0)] {
        let mut spring = joint(JointKind::Slide, name, [1.0, 0.0, 0.0]);
        spring.stiffness[0] = stiffness;
        let at = [0.0, y, 0.0];
        add(&mut b, 0, name, at, vec![spring], vec![sphere(0.1)]);
    }
    let origin = Origin {
        file: "machine.xml".into(),
        line: 12,
    };
    b.bodies[2].joints[0].origin = Some(origin);
    b.bodies[2].joints[0].name = "wobbler".into();
    b
}

#[test]
fn a_motion_beyond_the_bounds_is_a_fault_that_names_the_joint() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Rk4,
    ] {
        let mut sim = Sim::<f64>::new(model(&stiff(integrator))).expect("valid");
        sim.state.qpos[1] = 1e-3;
        let fault = loop {
            let before = sim.state.clone();
            match sim.step() {
                Ok(()) => {
                    let motion = sim.state.qpos.iter().chain(&sim.state.qvel);
                    let all = motion.chain(&sim.workspace().qacc);
                    assert!(all.into_iter().all(|x| x.abs() <= 1e10));
                }
                Err(SimError::Fault(fault)) => {
                    assert_eq!(sim.state.qpos, before.qpos);
                    break fault;
                }
                Err(error) => panic!("{error}"),
            }
        };
        let text = fault.to_string();
        assert!(
            text.contains(
                "at joint \"wobbler\" of body \"stiff\" (machine.xml:12); a shorter timestep"
            ),
            "{text}"
        );
        let Fault::Diverged { index, value, .. } = fault else {
            panic!("{text}");
        };
        assert!(value.is_finite() && value.abs() > 1e10, "{text}");
        assert_eq!(index, 1);
    }
}

#[test]
fn a_position_or_velocity_beyond_the_bounds_is_not_stepped_from() {
    let model = model(&stiff(Integrator::Euler));
    for (qpos, qvel, field) in [(1e10, 1e11, "qvel"), (-1.1e10, 0.0, "qpos")] {
        let mut sim = Sim::<f64>::new(model.clone()).expect("valid");
        sim.state.qpos[0] = qpos;
        sim.state.qvel[0] = qvel;
        let error = sim.forward().expect_err("too far").to_string();
        assert!(error.contains(&format!("{field}[0] became")), "{error}");
        assert!(error.contains("joint \"calm\""), "{error}");
    }
}

/// Steps a batch and a simulation for each environment, with and without controls of rollouts.
fn begins_anew<S: Precision>(instructions: Instructions, threads: usize) {
    let model = model(&stiff(Integrator::Euler));
    let options = RigidOptions::new().autoreset(true);
    let wide = with(instructions, threads, options);
    let mut batch = Batch::<S>::with_options(Arc::clone(&model), 13, wide).expect("valid");
    let mut alone = Vec::new();
    for env in 0..13 {
        // Some are at rest, and some diverge sooner than others.
        let push = if env % 4 == 0 { 0.0 } else { 1e-4 * env as f64 };
        batch.state.qpos.row_mut(env)[1] = S::new(push);
        batch.state.qfrc_applied.row_mut(env)[0] = S::new(1.0);
        alone.push(batch.sim(env).expect("valid"));
    }
    for call in 0..4 {
        let summary = batch.step_n(17).expect("valid");
        assert_eq!((summary.failed, summary.running), (0, 13));
        for (env, sim) in alone.iter_mut().enumerate() {
            (0..17).for_each(|_| sim.step().expect("it goes on"));
            assert_state(&batch, env, &sim.state, &|| format!("call {call}"));
            assert_eq!(batch.resets()[env], sim.resets());
        }
    }
    for (env, &resets) in batch.resets().iter().enumerate() {
        assert_eq!(resets, u64::from(env % 4 != 0), "environment {env}");
        // A reset clears the forces that a user applied.
        let force = batch.state.qfrc_applied.row(env)[0].to_f64();
        assert_eq!(force, if env % 4 == 0 { 1.0 } else { 0.0 });
    }
}

#[test]
fn with_autoreset_an_environment_restarts_without_effect_on_its_neighbours() {
    for (i, instructions) in Instructions::all_available::<f64>().enumerate() {
        begins_anew::<f64>(instructions, 1 + i % 3);
    }
    begins_anew::<f32>(Instructions::widest(), 2);
}

#[test]
fn with_autoreset_a_failure_from_the_initial_state_is_a_fault() {
    let mut b = stiff(Integrator::Euler);
    b.bodies[2].joints[0].springref = 1e6;
    let model = model(&b);
    let options = with(
        Instructions::widest(),
        1,
        RigidOptions::new().autoreset(true),
    );
    let mut batch = Batch::<f64>::with_options(model, 3, options).expect("valid");
    let mut alone = batch.sim(0).expect("valid");
    let summary = batch.step().expect("valid");
    assert_eq!((summary.failed, summary.resets), (3, 0));
    let EnvStatus::Failed(fault) = batch.status(0) else {
        panic!("it runs");
    };
    assert_eq!(alone.step(), Err(SimError::Fault(fault)));
}

/// A forward pass is of the state that a user wrote, and retains it.
#[test]
fn with_autoreset_a_forward_pass_that_fails_resets_nothing() {
    let options = RigidOptions::new().autoreset(true);
    let model = model(&stiff(Integrator::Euler));
    let wide = with(Instructions::widest(), 1, options);
    let mut batch = Batch::<f64>::with_options(model, 3, wide).expect("valid");
    batch.step_n(3).expect("valid");
    batch.state.qpos.row_mut(1)[0] = 0.5;
    batch.state.qfrc_applied.row_mut(1)[0] = 1e15;
    let mut alone = batch.sim(1).expect("valid");
    let before = alone.state.clone();
    let summary = batch.forward().expect("valid");
    assert_eq!((summary.failed, summary.resets), (1, 0));
    assert_state(&batch, 1, &before, &|| "batch".into());
    let error = alone.forward().expect_err("it diverges");
    assert_eq!((&alone.state, alone.resets()), (&before, 0));
    let EnvStatus::Failed(fault) = batch.status(1) else {
        panic!("it runs");
    };
    assert_eq!(error, SimError::Fault(fault));
}

/// An input that is not finite, before the first half of a step or between the halves, resets as in a whole step.
#[test]
fn with_autoreset_halves_of_a_step_restart_as_a_whole_step() {
    let model = model(&stiff(Integrator::Euler));
    for before in [true, false] {
        let options = RigidOptions::new().autoreset(true);
        let mut sim = Sim::<f64>::with_options(model.clone(), options).expect("valid");
        let mut whole = Sim::<f64>::with_options(model.clone(), options).expect("valid");
        for sim in [&mut sim, &mut whole] {
            sim.state.qpos[0] = 0.1;
            sim.step().expect("valid");
        }
        let spoil = |sim: &mut Sim<f64>| match before {
            true => sim.state.qpos[0] = f64::NAN,
            false => sim.state.qfrc_applied[0] = f64::NAN,
        };
        spoil(&mut whole);
        whole.step().expect("it goes on");
        if before {
            spoil(&mut sim);
        }
        sim.step1().expect("it goes on");
        if !before {
            spoil(&mut sim);
        }
        sim.step2().expect("it goes on");
        assert_eq!((sim.resets(), &sim.state), (whole.resets(), &whole.state));
    }
}

/// After 3 × 10⁷ steps of 1/1024 s, the last digit of a single-precision clock is 1/512 s.
#[test]
fn the_clock_is_exact_in_single_precision() {
    let mut b = world();
    b.physics.timestep = 1.0 / 1024.0;
    let mut sim = Sim::<f32>::new(model(&b)).expect("valid");
    sim.state.time = 30_000.0;
    for _ in 0..1024 {
        sim.step().expect("nothing moves");
    }
    assert_eq!(sim.state.time, 30_001.0);
    let options = with(Instructions::widest(), 1, RigidOptions::new());
    let mut batch = Batch::<f32>::with_options(model(&b), 3, options).expect("valid");
    batch.state.time.as_mut_slice().fill(30_000.0);
    batch.step_n(1024).expect("valid");
    assert_eq!(batch.state.time.as_slice(), [30_001.0; 3]);
}
