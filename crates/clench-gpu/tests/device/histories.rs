//! Rest positions of yielding springs and past controls are part of the state: they are downloaded, and uploaded with a
//! snapshot.

use crate::common::{self, Random, own, random_state, text};
use clench_rigid::batch::Controls;
use clench_rigid::{Batch, BatchOptions, State};

const COUNT: usize = 40;

#[test]
fn histories_and_springs_that_yield_are_those_of_the_processor() {
    let rk4 = own("pliant").replace("<option ", "<option integrator=\"RK4\" ");
    let model = text(&rk4);
    let Some(mut device) = common::general_stepped(&model, COUNT, BatchOptions::default()) else {
        return;
    };
    let mut random = Random::new(5);
    for env in 0..COUNT {
        let state = random_state(&model, &mut random, 0.3);
        device.state.write(env, &state).expect("a row");
    }
    let mut processor = Batch::with_options(model.clone(), COUNT, BatchOptions::default());
    let processor = processor.as_mut().expect("a good model");
    device.record(&["sensordata"]).expect("it reads them all");
    processor.record(&["sensordata"]).expect("so does this");
    let start = device.save().expect("rows");
    processor.restore(&start).expect("the same model");
    let (steps, nu) = (30, model.nu());
    let ctrl = Vec::from_iter((0..COUNT * steps * nu).map(|i| (0.37 * i as f32).sin()));
    let run = |batch: &mut Batch<f32>| {
        let rows = batch.rollout(steps, Controls::Each(&ctrl), &["qpos"]);
        rows.expect("good controls");
    };
    run(&mut device);
    run(processor);
    let gap = |a: &[f32], b: &[f32]| {
        let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        gaps.fold(0.0, f32::max)
    };
    for (name, found, expected, initial) in [
        ("qpos", &device.state.qpos, &processor.state.qpos, None),
        (
            "history",
            &device.state.history,
            &processor.state.history,
            Some(0.1),
        ),
        (
            "plastic",
            &device.state.plastic,
            &processor.state.plastic,
            Some(0.01),
        ),
    ] {
        let gap_here = gap(found.as_slice(), expected.as_slice());
        assert!(gap_here < 2e-4, "{name}: {gap_here}");
        let Some(least) = initial else { continue };
        let fresh = State::<f32>::new(&model);
        let fresh = if name == "history" {
            fresh.history
        } else {
            fresh.plastic
        };
        let moved = gap(found.row(0), &fresh);
        assert!(moved > least, "{name} moves by {moved} alone");
    }
    // The same state leads to the same results.
    let before = device.state.history.as_slice().to_vec();
    device.restore(&start).expect("the same model");
    run(&mut device);
    assert_eq!(device.state.history.as_slice(), before);
    // Sensors with delays, in steps with a given time and in many steps at once.
    for steps in [0, 20] {
        device.step_n(steps).expect("good states");
        processor.step_n(steps).expect("good states");
        let [found, expected] = [&device, processor]
            .map(|batch| batch.output("sensordata").expect("recorded").as_slice());
        let gap_here = gap(found, expected);
        assert!(gap_here < 2e-3, "sensordata: {gap_here}");
        let gap_here = gap(
            device.state.history.as_slice(),
            processor.state.history.as_slice(),
        );
        assert!(gap_here < 2e-3, "history: {gap_here}");
    }
}
