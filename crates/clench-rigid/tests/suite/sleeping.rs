//! Sleeping: conditions, waking, and the state meanwhile. The rules are in `docs/sleeping.md`;
//! `parity/test_sleeping.py` checks that they are MuJoCo's.

use crate::scenes::*;
use clench_math::Vec3;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, EqualityKind, EqualitySpec, KeyframeSpec, ModelBuilder, TendonSpec,
    TransmissionSpec,
};
use clench_rigid::model::{Integrator, JointKind, SleepPolicy};
use clench_rigid::{Sim, State};

/// The `tree_asleep` value of a moving tree.
const AWAKE: f64 = -11.0;
/// The number of steps in which the scenes come to rest.
const REST: usize = 600;

/// Builds the floor and sets the flag.
fn floor() -> ModelBuilder {
    let mut b = world();
    b.physics.flags.sleep = true;
    b.bodies[0].geoms.push(plane());
    b
}

fn add_box(b: &mut ModelBuilder, name: &str, pos: [f64; 3]) {
    add(b, 0, name, pos, free(), vec![cuboid([0.1; 3])]);
}

/// Builds two stacked boxes and a third next to them, on the floor.
fn boxes() -> ModelBuilder {
    let mut b = floor();
    add_box(&mut b, "low", [0.0, 0.0, 0.1]);
    add_box(&mut b, "high", [0.0, 0.0, 0.3]);
    add_box(&mut b, "beside", [1.0, 0.0, 0.1]);
    b
}

fn steps(sim: &mut Sim, count: usize) {
    for _ in 0..count {
        sim.step().expect("finite");
    }
}

/// Returns the scene after it has come to rest.
fn rested(b: &ModelBuilder) -> Sim {
    let mut sim = sim(b);
    steps(&mut sim, REST);
    sim
}

fn asleep(sim: &Sim) -> Vec<bool> {
    sim.state.tree_asleep.iter().map(|&x| x >= 0.0).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn bodies_at_rest_fall_asleep_by_islands() {
    let mut sim = rested(&boxes());
    assert_eq!(
        sim.state.tree_asleep,
        [1.0, 0.0, 2.0],
        "a pair, and one alone"
    );
    let before = sim.state.clone();
    steps(&mut sim, 100);
    assert_eq!(bits(&sim.state.qpos), bits(&before.qpos));
    assert_eq!(bits(&sim.state.qvel), bits(&[0.0; 18]));
    assert!(sim.workspace().qacc.iter().all(|&a| a == 0.0));
    assert_eq!(
        sim.contacts().len(),
        0,
        "nothing that is awake touches anything"
    );
    assert!(sim.state.time > before.time);
}

#[test]
fn the_tenth_slow_step_is_the_last() {
    let mut b = world();
    b.physics.flags.sleep = true;
    b.physics.gravity = [0.0; 3];
    add(&mut b, 0, "drifts", [0.0; 3], free(), vec![sphere(0.1)]);
    let mut sim = sim(&b);
    sim.state.qvel[0] = 9e-4;
    for counter in -10..=-2 {
        sim.step().expect("finite");
        assert_eq!(sim.state.tree_asleep, [f64::from(counter)]);
    }
    let x = sim.state.qpos[0];
    sim.step().expect("finite");
    assert_eq!(
        sim.state.tree_asleep,
        [0.0],
        "ready, and alone: asleep at once"
    );
    assert_eq!((sim.state.qpos[0], sim.state.qvel[0]), (x, 0.0));
    sim.state.qvel[0] = 1.1e-3;
    steps(&mut sim, 50);
    assert_eq!(sim.state.tree_asleep, [AWAKE], "too fast");
}

#[test]
fn rotations_count_by_the_size_of_the_body() {
    let mut b = world();
    b.physics.flags.sleep = true;
    b.physics.gravity = [0.0; 3];
    let mut rod = geom(clench_collide::ShapeKind::Sphere, [0.1, 0.0, 0.0]);
    rod.pos = Vec3::new(0.0, 0.0, -0.4);
    let hinge = joint(JointKind::Hinge, "", [0.0, 1.0, 0.0]);
    add(&mut b, 0, "rod", [0.0; 3], vec![hinge], vec![rod]);
    let model = model(&b);
    // Its centre of mass is 0.4 m from the hinge; its geom reaches 0.1 m from there.
    assert!((model.params.dof_length[0] - 0.4).abs() < 1e-12);
    for (speed, sleeps) in [(0.99e-3 / 0.4, true), (1.01e-3 / 0.4, false)] {
        let mut sim = Sim::new(model.clone()).expect("valid");
        sim.state.qvel[0] = speed;
        steps(&mut sim, 12);
        assert_eq!(asleep(&sim), [sleeps], "at {speed} rad/s");
    }
}

#[test]
fn without_the_flag_nothing_sleeps_and_until_then_nothing_differs() {
    let mut flagged = sim(&boxes());
    let mut b = boxes();
    b.physics.flags.sleep = false;
    let mut plain = sim(&b);
    assert!(plain.state.tree_asleep.is_empty() && plain.state.pose_asleep.is_empty());
    let mut compared = 0;
    while !asleep(&flagged).contains(&true) {
        steps(&mut flagged, 1);
        steps(&mut plain, 1);
        if !asleep(&flagged).contains(&true) {
            assert_eq!(bits(&flagged.state.qpos), bits(&plain.state.qpos));
            assert_eq!(bits(&flagged.state.qvel), bits(&plain.state.qvel));
            compared += 1;
        }
    }
    assert!(compared > 20);
}

#[test]
fn a_pushed_body_wakes_with_its_island() {
    type Touch = fn(&mut State<f64>);
    let touches: [(&str, Touch); 6] = [
        ("position", |s| s.qpos[0] += 1e-12),
        ("velocity", |s| s.qvel[6] = 1e-9),
        ("minus nothing", |s| s.qvel[3] = -0.0),
        ("force", |s| s.qfrc_applied[11] = -1e-9),
        ("force on a body", |s| s.xfrc_applied[2].angular.y = 1e-9),
        ("force of minus nothing", |s| {
            s.xfrc_applied[1].linear.z = -0.0
        }),
    ];
    let sleeping = rested(&boxes());
    for (what, touch) in touches {
        let mut sim = Sim::new(sleeping.model().clone()).expect("valid");
        sim.state.copy_from(&sleeping.state);
        touch(&mut sim.state);
        sim.step().expect("finite");
        assert_eq!(asleep(&sim), [false, false, true], "{what}");
    }
}

#[test]
fn a_force_keeps_awake_for_as_long_as_it_acts() {
    let mut sim = rested(&boxes());
    sim.state.qfrc_applied[0] = 1e-12;
    steps(&mut sim, 100);
    assert_eq!(sim.state.tree_asleep[0], AWAKE);
    sim.state.qfrc_applied[0] = 0.0;
    steps(&mut sim, 10);
    assert_eq!(asleep(&sim), [true; 3]);
}

/// The step that wakes the stack has the contacts of a simulation that never slept.
#[test]
fn waking_loses_no_contact() {
    let mut b = boxes();
    add(
        &mut b,
        0,
        "ball",
        [0.0, 0.0, 1.5],
        free(),
        vec![sphere(0.05)],
    );
    let mut sim = sim(&b);
    let mut woke = false;
    for _ in 0..2 * REST {
        let (before, slept) = (sim.state.clone(), asleep(&sim)[0]);
        sim.step().expect("finite");
        if !slept || asleep(&sim)[0] {
            continue;
        }
        woke = true;
        let mut plain = b.clone();
        plain.physics.flags.sleep = false;
        let mut plain = crate::scenes::sim(&plain);
        plain
            .set_configuration(&before.qpos, &before.qvel)
            .expect("lengths");
        plain.forward().expect("finite");
        let of_stack = |sim: &Sim| {
            let contacts = sim.contacts().iter();
            // Excludes the box next to it, which still sleeps.
            Vec::from_iter(
                contacts
                    .filter(|c| !c.geoms.contains(&3))
                    .map(|c| (c.geoms, c.dist)),
            )
        };
        assert_eq!(of_stack(&sim), of_stack(&plain));
        assert!(
            of_stack(&sim).len() >= 9,
            "the ball, and each box on what is below it"
        );
    }
    assert!(woke, "the ball did not hit them asleep");
}

#[test]
fn a_mocap_body_wakes_bodies_that_touch_it() {
    let mut b = boxes();
    let hand = BodySpec {
        name: "hand".into(),
        mocap: true,
        pos: Vec3::new(0.0, 3.0, 0.1),
        geoms: vec![sphere(0.05)],
        ..BodySpec::default()
    };
    b.bodies.push(hand);
    let hinge = joint(JointKind::Hinge, "", [0.0, 0.0, 1.0]);
    add(
        &mut b,
        4,
        "carried",
        [0.0, 0.0, 1.0],
        vec![hinge],
        vec![sphere(0.1)],
    );
    let mut sim = rested(&b);
    assert_eq!(asleep(&sim), [true; 4]);
    sim.state.mocap_pos[0].y = 2.9;
    sim.step().expect("finite");
    assert_eq!(asleep(&sim), [true, true, true, false], "what it carries");
    steps(&mut sim, 20);
    sim.state.mocap_pos[0] = Vec3::new(1.149, 0.0, 0.1);
    sim.step().expect("finite");
    assert_eq!(asleep(&sim), [true, true, false, false], "what it touches");
    sim.state.mocap_pos[0].x = 2.0;
    steps(&mut sim, REST);
    assert_eq!(asleep(&sim), [true; 4]);
}

#[test]
fn an_equality_wakes_bodies_that_did_not_fall_asleep_together() {
    let mut b = boxes();
    b.equalities.push(EqualitySpec {
        active: false,
        ..EqualitySpec::new(
            "",
            EqualityKind::Connect(bodies("low", "beside", [0.5, 0.0, 0.0])),
        )
    });
    let mut sim = rested(&b);
    sim.state.eq_active[0] = true;
    sim.step().expect("finite");
    assert_eq!(asleep(&sim), [false; 3]);
    steps(&mut sim, REST);
    assert_eq!(
        sim.state.tree_asleep,
        [1.0, 2.0, 0.0],
        "now they are one island"
    );
    sim.state.eq_active[0] = false;
    steps(&mut sim, 5);
    assert_eq!(asleep(&sim), [true; 3], "what lets go wakes nobody");
}

#[test]
fn a_saved_state_sleeps_on_and_wakes_as_it_would_have() {
    let mut one = rested(&boxes());
    let mut other = Sim::new(one.model().clone()).expect("valid");
    other.state.copy_from(&one.state);
    for step in 0..200 {
        for sim in [&mut one, &mut other] {
            sim.state.qfrc_applied[2] = if (50..60).contains(&step) { 15.0 } else { 0.0 };
            sim.step().expect("finite");
        }
        assert!(one.state == other.state, "step {step}");
    }
}

#[test]
fn numbers_that_are_no_cycle_end() {
    for numbers in [
        [5.0, 1e300, 0.5],
        [1.0, 2.0, 1.0],
        [-1e300, -0.3, 2.9],
        [0.0, 0.0, 0.0],
    ] {
        let mut sim = rested(&boxes());
        sim.state.tree_asleep.copy_from_slice(&numbers);
        sim.state.qvel[0] = 0.1;
        steps(&mut sim, 2 * REST);
        assert!(sim.state.qpos.iter().all(|q| q.is_finite()));
    }
}

#[test]
fn no_islands_no_sleep() {
    let mut b = boxes();
    b.options.islands = Some(clench_solver::Switch::Off);
    let sim = rested(&b);
    assert_eq!(
        sim.state.tree_asleep.iter().filter(|&&x| x >= 0.0).count(),
        0
    );
}

mod policies {
    use super::*;

    fn hinged(b: &mut ModelBuilder, name: &str) {
        let hinge = joint(JointKind::Hinge, name, [0.0, 1.0, 0.0]);
        add(b, 0, name, [0.0; 3], vec![hinge], vec![ghost(sphere(0.1))]);
    }

    fn pair() -> ModelBuilder {
        let mut b = world();
        b.physics.flags.sleep = true;
        hinged(&mut b, "a");
        hinged(&mut b, "b");
        b
    }

    fn tendon(stiffness: f64, of: &[&str]) -> TendonSpec {
        let terms = Vec::from_iter(of.iter().map(|&name| (name, 1.0)));
        TendonSpec {
            stiffness: [stiffness, 0.0, 0.0],
            ..TendonSpec::fixed("tendon", &terms)
        }
    }

    fn policies(b: &ModelBuilder) -> Vec<SleepPolicy> {
        model(b).trees.iter().map(|tree| tree.sleep).collect()
    }

    #[test]
    fn actuators_and_springs_between_trees_keep_awake() {
        use SleepPolicy::{Allowed, Never};
        assert_eq!(policies(&pair()), [Allowed, Allowed]);
        let mut b = pair();
        b.actuators.push(ActuatorSpec::motor(
            "",
            TransmissionSpec::Joint("b".into()),
            1.0,
        ));
        assert_eq!(policies(&b), [Allowed, Never]);
        b.bodies[2].sleep = Allowed;
        assert_eq!(policies(&b), [Allowed, Allowed], "the author knows better");
        let mut b = pair();
        b.tendons.push(tendon(0.0, &["a", "b"]));
        assert_eq!(policies(&b), [Allowed, Allowed]);
        b.tendons[0] = tendon(1.0, &["a"]);
        assert_eq!(policies(&b), [Allowed, Allowed], "a spring within a tree");
        b.tendons[0] = tendon(1.0, &["a", "b"]);
        assert_eq!(policies(&b), [Never, Never]);
        hinged(&mut b, "c");
        b.tendons[0] = tendon(0.0, &["a", "b", "c"]);
        assert_eq!(policies(&b), [Never, Never, Never]);
    }

    #[test]
    fn without_constraints_a_tendon_at_its_limit_wakes_nothing() {
        let mut b = pair();
        (b.bodies[1].sleep, b.physics.flags.constraint) = (SleepPolicy::Init, false);
        b.tendons.push(tendon(0.0, &["a", "b"]));
        (b.tendons[0].range, b.tendons[0].limited) = ([1.0, 2.0], Some(true));
        let mut sim = sim(&b);
        steps(&mut sim, 5);
        assert_eq!(asleep(&sim), [true, false]);
    }

    #[test]
    fn invalid_policies_are_errors() {
        let error = |b: &ModelBuilder| b.build().expect_err("cannot be").to_string();
        let mut b = pair();
        b.bodies[1].sleep = SleepPolicy::Init;
        b.tendons.push(tendon(1.0, &["a", "b"]));
        assert!(error(&b).contains("acts on several trees"), "{}", error(&b));
        let mut b = pair();
        let ball = joint(JointKind::Ball, "", [0.0; 3]);
        let child = add(&mut b, 1, "child", [0.0; 3], vec![ball], vec![sphere(0.1)]);
        b.bodies[child].sleep = SleepPolicy::Allowed;
        assert!(error(&b).contains("not the moving root"), "{}", error(&b));
        let mut b = pair();
        b.physics.integrator = Integrator::Rk4;
        assert!(error(&b).contains("RK4"), "{}", error(&b));
        let mut b = pair();
        b.physics.sleep_tolerance = f64::NAN;
        assert!(error(&b).contains("sleep_tolerance"), "{}", error(&b));
    }

    #[test]
    fn an_initially_sleeping_body_floats_until_a_keyframe_moves_it() {
        let mut b = floor();
        add_box(&mut b, "floats", [0.0, 0.0, 2.0]);
        add_box(&mut b, "rests", [1.0, 0.0, 0.1]);
        b.bodies[1].sleep = SleepPolicy::Init;
        let mut qpos = model(&b).params.qpos0.clone();
        qpos[2] = 3.0;
        b.keyframes.push(KeyframeSpec {
            qpos: Some(qpos),
            ..KeyframeSpec::default()
        });
        let mut sim = rested(&b);
        assert_eq!(asleep(&sim), [true, true]);
        assert_eq!(sim.state.qpos[2], 2.0);
        sim.reset();
        assert_eq!(asleep(&sim), [true, false]);
        sim.reset_to_keyframe(0).expect("there");
        steps(&mut sim, 5);
        assert!(!asleep(&sim)[0] && sim.state.qpos[2] < 3.0);
    }

    #[test]
    fn an_island_starts_asleep_as_a_whole_or_not_at_all() {
        let mut b = floor();
        add_box(&mut b, "one", [0.0, 0.0, 0.5]);
        add_box(&mut b, "other", [0.0, 0.0, 0.69]);
        b.bodies[1].sleep = SleepPolicy::Init;
        let restless = model(&b);
        assert!(
            restless.notes[0].contains("\"one\" starts awake"),
            "{:?}",
            restless.notes
        );
        assert_eq!(State::<f64>::new(&restless).tree_asleep[0], AWAKE);
        b.bodies[2].sleep = SleepPolicy::Init;
        let sleeping = model(&b);
        assert!(sleeping.notes.is_empty());
        assert_eq!(State::<f64>::new(&sleeping).tree_asleep, [1.0, 0.0]);
    }
}
