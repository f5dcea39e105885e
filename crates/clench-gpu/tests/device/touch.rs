//! Sensors of distances from terrain, of enclosure and of skins, in both precisions: as outputs and with delays.

use crate::common::{self, Random, own, random_state, text};
use clench_gpu::GpuReal;
use clench_rigid::model::{Model, Sensor};
use clench_rigid::{Batch, BatchOptions};
use std::sync::Arc;

const COUNT: usize = 16;

/// Returns the difference of a sensor in each environment, relative to its largest number.
fn differences<S: GpuReal>(sensor: &Sensor, [device, processor]: &[Batch<S>; 2]) -> Vec<f64> {
    let rows = [device, processor].map(|batch| batch.output("sensordata").expect("recorded"));
    let number = |k: usize, env: usize, i: usize| rows[k].row(env)[i].to_f64();
    let all = |env: usize| sensor.numbers.clone().map(move |i| (env, i));
    let size = |(env, i)| number(1, env, i).abs();
    let scale = (0..COUNT).flat_map(all).map(size).fold(1e-6, f64::max);
    let gap = |(env, i)| (number(0, env, i) - number(1, env, i)).abs();
    let far = |env: usize| all(env).map(gap).fold(0.0, f64::max);
    (0..COUNT).map(|env| far(env) / scale).collect()
}

/// Asserts that every sensor of random states is the processor's, after a forward pass and after steps, except in
/// `strays` states, and that each differs between states.
fn agree<S: GpuReal>(file: &str, tolerance: f64, strays: usize) {
    let model: Arc<Model> = text(file);
    let options = BatchOptions::default();
    let Some(device) = common::stepped::<S>(&model, COUNT, options) else {
        return;
    };
    let processor = Batch::with_options(model.clone(), COUNT, options).expect("a good model");
    let mut batches = [device, processor];
    let mut random = Random::new(3);
    for env in 0..COUNT {
        let state = common::convert::<S>(&model, &random_state(&model, &mut random, 0.4));
        for batch in &mut batches {
            batch.state.write(env, &state).expect("a row");
        }
    }
    for steps in [0, 1, 4] {
        for batch in &mut batches {
            batch.record(&["sensordata"]).expect("all are read");
            let summary = match steps {
                0 => batch.forward(),
                _ => batch.step_n(steps),
            };
            let running = summary.expect("good states").running;
            assert_eq!(running, COUNT, "{:?}", batch.status(0));
        }
        let mut wrong = Vec::new();
        for sensor in &model.sensors {
            let mut far = differences(sensor, &batches);
            far.sort_by(f64::total_cmp);
            if far[COUNT - 1 - strays] > tolerance {
                let (kind, far) = (sensor.kind.name(), far[COUNT - 1]);
                wrong.push(format!("{kind} of {:?}: {far:.1e}", sensor.target));
            }
        }
        assert!(wrong.is_empty(), "after {steps} steps: {wrong:#?}");
    }
    let rows = batches[1].output("sensordata").expect("recorded");
    for sensor in &model.sensors {
        let differs = |i: usize| (1..COUNT).any(|env| rows.row(env)[i] != rows.row(0)[i]);
        let varies = sensor.numbers.clone().any(differs);
        assert!(varies, "{:?} is constant", sensor.target);
    }
}

/// In single precision the direction of a short distance is uncertain.
#[test]
fn distances_from_terrain() {
    agree::<f32>(&own("distances"), 1e-3, 2);
    agree::<f64>(&own("distances"), 1e-6, 0);
}

/// A search for protrusions ends at a tolerance, here that of double precision.
#[test]
fn skins_and_enclosure() {
    agree::<f32>(&own("touched"), 2e-4, 0);
    let exact = "<option ccd_tolerance='1e-12' ccd_iterations='300' ";
    agree::<f64>(&own("touched").replace("<option ", exact), 1e-9, 0);
}
