//! A batch on a device: rows are uploaded and downloaded, outputs are the device's, and faults are reported as on the
//! processor.

use crate::common::{self, Random, own, random_state, text};
use clench_gpu::GpuBatch;
use clench_rigid::batch::{Controls, EnvStatus};
use clench_rigid::model::Model;
use clench_rigid::options::{MaxContacts, RigidOptions};
use clench_rigid::{Batch, BatchOptions, Fault, State};
use std::sync::Arc;

const COUNT: usize = 40;

/// Returns a batch on the device in random states, and a `GpuBatch` in the same states; `None` if there is no device.
fn both(model: &Arc<Model>) -> Option<(Batch<f32>, GpuBatch)> {
    let mut alone = common::batch(model, COUNT)?;
    let mut batch =
        clench_gpu::batch(model.clone(), COUNT, BatchOptions::default(), None).expect("a device");
    let mut random = Random::new(5);
    let states = Vec::from_iter((0..COUNT).map(|_| random_state(model, &mut random, 0.3)));
    for (env, state) in states.iter().enumerate() {
        batch.state.write(env, state).expect("a row");
    }
    common::upload(&mut alone, &states);
    Some((batch, alone))
}

/// Asserts bitwise equality.
fn assert_bits(found: &[f32], expected: &[f32], what: &str) {
    let same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits();
    assert_eq!(found.len(), expected.len(), "{what}");
    let wrong = found.iter().zip(expected).position(|pair| !same(pair));
    assert_eq!(wrong, None, "{what}: the first number that differs");
}

#[test]
fn rows_and_outputs_are_those_of_the_device() {
    let implicit = own("medley").replace("<option ", "<option integrator=\"implicitfast\" ");
    let model = text(&implicit);
    let Some((mut batch, mut alone)) = both(&model) else {
        return;
    };
    let outputs = ["xpos", "qacc", "geom_xmat", "qfrc_bias", "contact_count"];
    batch.record(&outputs).expect("the device computes them");
    for steps in [1, 7] {
        let summary = batch.step_n(steps).expect("a device");
        assert_eq!(summary.running, COUNT);
        alone.step(steps).expect("a device");
    }
    for (name, rows) in [
        ("qpos", &batch.state.qpos),
        ("qvel", &batch.state.qvel),
        ("qacc_warmstart", &batch.state.qacc_warmstart),
    ] {
        let expected = alone.read(name).expect("a device");
        assert_bits(rows.as_slice(), &expected, name);
    }
    for name in &outputs[..4] {
        let found = batch.output(name).expect("it is kept").as_slice();
        assert_bits(found, &alone.read(name).expect("a device"), name);
    }
    let contacts = batch.output("contact_count").expect("it is kept");
    let solves = alone.solves().expect("a device");
    let expected = Vec::from_iter(solves.iter().map(|solve| solve.contacts as f32));
    assert_eq!(contacts.as_slice(), expected);
    let time = 8.0 * model.params.timestep;
    assert!((batch.state.time.row(3)[0] - time).abs() < 1e-8);
}

#[test]
fn a_reset_environment_restarts_and_the_others_continue() {
    let model = text(&own("runner"));
    let Some((mut batch, mut alone)) = both(&model) else {
        return;
    };
    batch.step_n(4).expect("a device");
    alone.step(4).expect("a device");
    batch.reset(9).expect("an environment");
    alone.reset_envs(&[9]).expect("a device");
    batch.state.ctrl.row_mut(9).fill(0.4);
    alone
        .write_env(9, "ctrl", &vec![0.4; model.nu()])
        .expect("a device");
    batch.step_n(5).expect("a device");
    alone.step(5).expect("a device");
    let expected = alone.read("qpos").expect("a device");
    assert_bits(batch.state.qpos.as_slice(), &expected, "qpos");
    let time = 5.0 * model.params.timestep;
    assert!((batch.state.time.row(9)[0] - time).abs() < 1e-8);
}

#[test]
fn a_rollout_records_the_results_of_steps() {
    let model = text(&own("runner"));
    let Some((mut batch, mut alone)) = both(&model) else {
        return;
    };
    let nu = model.nu();
    let ctrl = Vec::from_iter((0..COUNT * 6 * nu).map(|i| (0.7 * i as f32).sin()));
    let recording = batch
        .rollout(6, Controls::Each(&ctrl), &["qpos", "site_xpos"])
        .expect("good controls");
    let rows = recording.get("qpos").expect("it is recorded");
    for step in 0..6 {
        let row = |env: usize| ctrl[(env * 6 + step) * nu..][..nu].to_vec();
        let now = Vec::from_iter((0..COUNT).flat_map(row));
        alone.write("ctrl", &now).expect("a device");
        alone.step(1).expect("a device");
        let qpos = alone.read("qpos").expect("a device");
        for env in 0..COUNT {
            let nq = model.nq;
            let found = &rows.row(env)[step * nq..][..nq];
            let what = format!("step {step}, environment {env}");
            assert_bits(found, &qpos[env * nq..][..nq], &what);
        }
    }
}

#[test]
fn a_diverged_environment_is_named_and_disturbs_no_other() {
    let model = text(&own("runner"));
    let Some((mut batch, _)) = both(&model) else {
        return;
    };
    let before = State::<f32>::clone(&batch.sim(17).expect("an environment").state);
    batch.state.qfrc_applied.row_mut(17)[1] = 1e30;
    batch.state.qvel.row_mut(23)[2] = f32::NAN;
    let summary = batch.step_n(3).expect("a device");
    assert_eq!((summary.failed, summary.running), (2, COUNT - 2));
    let EnvStatus::Failed(Fault::Diverged {
        field,
        index,
        place,
        ..
    }) = batch.status(17)
    else {
        panic!("{:?}", batch.status(17));
    };
    assert_eq!((field, index), ("qacc", 0));
    assert!(place.is_some_and(|place| place.contains("forward")));
    assert!(matches!(
        batch.status(23),
        EnvStatus::Failed(Fault::NotFinite {
            field: "qvel",
            index: 2,
            ..
        })
    ));
    assert_eq!(
        batch.state.qpos.row(17),
        before.qpos,
        "it keeps its last good state"
    );
    batch.state.qfrc_applied.row_mut(17).fill(0.0);
    batch.revive(17).expect("an environment");
    batch.reset(23).expect("an environment");
    assert_eq!(batch.step_n(3).expect("a device").running, COUNT);
}

#[test]
fn a_forward_pass_reports_faults() {
    let model = text(&own("runner"));
    let Some((mut batch, _)) = both(&model) else {
        return;
    };
    batch.state.qfrc_applied.row_mut(2)[1] = 1e30;
    let before = batch.state.qpos.as_slice().to_vec();
    assert_eq!(batch.forward().expect("a device").failed, 1);
    assert!(matches!(
        batch.status(2),
        EnvStatus::Failed(Fault::Diverged { .. })
    ));
    assert_bits(batch.state.qpos.as_slice(), &before, "qpos");
}

#[test]
fn the_pool_is_told() {
    let model = text(&own("runner"));
    let options = BatchOptions {
        options: RigidOptions::new().max_contacts(MaxContacts::Limit(1)),
        ..BatchOptions::default()
    };
    let Some(mut batch) = common::stepped::<f32>(&model, 2, options) else {
        return;
    };
    batch.state.qpos.row_mut(1)[1] = -0.55;
    batch.step().expect("a device");
    let full = Fault::ContactOverflow {
        time: 0.0,
        limit: 1,
    };
    assert_eq!(
        batch.statuses(),
        [EnvStatus::Running, EnvStatus::Failed(full)]
    );
    // Queries are computed from the rows.
    let jacobian = batch.subtree_jacobian(1).expect("a body");
    assert!(jacobian.row(0).iter().all(|x| x.is_finite()));
}

#[test]
fn environments_have_parameters_of_their_own() {
    let implicit = own("medley").replace("<option ", "<option integrator=\"implicitfast\" ");
    let model = text(&implicit);
    let Some((mut device, _)) = both(&model) else {
        return;
    };
    let mut processor = Batch::with_options(model.clone(), COUNT, BatchOptions::default());
    let processor = processor.as_mut().expect("a good model");
    processor
        .restore(&device.save().expect("rows"))
        .expect("the same model");
    let start = device.save().expect("rows");
    let envs = [3, 8, 21];
    let mut random = Random::new(9);
    for field in [
        "body_mass",
        "geom_friction",
        "gravity",
        "dof_damping",
        "actuator_gear",
        "jnt_range",
    ] {
        let mut values = Vec::new();
        for _ in envs {
            let row = processor.param(field, 0).expect("a field").into_iter();
            values.extend(row.map(|x| x * (1.0 + 0.3 * random.signed() as f32)));
        }
        for batch in [&mut device, &mut *processor] {
            batch.randomize(field, &envs, &values).expect("good values");
        }
    }
    let mut plain = clench_gpu::batch(model.clone(), COUNT, BatchOptions::default(), None);
    let plain = plain.as_mut().expect("a device");
    plain.restore(&start).expect("the same model");
    for batch in [&mut device, &mut *processor, &mut *plain] {
        assert_eq!(batch.step_n(3).expect("good states").running, COUNT);
    }
    for env in 0..COUNT {
        let (found, without) = (device.state.qvel.row(env), plain.state.qvel.row(env));
        if !envs.contains(&env) {
            assert_bits(found, without, "one that has the model's");
            continue;
        }
        let gap = |other: &[f32]| {
            let gaps = found.iter().zip(other).map(|(a, b)| (a - b).abs());
            gaps.fold(0.0, f32::max)
        };
        let (here, there) = (gap(processor.state.qvel.row(env)), gap(without));
        assert!(here < 0.02 * there, "environment {env}: {here} and {there}");
    }
    // A reset of an environment does not change them.
    let masses = device.param("body_mass", 8).expect("masses");
    device.reset(8).expect("an environment");
    assert_eq!(device.param("body_mass", 8).expect("masses"), masses);
}

#[test]
fn parameters_that_would_make_other_kernels_are_refused() {
    let model = text(&own("runner"));
    let Some((mut batch, _)) = both(&model) else {
        return;
    };
    let mut stiffness = batch.param("jnt_stiffness", 0).expect("a field");
    let before = stiffness.clone();
    stiffness[0] = 4.0;
    let error = batch.randomize("jnt_stiffness", &[2], &stiffness);
    let error = error
        .expect_err("a spring where there was none")
        .to_string();
    assert!(
        error.contains("its kernels are compiled for them"),
        "{error}"
    );
    assert_eq!(batch.param("jnt_stiffness", 2).expect("a field"), before);
}

#[test]
fn constants_follow_the_parameters_of_environments() {
    let model = text(&own("runner"));
    let Some((mut device, _)) = both(&model) else {
        return;
    };
    let mut processor = Batch::with_options(model.clone(), COUNT, BatchOptions::default());
    let processor = processor.as_mut().expect("a good model");
    let start = device.save().expect("rows");
    processor.restore(&start).expect("the same model");
    let envs = [3, 20];
    let mut before = Vec::new();
    for batch in [&mut device, processor] {
        before = batch.param("dof_invweight0", 3).expect("a field");
        for field in ["body_mass", "body_inertia"] {
            let row = batch.param(field, 0).expect("a field");
            let row = Vec::from_iter(row.into_iter().map(|x| 3.0 * x));
            batch
                .randomize(field, &envs, &row.repeat(2))
                .expect("good values");
        }
        batch.set_constants(&envs).expect("a good mass matrix");
        batch.step_n(5).expect("good states");
    }
    let weights = device.param("dof_invweight0", 20).expect("a field");
    assert!(weights[0] < 0.5 * before[0], "{weights:?} {before:?}");
    for env in 0..COUNT {
        let pairs = device
            .state
            .qvel
            .row(env)
            .iter()
            .zip(processor.state.qvel.row(env));
        let gap = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(gap < 1e-2, "environment {env}: {gap}");
    }
}
