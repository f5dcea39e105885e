//! Automatic resets on a device, as on the processor: in calls of one step and of many, and in rollouts.

use crate::common::{self, text};
use clench_rigid::batch::Controls;
use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions};
use std::sync::Arc;

const COUNT: usize = 5;

/// Returns a model of a sled with a swing, which only gravity of 1e12 m/s² breaks.
fn sled(gravity: &str) -> Arc<Model> {
    text(&format!(
        "<mujoco>
           <option timestep='0.01' gravity='0 0 {gravity}'/>
           <worldbody>
             <body><joint name='x' type='slide' axis='1 0 0'/><geom size='0.1'/>
               <body pos='0 0 -0.5'><joint name='swing' axis='0 1 0' damping='0.1'/><geom size='0.05' pos='0.05 0 -0.2'/></body>
             </body>
           </worldbody>
           <actuator><motor joint='swing'/></actuator>
           <sensor><clock/></sensor>
         </mujoco>"
    ))
}

fn options() -> BatchOptions {
    BatchOptions {
        options: RigidOptions::new().autoreset(true),
        ..BatchOptions::default()
    }
}

/// Returns a batch on the device and one on the processor; `None` without a device.
fn both(model: &Arc<Model>) -> Option<[Batch<f64>; 2]> {
    let device = common::general_stepped(model, COUNT, options())?;
    let processor = Batch::with_options(model.clone(), COUNT, options()).expect("a good model");
    Some([device, processor])
}

/// Lets the first environments run away after three, four and many steps, with a control and a force.
fn run_away(batch: &mut Batch<f64>) {
    for (env, start) in [(0, 9.9e9), (1, 9.85e9), (2, 9.5e9)] {
        batch.state.qpos.row_mut(env)[0] = start;
        batch.state.qvel.row_mut(env)[0] = 4e9;
    }
    for env in 0..COUNT {
        batch.state.ctrl.row_mut(env)[0] = 0.2;
        batch.state.qfrc_applied.row_mut(env)[1] = 0.1;
    }
}

fn assert_same([device, processor]: &[Batch<f64>; 2], what: &str) {
    assert_eq!(device.resets(), processor.resets(), "{what}");
    assert_eq!(device.statuses(), processor.statuses(), "{what}");
    assert_eq!(
        device.state.time.as_slice(),
        processor.state.time.as_slice()
    );
    for (name, found, expected) in [
        ("qpos", &device.state.qpos, &processor.state.qpos),
        ("qvel", &device.state.qvel, &processor.state.qvel),
        ("ctrl", &device.state.ctrl, &processor.state.ctrl),
        (
            "force",
            &device.state.qfrc_applied,
            &processor.state.qfrc_applied,
        ),
    ] {
        for env in 0..COUNT {
            let pairs = found.row(env).iter().zip(expected.row(env));
            let gap = pairs
                .map(|(a, b)| (a - b).abs() / b.abs().max(1.0))
                .fold(0.0, f64::max);
            // Far away, positions are rounded to a micrometre.
            assert!(gap < 1e-6, "{what}: {name} of environment {env}: {gap:.1e}");
        }
    }
}

#[test]
fn failed_steps_are_repeated_from_the_initial_state() {
    let Some(mut batches) = both(&sled("-9.81")) else {
        return;
    };
    for (calls, steps) in [(1, 40), (2, 7), (5, 1)] {
        for batch in &mut batches {
            batch.record(&["sensordata"]).expect("the clock");
            batch.clear_figures();
            run_away(batch);
            for _ in 0..calls {
                let summary = batch.step_n(steps).expect("a device");
                assert_eq!((summary.failed, summary.running), (0, COUNT));
            }
        }
        let what = format!("{calls} calls of {steps} steps");
        assert_same(&batches, &what);
        let [first, second, ..] = *batches[0].resets() else {
            panic!("{COUNT} environments");
        };
        assert_eq!((first, second), (1, 1), "{what}");
        let clocks = batches
            .each_ref()
            .map(|batch| batch.output("sensordata").expect("recorded"));
        for (found, expected) in clocks[0].as_slice().iter().zip(clocks[1].as_slice()) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{what}: {found} and {expected}"
            );
        }
    }
}

#[test]
fn a_rollout_keeps_its_controls() {
    let Some(mut batches) = both(&sled("-9.81")) else {
        return;
    };
    let ctrl = Vec::from_iter((0..COUNT * 8).map(|i| (0.7 * i as f64).sin()));
    let rows = batches.each_mut().map(|batch| {
        run_away(batch);
        let recording = batch.rollout(8, Controls::Each(&ctrl), &["qpos", "qacc"]);
        recording.expect("good controls")
    });
    assert_same(&batches, "a rollout");
    assert_eq!(batches[0].resets()[..3], [1, 1, 0]);
    for name in ["qpos", "qacc"] {
        let [found, expected] = rows
            .each_ref()
            .map(|rows| rows.get(name).expect("recorded"));
        let pairs = found.as_slice().iter().zip(expected.as_slice());
        let gap = pairs
            .map(|(a, b)| (a - b).abs() / b.abs().max(1.0))
            .fold(0.0, f64::max);
        assert!(gap < 1e-6, "{name}: {gap:.1e}");
    }
}

/// A repetition that fails too stops an environment and is no reset.
#[test]
fn a_bad_initial_state_is_a_fault() {
    let Some(mut batches) = both(&sled("-1e12")) else {
        return;
    };
    for batch in &mut batches {
        let mut gravity = batch.param("gravity", 0).expect("a field");
        gravity[2] = -1.0;
        batch
            .randomize("gravity", &[1, 2, 3, 4], &gravity.repeat(4))
            .expect("good values");
        for env in 0..COUNT {
            batch.state.qpos.row_mut(env)[1] = 0.5;
        }
        let summary = batch.step_n(4).expect("a device");
        assert_eq!(
            (summary.failed, summary.resets, summary.running),
            (1, 0, COUNT - 1)
        );
        assert_eq!(batch.resets(), [0; COUNT]);
    }
}

#[test]
fn a_batch_of_the_device_alone_counts_resets() {
    let model = sled("-9.81");
    let Some([_, mut processor]) = both(&model) else {
        return;
    };
    let batch = common::try_general_batch::<f64>(&model, COUNT, options().options);
    let mut batch = batch.expect("a good model").expect("a device");
    run_away(&mut processor);
    for (name, rows) in [
        ("qpos", &processor.state.qpos),
        ("qvel", &processor.state.qvel),
        ("ctrl", &processor.state.ctrl),
        ("qfrc_applied", &processor.state.qfrc_applied),
    ] {
        batch.write(name, rows.as_slice()).expect("good numbers");
    }
    batch.step(10).expect("a device");
    processor.step_n(10).expect("good states");
    assert_eq!(batch.resets().expect("a device"), [1, 1, 0, 0, 0]);
    assert_eq!(batch.steps().expect("a device"), [8, 7, 10, 10, 10]);
    common::assert_all_run(&batch);
    let qpos = batch.read("qpos").expect("a device");
    let pairs = qpos.iter().zip(processor.state.qpos.as_slice());
    let gap = pairs
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0))
        .fold(0.0, f64::max);
    assert!(gap < 1e-6, "{gap:.1e}");
    batch.reset_envs(&[0]).expect("a device");
    assert_eq!(batch.steps().expect("a device")[0], 0);
}
