//! Hard cases for single precision: ill-conditioned mass matrices, and very stiff constraints.

use crate::batches::*;
use clench_collide::ShapeKind;
use clench_math::{Real, Vec3};
use clench_rigid::builder::{EqualityKind, EqualitySpec, GeomMass, GeomSpec, ModelBuilder};
use clench_rigid::model::JointKind;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Batch, Precision};

const LINK: f64 = 0.1;

/// Builds 10 cm links, each on a hinge across the previous one, the first on the world, at angles of `turn` (rad).
fn chain(links: usize, turn: f64, range: Option<f64>) -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new();
    let mut parent = 0;
    for i in 0..links {
        let axis = if turn > 0.0 || i % 2 == 0 {
            [0.0, 1.0, 0.0]
        } else {
            [0.0, 0.0, 1.0]
        };
        let mut hinge = joint(JointKind::Hinge, &format!("hinge{i}"), axis);
        if let Some(range) = range {
            (hinge.range, hinge.limited) = ([-range, range], Some(true));
        }
        let rod = GeomSpec {
            pos: Vec3::new(0.5 * LINK, 0.0, 0.0),
            ..ghost(geom(ShapeKind::Box, [0.5 * LINK, 0.01, 0.01]))
        };
        let pos = if i == 0 { [0.0; 3] } else { [LINK, 0.0, 0.0] };
        let name = format!("link{i}");
        parent = add(&mut b, parent, &name, pos, vec![hinge], vec![rod]);
        let half = if i == 0 { 0.0 } else { 0.5 * turn };
        b.bodies[parent].quat = clench_math::Quat::new(half.cos(), 0.0, half.sin(), 0.0);
    }
    b
}

/// Builds a ring: a chain of 15 links whose end is connected to its start.
fn ring() -> ModelBuilder {
    let links = 15;
    let mut b = chain(links, std::f64::consts::TAU / links as f64, None);
    let end = bodies(&format!("link{}", links - 1), "world", [LINK, 0.0, 0.0]);
    b.equalities
        .push(EqualitySpec::new("closed", EqualityKind::Connect(end)));
    b
}

/// Returns the accelerations of environment 3 in its initial state.
fn accelerations<S: Precision>(builder: &ModelBuilder) -> Vec<f64> {
    let mut sim = alone::<S>(&model(builder), RigidOptions::new(), 3);
    sim.forward().expect("the masses are positive");
    sim.workspace()
        .qacc
        .iter()
        .map(|a| a.lane(0).to_f64())
        .collect()
}

#[test]
fn accelerations_of_long_chains_keep_their_digits_in_single_precision() {
    for (links, turn, bound) in [(50, 0.0, 1e-3), (50, 0.1, 3e-3), (100, 0.05, 2e-2)] {
        let b = chain(links, turn, None);
        let (exact, found) = (accelerations::<f64>(&b), accelerations::<f32>(&b));
        let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
        let error = norm(&mut exact.iter().zip(&found).map(|(a, b)| a - b));
        let error = error / norm(&mut exact.iter().copied());
        assert!(error < bound, "{links} links, bent by {turn}: {error:e}");
    }
}

/// Takes 1,000 steps in single precision, singly and in lanes, and returns the largest speed.
fn fastest(builder: &ModelBuilder) -> f64 {
    let model = model(builder);
    let envs = Vec::from_iter(0..9);
    let mut batch = batch::<f32>(&model, &envs, Default::default());
    let mut single = alone::<f32>(&model, RigidOptions::new(), 0);
    let slow = |v: &mut f32| *v *= 0.1;
    batch.state.qvel.as_mut_slice().iter_mut().for_each(slow);
    single.state.qvel.iter_mut().for_each(slow);
    let mut fastest = 0.0_f32;
    for step in 0..1000 {
        let report = batch.step().expect("valid");
        assert_eq!(report.failed, 0, "step {step}: {:?}", batch.statuses());
        single.step().unwrap_or_else(|e| panic!("step {step}: {e}"));
        let speeds = batch.state.qvel.as_slice().iter();
        fastest = speeds.fold(fastest, |m, v| m.max(v.abs()));
    }
    assert_bits(batch.state.qpos.row(0), &single.state.qpos, &|| {
        "qpos".into()
    });
    fastest.into()
}

#[test]
fn long_chains_and_rings_live_in_single_precision() {
    for (what, b) in [
        ("50 hinges", chain(50, 0.0, None)),
        ("50 hinges with limits", chain(50, 0.0, Some(0.5))),
        ("100 hinges", chain(100, 0.0, None)),
        ("a ring of 15 links", ring()),
    ] {
        let speed = fastest(&b);
        assert!(speed < 1000.0, "{what}: {speed} rad/s");
    }
}

/// Builds six cubes around a missing centre cube, like the faces of a Rubik's cube. Each is on a hinge through its
/// centre of mass and overlaps its neighbours by 1 mm.
fn faces(cone: FrictionCone) -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new().friction_cone(cone);
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut direction = [0.0; 3];
            direction[axis] = sign;
            let mut hinge = joint(JointKind::Hinge, "", direction);
            (hinge.armature, hinge.damping[0]) = (1e-4, 5e-4);
            let cube = GeomSpec {
                mass: GeomMass::Mass(0.0025),
                condim: if axis == 0 { 1 } else { 3 },
                ..cuboid([0.01; 3])
            };
            let pos = direction.map(|d| 0.01905 * d);
            let name = format!("face {axis} {sign}");
            add(&mut b, 0, &name, pos, vec![hinge], vec![cube]);
        }
    }
    b
}

#[test]
fn a_mass_on_its_hinge_can_be_pushed_on_in_single_precision() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let mut batch = Batch::<f32>::new(model(&faces(cone)), 5).expect("valid");
        let mut touched = 0.0_f64;
        for step in 0..500 {
            for env in 0..5 {
                for (i, torque) in batch.state.qfrc_applied.row_mut(env).iter_mut().enumerate() {
                    *torque = 0.02 * control::<f32>(env, step, i);
                }
            }
            let report = batch.step().expect("valid");
            touched = touched.max(batch.quality().contacts_max as f64);
            assert_eq!(
                report.failed,
                0,
                "{cone:?} step {step}: {:?}",
                batch.statuses()
            );
        }
        let speeds = batch.state.qvel.as_slice().iter();
        let fastest = speeds.fold(0.0_f32, |m, v| m.max(v.abs()));
        assert!(touched > 0.0, "they touch");
        assert!(fastest < 100.0, "{cone:?}: {fastest} rad/s");
    }
}
