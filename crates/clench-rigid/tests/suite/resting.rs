//! Steps of a sleeping scene equal those of a new simulation in the same state, which computes everything.

use crate::scenes::*;
use clench_rigid::builder::{BodySpec, GeomSpec, ModelBuilder};
use clench_rigid::model::JointKind;
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

/// Builds the boxes, a pendulum that swings all the time, and a ball that rolls into the first box.
fn bowling() -> ModelBuilder {
    let mut b = boxes();
    let hinge = vec![joint(JointKind::Hinge, "swing", [0.0, 1.0, 0.0])];
    let bob = GeomSpec {
        pos: clench_math::Vec3::new(0.5, 0.0, 0.0),
        ..ghost(sphere(0.1))
    };
    add(&mut b, 0, "pendulum", [0.0, 5.0, 2.0], hinge, vec![bob]);
    add(
        &mut b,
        0,
        "ball",
        [-2.0, 0.0, 0.1],
        free(),
        vec![sphere(0.1)],
    );
    b
}

type Change = fn(&mut Sim);

/// Changes of the bowling scene, each at a step at which the boxes sleep, except for the last ones.
const CHANGES: [(usize, Change); 8] = [
    (300, |sim| set(sim, "gravity", |g| g[2] = -8.0)),
    (310, |sim| set(sim, "body_mass", |masses| masses[1] *= 2.0)),
    (320, |sim| {
        set(sim, "dof_damping", |damping| damping[8] = 0.1)
    }),
    (330, |sim| sim.state.qvel[13] = 2.0),
    (331, |sim| sim.state.xfrc_applied[2].linear.x = 30.0),
    (332, |sim| sim.state.xfrc_applied[2].linear.x = 0.0),
    (800, |sim| sim.state.mocap_pos[0].z = 0.25),
    (1300, |sim| sim.state.qpos[8] += 0.2),
];

fn set(sim: &mut Sim, field: &str, change: impl Fn(&mut [f64])) {
    let mut values = sim.param(field).expect("a field");
    change(&mut values);
    sim.set_param(field, &values).expect("values");
}

/// Returns the results of all stages of a step.
fn results(sim: &Sim) -> String {
    let ws = sim.workspace();
    let mut force = ws.force.clone();
    // It is scratch.
    force.cfrc_body.clear();
    let vel = &ws.velocity;
    let smooth = &ws.problem.qacc_smooth;
    let mass = &ws.problem.mass;
    format!(
        "{force:?} {vel:?} {smooth:?} {mass:?} {:?} {:?}",
        ws.qacc, sim.state
    )
}

/// Trees that sleep are not computed again, but their results are those of a simulation that computes them.
#[test]
fn results_of_sleeping_trees_are_not_stale() {
    let mut knows = sim(&bowling());
    let (mut slept, mut woke) = (0, 0);
    let mut changes = CHANGES.iter().peekable();
    for step in 0..1800 {
        while let Some((_, change)) = changes.next_if(|(at, _)| *at == step) {
            change(&mut knows);
        }
        let mut fresh = Sim::new(knows.model().clone()).expect("a model");
        for field in ["gravity", "body_mass", "dof_damping"] {
            let values = knows.param(field).expect("a field");
            fresh.set_param(field, &values).expect("values");
        }
        fresh.state = knows.state.clone();
        let before = asleep(&knows);
        knows.step().expect("finite");
        fresh.step().expect("finite");
        assert_eq!(results(&knows), results(&fresh), "step {step}");
        slept += usize::from(asleep(&knows) > before);
        woke += usize::from(asleep(&knows) < before);
    }
    assert!(
        changes.next().is_none() && slept > 4 && woke > 4,
        "{slept} and {woke}"
    );
}

/// Returns the number of sleeping trees.
fn asleep(sim: &Sim) -> usize {
    sim.state.tree_asleep.iter().filter(|&&x| x >= 0.0).count()
}
