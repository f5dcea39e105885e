//! Single precision stays close to double precision, and bodies at rest stay at rest.

use crate::batches::*;
use clench_rigid::Batch;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::options::{FrictionCone, RigidOptions};

/// Returns the largest errors of a single-precision step from states of a double-precision motion: of accelerations,
/// relative to the largest of the step, and of positions (m, rad).
fn errors_of_a_step(builder: &ModelBuilder, cone: FrictionCone) -> [f64; 2] {
    let (model, envs) = (model(builder), Vec::from_iter(0..16));
    let options = clench_rigid::BatchOptions {
        options: RigidOptions::new().friction_cone(cone),
        threads: Some(1),
        ..Default::default()
    };
    let mut double = batch::<f64>(&model, &envs, options);
    let mut single = Batch::<f32>::with_options(model, envs.len(), options).expect("valid");
    double.record(&["qacc"]).expect("known");
    single.record(&["qacc"]).expect("known");
    let mut worst = [0.0_f64; 2];
    for step in 0..300 {
        drive(&mut double, &envs, step);
        let (from, to) = (&double.state, &mut single.state);
        for (from, to) in [
            (&from.qpos, &mut to.qpos),
            (&from.qvel, &mut to.qvel),
            (&from.ctrl, &mut to.ctrl),
            (&from.qacc_warmstart, &mut to.qacc_warmstart),
        ] {
            for (to, &from) in to.as_mut_slice().iter_mut().zip(from.as_slice()) {
                *to = from as f32;
            }
        }
        (to.time.as_mut_slice()).copy_from_slice(from.time.as_slice());
        (to.eq_active.as_mut_slice()).copy_from_slice(from.eq_active.as_slice());
        assert_eq!(double.step().expect("valid").failed, 0);
        assert_eq!(single.step().expect("valid").failed, 0);
        for env in 0..envs.len() {
            let exact = double.output("qacc").expect("kept").row(env);
            let found = single.output("qacc").expect("kept").row(env);
            let largest = exact.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
            worst[0] = worst[0].max(distance(found, exact) / largest);
            let moved = distance(single.state.qpos.row(env), double.state.qpos.row(env));
            worst[1] = worst[1].max(moved);
        }
    }
    worst
}

fn distance(single: &[f32], double: &[f64]) -> f64 {
    let differences = single
        .iter()
        .zip(double)
        .map(|(&s, d)| (f64::from(s) - d).abs());
    differences.fold(0.0, f64::max)
}

#[test]
fn a_step_in_single_precision_is_near_that_in_double() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        for builder in [walker(), loose_parts()] {
            let [acceleration, position] = errors_of_a_step(&builder, cone);
            assert!(acceleration < 1e-3, "{cone:?}: {acceleration:e}");
            assert!(position < 1e-6, "{cone:?}: {position:e}");
        }
    }
}

#[test]
fn bodies_at_rest_in_single_precision_do_not_jitter() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let mut b = world();
        b.options = RigidOptions::new().friction_cone(cone);
        b.bodies[0].geoms.push(plane());
        // A stack of boxes, and a ball.
        for (i, z) in [0.1, 0.3, 0.5].into_iter().enumerate() {
            let (name, cube) = (format!("box{i}"), cuboid([0.1, 0.1, 0.1]));
            add(&mut b, 0, &name, [0.0, 0.0, z], free(), vec![cube]);
        }
        add(
            &mut b,
            0,
            "ball",
            [1.0, 0.0, 0.1],
            free(),
            vec![sphere(0.1)],
        );
        let mut batch = Batch::<f32>::new(model(&b), 3).expect("valid");
        batch.step_n(1500).expect("valid");
        let rest = batch.state.qpos.row(0).to_vec();
        let (mut fastest, mut farthest) = (0.0_f32, 0.0_f32);
        for _ in 0..1000 {
            assert_eq!(batch.step().expect("valid").failed, 0);
            let speeds = batch.state.qvel.row(0).iter();
            fastest = speeds.fold(fastest, |m, v| m.max(v.abs()));
            let places = batch.state.qpos.row(0).iter().zip(&rest);
            farthest = places.fold(farthest, |m, (a, b)| m.max((a - b).abs()));
        }
        assert!(fastest < 1e-4, "{cone:?}: {fastest:e} m/s");
        assert!(farthest < 1e-6, "{cone:?}: {farthest:e} m");
    }
}
