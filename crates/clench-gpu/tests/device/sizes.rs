//! Geoms whose sizes differ between environments.

use crate::common::{self, Random, random_state, text};
use clench_rigid::batch::{Batch, BatchOptions};

const COUNT: usize = 32;

/// One body of each shape, each on a box and beside a cylinder that stand still.
fn scene() -> String {
    let shapes = [
        "type='sphere' size='0.1'",
        "type='capsule' size='0.08 0.1'",
        "type='ellipsoid' size='0.12 0.1 0.08'",
        "type='cylinder' size='0.1 0.08'",
        "type='box' size='0.1 0.08 0.09'",
    ];
    let place = |(k, shape): (usize, &&str)| {
        let x = k as f64;
        format!(
            "<geom type='box' size='0.3 0.3 0.1' pos='{x} 0 0'/>
             <geom type='cylinder' size='0.1 0.3' pos='{x} 0.2 0.3'/>
             <body pos='{x} 0.02 0.18'><freejoint/><geom {shape}/></body>"
        )
    };
    let places = Vec::from_iter(shapes.iter().enumerate().map(place));
    let geoms = places.join("\n");
    format!(
        "<mujoco model='sizes'><option timestep='0.004'/><worldbody>{geoms}</worldbody></mujoco>"
    )
}

#[test]
fn geoms_have_the_sizes_of_their_environments() {
    let model = text(&scene());
    let options = BatchOptions::default;
    let Some(mut device) = common::general_stepped::<f32>(&model, COUNT, BatchOptions::default())
    else {
        return;
    };
    let mut processor =
        Batch::<f32>::with_options(model.clone(), COUNT, options()).expect("a good model");
    let mut plain =
        Batch::<f32>::with_options(model.clone(), COUNT, options()).expect("a good model");
    let mut random = Random::new(4);
    let envs = Vec::from_iter(0..COUNT);
    let row = processor.param("geom_size", 0).expect("a field");
    let sizes = row.repeat(COUNT);
    let sizes = Vec::from_iter((sizes.iter()).map(|x| x * (1.0 + 0.2 * random.signed() as f32)));
    for env in 0..COUNT {
        let state = random_state(&model, &mut random, 0.1);
        for batch in [&mut device, &mut processor, &mut plain] {
            batch.state.write(env, &state).expect("a row");
        }
    }
    device
        .randomize("geom_size", &envs, &sizes)
        .expect("good sizes");
    processor
        .randomize("geom_size", &envs, &sizes)
        .expect("good sizes");
    for batch in [&mut device, &mut processor, &mut plain] {
        assert_eq!(batch.step_n(2).expect("a device").running, COUNT);
    }
    // Rounding decides which points of some pairs touch: most environments agree.
    let mut near = 0;
    for env in 0..COUNT {
        let gap = |other: &Batch<f32>| {
            let pairs = (device.state.qvel.row(env).iter()).zip(other.state.qvel.row(env));
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        let (here, without) = (gap(&processor), gap(&plain));
        assert!(without > 0.1, "environment {env}: {without}");
        near += usize::from(here < 1e-3 * without);
    }
    assert!(near * 10 >= COUNT * 9, "{near} environments agree");
}
