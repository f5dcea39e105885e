//! Effects of equalities, limits and dry friction on bodies.

use crate::scenes::{
    G, add, bodies, cuboid, free, geom, joint, rest_penetration, run, sim, sphere, world,
};
use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    DEFAULT_SOLIMP, EqualityKind, EqualitySpec, GeomSpec, JointSpec, ModelBuilder,
};
use clench_rigid::model::JointKind;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Sim, readout};

/// Builds a crank, a coupler and a rocker; a connect closes the loop.
fn four_bar() -> ModelBuilder {
    let mut b = world();
    let link = |half: f64| GeomSpec {
        pos: Vec3::new(half, 0.0, 0.0),
        ..crate::scenes::ghost(geom(ShapeKind::Box, [half, 0.02, 0.02]))
    };
    let hinge = |name: &str| vec![joint(JointKind::Hinge, name, [0.0, 1.0, 0.0])];
    let crank = add(&mut b, 0, "crank", [0.0; 3], hinge("a"), vec![link(0.1)]);
    b.bodies[crank].quat = Quat::new(0.5f64.sqrt(), 0.0, -(0.5f64.sqrt()), 0.0);
    let coupler = add(
        &mut b,
        crank,
        "coupler",
        [0.2, 0.0, 0.0],
        hinge("b"),
        vec![link(0.25)],
    );
    b.bodies[coupler].quat = Quat::new(0.5f64.sqrt(), 0.0, 0.5f64.sqrt(), 0.0);
    let rocker = add(
        &mut b,
        0,
        "rocker",
        [0.5, 0.0, 0.0],
        hinge("c"),
        vec![link(0.1)],
    );
    b.bodies[rocker].quat = b.bodies[crank].quat;
    let anchor = bodies("rocker", "coupler", [0.2, 0.0, 0.0]);
    b.equalities
        .push(EqualitySpec::new("loop", EqualityKind::Connect(anchor)));
    b
}

/// Returns the largest violation of equality rows during `time`.
fn worst_violation(sim: &mut Sim, time: f64) -> f64 {
    let end = sim.state.time + time;
    let mut worst: f64 = 0.0;
    while sim.state.time < end {
        sim.step().expect("finite");
        let rows = readout::constraint_rows(sim.workspace(), 0);
        let equalities = rows.iter().filter(|r| r.source.kind() == "equality");
        worst = equalities.map(|r| r.pos.abs()).fold(worst, f64::max);
    }
    worst
}

#[test]
fn a_four_bar_linkage_keeps_closed() {
    let play = |timeconst: f64| {
        let mut builder = four_bar();
        builder.physics.timestep = 0.001;
        builder.equalities[0].solref[0] = timeconst;
        let mut sim = sim(&builder);
        sim.state.qvel.copy_from_slice(&[3.0, -3.0, 3.0]);
        let worst = worst_violation(&mut sim, 4.0);
        let turned = sim.state.qpos[0];
        assert!(turned.abs() > 1.0, "it moves: {turned} rad");
        worst
    };
    let (soft, stiff) = (play(0.02), play(0.005));
    assert!(soft < 0.002, "{soft} m of play in links of 20 and 50 cm");
    // Stiffness is proportional to the inverse square of the time constant.
    assert!(stiff < soft / 10.0, "{stiff} m against {soft} m");
}

#[test]
fn a_weld_holds_and_can_be_released() {
    let mut b = world();
    add(
        &mut b,
        0,
        "load",
        [0.3, 0.0, 1.0],
        free(),
        vec![cuboid([0.1, 0.1, 0.1])],
    );
    // The anchor is the load's centre, in the second body's frame, which is the world.
    let anchor = bodies("load", "", [0.3, 0.0, 1.0]);
    let kind = EqualityKind::Weld {
        anchor,
        relpose: None,
        torquescale: 1.0,
    };
    b.equalities.push(EqualitySpec::new("grip", kind));
    let mut sim = sim(&b);
    run(&mut sim, 1.0);
    let held = sim.state.qpos[2];
    // It hangs where −k d² r / (1 − d) = −g, and the constraint carries its weight.
    let sag = rest_penetration(1.0, 1.0, DEFAULT_SOLIMP, 0.02);
    assert!(
        (1.0 - held - sag).abs() < 1e-9,
        "sag of {} m instead of {sag} m",
        1.0 - held
    );
    assert!((sim.workspace().qfrc_constraint[2] - G).abs() < 1e-9);
    sim.set_equality_active(0, false).expect("it exists");
    run(&mut sim, 0.2);
    assert!(readout::constraint_rows(sim.workspace(), 0).is_empty());
    assert!((sim.state.qvel[2] + 0.2 * G).abs() < 1e-9, "free fall");
    sim.set_equality_active(0, true).expect("it exists");
    run(&mut sim, 2.0);
    assert!((sim.state.qpos[2] - held).abs() < 1e-6, "pulled back");
    assert!(sim.set_equality_active(1, true).is_err());
}

#[test]
fn a_joint_equality_gears_two_wheels() {
    let mut b = world();
    for name in ["drive", "driven"] {
        let wheel = crate::scenes::ghost(geom(ShapeKind::Cylinder, [0.1, 0.02, 0.0]));
        let axle = JointSpec {
            armature: 0.01,
            ..joint(JointKind::Hinge, name, [0.0, 0.0, 1.0])
        };
        add(&mut b, 0, name, [0.0; 3], vec![axle], vec![wheel]);
    }
    let gear = EqualityKind::Joint {
        joint1: "driven".into(),
        joint2: Some("drive".into()),
        polycoef: [0.0, -3.0, 0.0, 0.0, 0.0],
    };
    b.equalities.push(EqualitySpec::new("gear", gear));
    let mut sim = sim(&b);
    sim.state.qfrc_applied[0] = 0.1;
    run(&mut sim, 1.0);
    // Both wheels have inertia I: (I + 9 I) a = τ, up to the error of an impedance of 0.95.
    let inertia = 0.5 * 0.01 + 0.01;
    let expected = 0.1 / (10.0 * inertia);
    assert!(
        (sim.state.qvel[0] / expected - 1.0).abs() < 1e-6,
        "{} rad/s",
        sim.state.qvel[0]
    );
    assert!((sim.state.qvel[1] / sim.state.qvel[0] + 3.0).abs() < 1e-6);
}

#[test]
fn limits_hold_hinge_slide_and_ball() {
    let mut b = world();
    let limited = |kind, name: &str, axis, range| JointSpec {
        range,
        limited: Some(true),
        ..joint(kind, name, axis)
    };
    let hang = || {
        vec![GeomSpec {
            pos: Vec3::new(0.3, 0.0, 0.0),
            ..crate::scenes::ghost(sphere(0.05))
        }]
    };
    let hinge = limited(JointKind::Hinge, "hinge", [0.0, 1.0, 0.0], [-1.0, 0.5]);
    let slide = limited(JointKind::Slide, "slide", [0.0, 0.0, 1.0], [-0.2, 0.5]);
    let ball = limited(JointKind::Ball, "ball", [0.0, 0.0, 1.0], [0.0, 0.7]);
    for joint in [hinge, slide, ball] {
        add(&mut b, 0, "", [0.0; 3], vec![joint], hang());
    }
    let angle = |sim: &Sim| {
        Quat::from_slice(&sim.state.qpos[2..])
            .to_rotation_vector()
            .norm()
    };
    let mut held = sim(&b);
    run(&mut held, 5.0);
    for (what, value, limit) in [
        ("hinge", held.state.qpos[0], 0.5),
        ("slide", -held.state.qpos[1], 0.2),
        ("ball", angle(&held), 0.7),
    ] {
        assert!(
            value > limit && value < limit + 0.02,
            "{what} at {value}, limit {limit}"
        );
    }
    let options = RigidOptions::new().enable_joint_limit(false);
    let mut open = Sim::with_options(crate::scenes::model(&b), options).expect("valid");
    run(&mut open, 0.4);
    assert!(open.state.qpos[1] < -0.5, "without limits it falls");
}

#[test]
fn dry_friction_holds_a_pendulum_and_brakes_a_wheel() {
    let mut b = world();
    let arm = GeomSpec {
        pos: Vec3::new(0.3, 0.0, 0.0),
        ..crate::scenes::ghost(sphere(0.05))
    };
    let stiff = JointSpec {
        frictionloss: 1.2 * 0.3 * G,
        ..joint(JointKind::Hinge, "stiff", [0.0, 1.0, 0.0])
    };
    add(&mut b, 0, "arm", [0.0; 3], vec![stiff], vec![arm]);
    let wheel = JointSpec {
        frictionloss: 0.02,
        armature: 0.01,
        ..joint(JointKind::Hinge, "wheel", [0.0, 0.0, 1.0])
    };
    add(
        &mut b,
        0,
        "wheel",
        [0.0; 3],
        vec![wheel],
        vec![crate::scenes::ghost(sphere(0.05))],
    );
    let mut sim = sim(&b);
    sim.state.qvel[1] = 2.0;
    let inertia = 0.4 * 0.0025 + 0.01;
    run(&mut sim, 0.5);
    assert!(
        (sim.state.qvel[1] - (2.0 - 0.5 * 0.02 / inertia)).abs() < 1e-9,
        "η / I a second"
    );
    run(&mut sim, 1.5);
    assert!(sim.state.qvel[1].abs() < 1e-9, "then it stands");
    // Below the loss, dry friction acts as a damper: the speed is (1 − d) / (b d) times the free acceleration.
    let creep = sim.state.qvel[0].abs();
    assert!(
        creep > 1e-4 && creep < 0.05,
        "the arm creeps at {creep} rad/s"
    );
}

#[test]
fn dry_friction_that_sticks_holds_the_same_load_after_sleep() {
    let mut b = world();
    b.physics.flags.sleep = true;
    let ball = || vec![crate::scenes::ghost(sphere(0.05))];
    let stiff = JointSpec {
        frictionloss: 100.0 * G,
        damping: [10.0, 0.0, 0.0],
        ..joint(JointKind::Slide, "stiff", [0.0, 0.0, 1.0])
    };
    add(&mut b, 0, "load", [0.0; 3], vec![stiff], ball());
    let loose = joint(JointKind::Slide, "loose", [0.0, 0.0, 1.0]);
    add(&mut b, 0, "falls", [1.0, 0.0, 0.0], vec![loose], ball());
    let options = RigidOptions::new().stiction(true);
    let mut sim = Sim::with_options(crate::scenes::model(&b), options).expect("valid");
    while sim.state.tree_asleep[0] < 0.0 {
        sim.step().expect("finite");
        assert!(sim.state.time < 10.0, "it falls asleep");
    }
    let displacement = sim.state.stick_friction[0];
    run(&mut sim, 1.0);
    assert_eq!(sim.state.stick_friction[0], displacement);
}
