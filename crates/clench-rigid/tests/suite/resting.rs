//! Steps of a sleeping scene equal those of a new simulation in the same state.

use crate::scenes::*;
use clench_rigid::builder::{BodySpec, ModelBuilder};
use clench_rigid::{Sim, State};

/// Builds two boxes on the floor and a ball that is positioned by the user.
fn boxes() -> ModelBuilder {
    let mut b = world();
    b.physics.flags.sleep = true;
    b.bodies[0].geoms.push(plane());
    for x in [0.0, 1.0] {
        add(&mut b, 0, "", [x, 0.0, 0.1], free(), vec![cuboid([0.1; 3])]);
    }
    b.bodies.push(BodySpec {
        pos: clench_math::Vec3::new(0.0, 0.0, 1.0),
        mocap: true,
        geoms: vec![sphere(0.1)],
        ..BodySpec::default()
    });
    b
}

/// Returns the scene some steps after all bodies have fallen asleep.
fn rested() -> Sim {
    let mut sim = sim(&boxes());
    for _ in 0..600 {
        sim.step().expect("finite");
    }
    assert!(sim.state.tree_asleep.iter().all(|&x| x >= 0.0));
    sim
}

type Write = fn(&mut State<f64>);

/// Changes that users may make between two steps.
const WRITES: [(&str, Write); 15] = [
    ("nothing", |_| {}),
    ("a force", |s| s.qfrc_applied[2] = 100.0),
    ("a force of −0", |s| s.qfrc_applied[7] = -0.0),
    ("a force that is no number", |s| {
        s.qfrc_applied[7] = f64::NAN
    }),
    ("a force on a body", |s| s.xfrc_applied[1].linear.z = 100.0),
    ("a moment on a body", |s| s.xfrc_applied[2].angular.x = 50.0),
    ("a position", |s| s.qpos[0] += 1e-9),
    ("a position that is no number", |s| s.qpos[8] = f64::NAN),
    ("a velocity", |s| s.qvel[11] = 1e-6),
    ("a velocity of −0", |s| s.qvel[0] = -0.0),
    ("where a body fell asleep", |s| s.pose_asleep[9] += 0.5),
    ("that a body is awake", |s| s.tree_asleep[1] = -11.0),
    ("an acceleration to start from", |s| {
        s.qacc_warmstart[3] = f64::NAN
    }),
    ("the time", |s| s.time = f64::INFINITY),
    ("the pose of what is placed", |s| s.mocap_pos[0].z = 0.25),
];

#[test]
fn writes_to_a_resting_simulation_act_as_on_a_new_one() {
    for (what, write) in WRITES {
        let mut knows = rested();
        let mut fresh = Sim::new(knows.model().clone()).expect("a model");
        write(&mut knows.state);
        fresh.state = knows.state.clone();
        for step in 0..3 {
            let told = |result: Result<(), _>| result.map_err(|error| format!("{error}"));
            let expected = told(fresh.step());
            assert_eq!(told(knows.step()), expected, "{what}, step {step}");
            let bits = |s: &State<f64>| format!("{s:?}");
            assert_eq!(
                bits(&knows.state),
                bits(&fresh.state),
                "{what}, step {step}"
            );
        }
    }
}
