//! Tests that every output of a device equals the processor's, after a forward pass and after a step.

use crate::common::{self, Random, difference, own, random_state, text};
use clench_rigid::model::{Model, Sensor};
use clench_rigid::{Batch, BatchOptions, Output};
use std::ops::Range;
use std::sync::Arc;

const COUNT: usize = 60;
/// The rounding error of forces that nearly cancel, relative to the largest.
const TOLERANCE: f64 = 1e-3;

/// Returns this batch and one of the processor in the same random states.
fn both(model: &Arc<Model>, device: Batch<f32>) -> [Batch<f32>; 2] {
    let processor = Batch::with_options(model.clone(), COUNT, BatchOptions::default());
    let processor = processor.expect("a good model");
    let mut batches = [device, processor];
    let mut random = Random::new(3);
    for env in 0..COUNT {
        let state = random_state(model, &mut random, 0.3);
        for batch in &mut batches {
            batch.state.write(env, &state).expect("a row");
        }
    }
    batches
}

/// Records all outputs that the device supports in both batches.
fn record(batches: &mut [Batch<f32>; 2]) -> Vec<&'static str> {
    let mut names = Vec::new();
    for output in Output::ALL {
        let mut wanted = names.clone();
        wanted.push(output.name());
        match batches[0].record(&wanted) {
            Ok(()) => names = wanted,
            Err(_) => println!("not compared: {}", output.name()),
        }
    }
    batches[1]
        .record(&names)
        .expect("the processor computes all");
    names
}

/// Returns the share of environments in which a part of an output differs between device and processor.
fn share_that_differs(batches: &[Batch<f32>; 2], name: &str, part: Range<usize>) -> f64 {
    let row = |k: usize, env: usize| -> Vec<f64> {
        let rows = batches[k].output(name).expect("it is kept");
        let numbers = rows.row(env)[part.clone()].iter();
        numbers.map(|&x| f64::from(x)).collect()
    };
    // Values below 1e-5 are rounding errors of zero.
    let differs = |&env: &usize| {
        let (found, expected) = (row(0, env), row(1, env));
        let tiny = |x: &Vec<f64>| x.iter().all(|x| x.abs() < 1e-5);
        !(tiny(&found) && tiny(&expected)) && difference(&found, &expected) > TOLERANCE
    };
    (0..COUNT).filter(differs).count() as f64 / COUNT as f64
}

/// Returns the parts of an output that are compared separately: single sensors.
fn parts(model: &Model, name: &str) -> Vec<(String, Range<usize>)> {
    let whole = Output::find(name).expect("an output").width(model);
    if name != "sensordata" {
        return vec![(name.to_owned(), 0..whole)];
    }
    let sensor = |s: &Sensor| (s.kind.name().to_owned(), s.numbers.clone());
    model.sensors.iter().map(sensor).collect()
}

fn agree(file: &str) {
    agree_after(file, |_| ());
}

/// Asserts the same after the same change of both batches.
fn agree_after(file: &str, change: impl Fn(&mut Batch<f32>)) {
    let model = text(file);
    if let Some(device) = common::general_stepped(&model, COUNT, BatchOptions::default()) {
        let mut batches = both(&model, device);
        batches.iter_mut().for_each(change);
        batches_agree(&model, batches);
    }
}

fn batches_agree(model: &Model, mut batches: [Batch<f32>; 2]) {
    let names = record(&mut batches);
    assert!(
        names.contains(&"sensordata") && names.contains(&"cfrc_int"),
        "{names:?}"
    );
    for stage in ["forward", "step"] {
        for batch in &mut batches {
            let summary = match stage {
                "forward" => batch.forward(),
                _ => batch.step(),
            };
            assert_eq!(summary.expect("good states").running, COUNT);
        }
        let mut wrong = Vec::new();
        // The number of iterations depends on rounding.
        for name in names.iter().filter(|name| **name != "solver_iterations") {
            for (what, part) in parts(model, name) {
                // A contact that only one of the two finds is not an error.
                let share = share_that_differs(&batches, name, part);
                if share > 0.05 {
                    wrong.push(format!("{what} in {share:.2} of the states"));
                }
            }
        }
        assert!(wrong.is_empty(), "{stage}: {wrong:?} differ");
    }
}

#[test]
fn those_of_sensors() {
    agree(&own("sensors"));
}

#[test]
fn those_of_sensors_by_runge_kutta() {
    agree(&own("sensors").replace("implicitfast", "RK4"));
}

#[test]
fn outputs_of_bodies_in_contact() {
    agree(&own("pressed"));
}

/// Uses kernels of the model's own, which compile sooner.
#[test]
fn those_of_bodies_in_contact_by_discrete() {
    let model = text(&own("pressed").replace("implicitfast", "discrete"));
    if let Some(device) = common::stepped(&model, COUNT, BatchOptions::default()) {
        batches_agree(&model, both(&model, device));
    }
}

#[test]
fn outputs_of_separate_bodies() {
    agree(&own("apart"));
}

#[test]
fn those_of_a_linkage() {
    agree(&own("linkage"));
}

#[test]
fn those_of_surfaces_that_move_and_adhere() {
    agree(&own("surfaces"));
}

#[test]
fn those_of_orientation_servos() {
    agree(&own("servos"));
}

#[test]
fn those_of_rays_and_cameras() {
    agree(&own("rays"));
}

/// Tests environments with different cameras, sites and geoms.
#[test]
fn those_of_rays_and_cameras_that_differ() {
    agree_after(&own("rays"), |batch| {
        let envs = Vec::from_iter((0..COUNT).step_by(2));
        let mut random = Random::new(5);
        for field in [
            "cam_pos",
            "cam_quat",
            "cam_pos0",
            "cam_poscom0",
            "cam_fovy",
            "cam_sensorsize",
            "cam_intrinsic",
            "site_pos",
            "geom_pos",
        ] {
            let mut values = Vec::new();
            for _ in &envs {
                let row = batch.param(field, 0).expect("a field").into_iter();
                values.extend(row.map(|x| x * (1.0 + 0.1 * random.signed() as f32)));
            }
            batch.randomize(field, &envs, &values).expect("good values");
        }
        // The axes of another camera.
        let mut axes = batch.param("cam_mat0", 0).expect("a field");
        axes.rotate_left(9);
        batch
            .randomize("cam_mat0", &envs, &axes.repeat(envs.len()))
            .expect("good values");
    });
}

#[test]
fn those_of_a_runner() {
    agree(&own("runner"));
}
