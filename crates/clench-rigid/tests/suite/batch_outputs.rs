//! Outputs of a batch equal those of single simulations; rollouts equal steps.

use crate::batches::*;
use clench_math::{Instructions, Vec3};
use clench_rigid::batch::Divergence;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::Integrator;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Batch, BatchOptions, EnvStatus, Output, Precision, Sim, SimError};

fn names() -> Vec<&'static str> {
    Output::ALL.iter().map(|output| output.name()).collect()
}

/// Compares every output of a batch with single simulations, after each step and a forward.
fn compare<S: Precision>(builder: &ModelBuilder, instructions: Instructions, steps: usize) {
    let (model, options) = (model(builder), RigidOptions::new());
    let envs: Vec<usize> = (0..11).collect();
    let mut batch = batch::<S>(&model, &envs, with(instructions, 1, options));
    let mut alone: Vec<Sim<S>> = envs.iter().map(|&e| alone(&model, options, e)).collect();
    batch.record(&names()).expect("known");
    let assert_same = |batch: &Batch<S>, alone: &mut [Sim<S>], step: usize| {
        for name in names() {
            let rows = batch.output(name).expect("it is kept");
            for (env, sim) in alone.iter_mut().enumerate() {
                let expected = sim.output(name).expect("known");
                let what = || format!("{name} of {env}, step {step}, {instructions:?}");
                assert_bits(rows.row(env), &expected, &what);
            }
        }
    };
    for step in 0..steps {
        drive(&mut batch, &envs, step);
        for (env, sim) in alone.iter_mut().enumerate() {
            drive_alone(sim, env, step);
            sim.step().expect("finite");
        }
        batch.step().expect("valid");
        assert_same(&batch, &mut alone, step);
    }
    batch.forward().expect("valid");
    alone
        .iter_mut()
        .for_each(|sim| sim.forward().expect("finite"));
    assert_same(&batch, &mut alone, steps);
}

#[test]
fn outputs_are_those_of_simulations() {
    for instructions in Instructions::all_available::<f64>() {
        compare::<f64>(&loose_parts(), instructions, 40);
    }
    for integrator in [Integrator::Euler, Integrator::Rk4] {
        let mut constraints = everything();
        constraints.options = RigidOptions::new();
        constraints.physics.integrator = integrator;
        compare::<f64>(&constraints, Instructions::widest(), 20);
        compare::<f64>(&crate::machines::everything(), Instructions::widest(), 20);
    }
    compare::<f32>(&walker(), Instructions::widest(), 100);
}

#[test]
fn shapes_are_those_of_the_model() {
    let model = model(&everything());
    let mut sim = Sim::<f64>::new(model.clone()).expect("valid");
    sim.forward().expect("finite");
    for &output in Output::ALL {
        let shape = output.shape(&model);
        let values = sim.output(output.name()).expect("known");
        assert_eq!(shape.iter().product::<usize>(), values.len(), "{output:?}");
        assert_eq!(output.width(&model), values.len());
        assert_eq!(Output::find(output.name()), Ok(output));
    }
    let (nbody, nv) = (model.nbody(), model.nv);
    for (output, shape) in [
        (Output::time, vec![]),
        (Output::energy, vec![2]),
        (Output::qacc, vec![nv]),
        (Output::cdof, vec![nv, 6]),
        (Output::cinert, vec![nbody, 10]),
    ] {
        assert_eq!(output.shape(&model), shape);
    }
}

#[test]
fn a_masked_forward_leaves_the_others_alone() {
    let model = model(&everything());
    let envs: Vec<usize> = (0..21).collect();
    let options = with(Instructions::widest(), 3, RigidOptions::new());
    let [mut masked, mut whole] = [0, 1].map(|_| {
        let mut batch = batch::<f64>(&model, &envs, options);
        batch.record(&names()).expect("known");
        batch.state.time.row_mut(9)[0] = f64::NAN;
        batch.step_n(3).expect("valid");
        batch
    });
    let kept = |batch: &Batch<f64>, name: &str, env: usize| {
        let rows = batch.output(name).expect("kept");
        rows.row(env).to_vec()
    };
    let before: Vec<_> = (names().iter())
        .map(|name| Vec::from_iter(envs.iter().map(|&env| kept(&masked, name, env))))
        .collect();
    let mask: Vec<bool> = envs.iter().map(|env| env % 3 == 0 || *env == 7).collect();
    masked.clear_figures();
    let summary = masked.forward_mask(&mask).expect("as long");
    assert_eq!((summary.failed, summary.running), (0, 20));
    assert_eq!(
        masked.divergence().env_steps,
        7,
        "eight, of which one failed"
    );
    whole.forward().expect("valid");
    let mut changed = 0;
    for (name, before) in names().iter().zip(&before) {
        for &env in &envs {
            let found = kept(&masked, name, env);
            if mask[env] && env != 9 {
                let expected = kept(&whole, name, env);
                assert_bits(&found, &expected, &|| format!("{name} of {env}"));
                changed += usize::from(found != before[env]);
            } else {
                assert_bits(&found, &before[env], &|| format!("{name} of {env}"));
            }
        }
    }
    assert!(changed > 7 * 10, "most outputs follow the state");
    for &env in &envs {
        let expected = whole.sim(env).expect("it exists").state;
        assert_state(&masked, env, &expected, &|| "states stay".into());
    }
    // Only a requested environment can fail.
    masked.state.qvel.row_mut(3)[0] = f64::NAN;
    masked.state.qvel.row_mut(4)[0] = f64::NAN;
    let summary = masked.forward_mask(&mask).expect("as long");
    assert_eq!((summary.failed, summary.running), (1, 19));
    assert_eq!(masked.status(4), EnvStatus::Running);
    for length in [0, 20, 22] {
        let error = masked.forward_mask(&vec![true; length]);
        assert!(matches!(
            error,
            Err(SimError::WrongLength { field: "mask", .. })
        ));
    }
}

#[test]
fn contact_forces_carry_bodies_at_rest() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let model = model(&loose_parts());
        let options = with(
            Instructions::widest(),
            1,
            RigidOptions::new().friction_cone(cone),
        );
        let mut batch = Batch::<f64>::with_options(model.clone(), 3, options).expect("valid");
        batch
            .record(&["contact_force", "cfrc_ext", "contact_count"])
            .expect("known");
        batch.step_n(3000).expect("valid");
        for env in 0..3 {
            let forces = batch.output("contact_force").expect("kept").row(env);
            let external = batch.output("cfrc_ext").expect("kept").row(env);
            let (mut total, mut weight) = (Vec3::ZERO, 0.0);
            for b in 1..model.nbody() {
                total += Vec3::from_slice(&forces[6 * b..]);
                weight += model.params.body_mass[b] * G;
                // The same force, about another point.
                for axis in 0..3 {
                    assert!((forces[6 * b + axis] - external[6 * b + 3 + axis]).abs() < 1e-9);
                }
            }
            assert!(
                (total.z - weight).abs() < 1e-3 * weight,
                "{} for {weight}",
                total.z
            );
            assert!(total.x.hypot(total.y) < 1e-3 * weight);
            let floor = Vec3::from_slice(forces);
            assert!((floor + total).norm() < 1e-9, "action and reaction");
            assert!(batch.output("contact_count").expect("kept").row(env)[0] >= 7.0);
        }
    }
}

#[test]
fn applied_forces_and_loops_count_as_external() {
    // A weld holds a box against a push. Both together balance gravity.
    let mut builder = loose_parts();
    builder.equalities[0].active = true;
    let model = model(&builder);
    let mut batch = Batch::<f64>::new(model.clone(), 2).expect("valid");
    let b = model.body("box").expect("it exists");
    let push = [1.0, 2.0, 3.0, 0.1, 0.2, -0.1];
    batch.state.xfrc_applied.row_mut(1)[6 * b..][..6].copy_from_slice(&push);
    batch
        .record(&["cfrc_ext", "xipos", "subtree_com"])
        .expect("known");
    batch.step_n(2000).expect("valid");
    let weight = model.params.body_mass[b] * G;
    for env in 0..2 {
        let force = &batch.output("cfrc_ext").expect("kept").row(env)[6 * b..][..6];
        for (axis, expected) in [0.0, 0.0, weight].into_iter().enumerate() {
            assert!(
                (force[3 + axis] - expected).abs() < 1e-6,
                "{env}: {force:?}"
            );
        }
    }
}

#[test]
fn forces_on_bodies_come_and_go() {
    let (model, options) = (model(&loose_parts()), RigidOptions::new());
    let envs: Vec<usize> = (0..11).collect();
    for instructions in Instructions::all_available::<f64>() {
        let mut batch = batch::<f64>(&model, &envs, with(instructions, 1, options));
        let mut alone: Vec<Sim> = envs.iter().map(|&e| alone(&model, options, e)).collect();
        batch.record(&["cfrc_ext"]).expect("known");
        // No push, a push, a negative zero, no push.
        for (step, push) in [0.0, 3.0, -0.0, 0.0].into_iter().enumerate() {
            for (env, sim) in alone.iter_mut().enumerate() {
                let push = if env % 2 == 0 { push } else { 0.0 };
                batch.state.xfrc_applied.row_mut(env)[8] = push;
                sim.state.xfrc_applied[1].linear.z = push;
                sim.step().expect("finite");
            }
            batch.step().expect("valid");
            for (env, sim) in alone.iter_mut().enumerate() {
                let what = || format!("environment {env}, step {step}, {instructions:?}");
                assert_state(&batch, env, &sim.state, &what);
                let found = batch.output("cfrc_ext").expect("kept").row(env);
                assert_bits(found, &sim.output("cfrc_ext").expect("known"), &what);
            }
        }
    }
}

#[test]
fn the_recorded_outputs_can_change() {
    let mut batch = Batch::<f64>::new(model(&walker()), 4).expect("valid");
    batch.record(&["xpos", "qacc"]).expect("known");
    let place = batch.output("xpos").expect("kept").as_slice().as_ptr();
    assert!((place as usize).is_multiple_of(64), "aligned");
    batch.record(&["cvel", "xpos", "xpos"]).expect("known");
    assert_eq!(
        batch.output("xpos").expect("kept").as_slice().as_ptr(),
        place
    );
    assert!(batch.output("qacc").is_none() && batch.output("cvel").is_some());
    let error = batch
        .record(&["xpos", "contact_forces"])
        .expect_err("unknown");
    assert_eq!(
        error.to_string(),
        "there is no output \"contact_forces\"; did you mean \"contact_force\"?"
    );
    assert!(batch.output("cvel").is_some(), "as before");
}

#[test]
fn divergence_counts_the_work_of_environments() {
    let (model, options) = (model(&walker()), RigidOptions::new());
    let envs: Vec<usize> = (0..40).collect();
    let mut alone: Vec<Sim> = envs.iter().map(|&e| alone(&model, options, e)).collect();
    let (mut iterations, mut contacts) = (0, 0);
    let mut together = [false, true].map(|grouping| {
        let options = BatchOptions {
            grouping,
            ..with(Instructions::widest(), 1, options)
        };
        batch::<f64>(&model, &envs, options)
    });
    for step in 0..300 {
        for (env, sim) in alone.iter_mut().enumerate() {
            drive_alone(sim, env, step);
            sim.step().expect("finite");
            iterations += sim.stats().iterations as u64;
            contacts += sim.contacts().len() as u64;
        }
        for batch in &mut together {
            drive(batch, &envs, step);
            batch.step().expect("valid");
        }
    }
    let lanes = together[0].lanes() as u64;
    for figures in together.each_ref().map(Batch::divergence) {
        assert_eq!(figures.env_steps, 300 * 40);
        assert_eq!(figures.group_steps, 300 * 40_u64.div_ceil(lanes));
        assert_eq!(figures.lane_steps, lanes * figures.group_steps);
        assert_eq!(
            (figures.env_iterations, figures.contacts),
            (iterations, contacts)
        );
        assert!(figures.group_iterations <= iterations && figures.live_share() <= 1.0);
        assert!(figures.contact_slots <= contacts, "slots are shared");
        assert!(figures.slots_per_group() >= figures.contacts_per_env());
    }
    let [apart, grouped] = together.each_ref().map(|b| b.divergence().contact_slots);
    assert!(
        lanes == 1 || grouped < apart,
        "{grouped} slots, ungrouped {apart}"
    );
    together[0].clear_figures();
    assert_eq!(together[0].divergence(), Divergence::default());
}

#[test]
fn newly_recorded_outputs_are_of_the_present_state() {
    let model = model(&walker());
    let envs: Vec<usize> = (0..11).collect();
    let wide = with(Instructions::widest(), 2, RigidOptions::new());
    let mut batch = batch::<f64>(&model, &envs, wide);
    for record in [["site_xpos", "cvel"], ["xpos", "cvel"]] {
        batch.record(&record).expect("known");
        for env in 0..11 {
            let mut sim = batch.sim(env).expect("it exists");
            for name in record {
                let found = batch.output(name).expect("kept").row(env);
                let expected = sim.output(name).expect("known");
                assert_bits(found, &expected, &|| format!("{name} of {env}"));
            }
        }
    }
    // Outputs recorded before keep the values of the last step.
    batch.step().expect("valid");
    let before = batch.output("xpos").expect("kept").as_slice().to_vec();
    let figures = (batch.divergence(), batch.quality());
    batch.record(&["xpos", "subtree_com"]).expect("known");
    batch.refresh().expect("valid");
    assert_eq!(batch.output("xpos").expect("kept").as_slice(), before);
    assert_eq!((batch.divergence(), batch.quality()), figures);
    let mut sim = batch.sim(3).expect("it exists");
    let found = batch.output("subtree_com").expect("kept").row(3);
    assert_bits(found, &sim.output("subtree_com").expect("known"), &|| {
        "of the present".into()
    });
}

#[test]
fn refreshed_outputs_follow_the_written_state() {
    let model = model(&walker());
    let envs: Vec<usize> = (0..23).collect();
    let wide = with(Instructions::widest(), 2, RigidOptions::new());
    let mut batch = batch::<f64>(&model, &envs, wide);
    let names = ["xpos", "qacc", "cvel", "energy"];
    batch.record(&names).expect("known");
    batch.step_n(30).expect("valid");
    let table = |batch: &Batch, name: &str| batch.output(name).expect("kept").as_slice().to_vec();
    let before = names.map(|name| table(&batch, name));
    batch.refresh().expect("valid");
    assert_eq!(names.map(|name| table(&batch, name)), before, "of the step");
    // A written state, a reset, own parameters, and an invalid state.
    batch.state.qpos.row_mut(3)[2] += 1.0;
    batch.state.qvel.row_mut(4)[5] = 2.0;
    batch.reset(5).expect("it exists");
    let masses = batch.param("body_mass", 6).expect("known");
    batch.randomize("body_mass", &[6], &masses).expect("valid");
    batch.state.qpos.row_mut(7)[0] = f64::NAN;
    batch.refresh().expect("valid");
    assert_eq!(batch.status(7), EnvStatus::Running, "nobody notices");
    for env in 0..23 {
        for (name, before) in names.iter().zip(&before) {
            let rows = batch.output(name).expect("kept");
            let found = rows.row(env);
            if (3..=6).contains(&env) {
                let mut sim = batch.sim(env).expect("it exists");
                let expected = sim.output(name).expect("known");
                assert_bits(found, &expected, &|| format!("{name} of {env}"));
            } else {
                let width = rows.width();
                assert_eq!(found, &before[env * width..][..width], "{name} of {env}");
            }
        }
    }
    assert_eq!(batch.step().expect("valid").failed, 1);
}
