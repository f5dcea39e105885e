//! Limits of actuator forces, and setpoints on a circle.

mod machines;

use clench_math::Quat;
use clench_rigid::Sim;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, TendonSpec, TransmissionSpec,
};
use machines::{distance, sim, world};
use std::f64::consts::TAU;

/// Two sliders, held by nothing.
fn sliders() -> ModelBuilder {
    let mut builder = world("sliders");
    for (name, axis) in [("x", [1.0, 0.0, 0.0]), ("z", [0.0, 0.0, 1.0])] {
        builder.add_body(
            ModelBuilder::WORLD,
            BodySpec::new(name)
                .joint(JointSpec::slide(name, axis))
                .geom(GeomSpec::sphere(0.1).mass(2.0)),
        );
    }
    builder
}

fn forward(builder: &ModelBuilder, ctrl: &[f64]) -> Sim {
    let mut sim = sim(builder);
    sim.set_ctrl(ctrl).expect("a control for each actuator");
    sim.forward().expect("finite");
    sim
}

#[test]
fn a_tendon_limit_scales_its_actuators_alike() {
    let mut builder = sliders();
    let mut tendon = TendonSpec::fixed("t", &[("x", 1.0), ("z", 2.0)]);
    tendon.actuatorfrcrange = [-1.0, 3.0];
    builder.tendons.push(tendon);
    let target = || TransmissionSpec::Tendon("t".into());
    builder.actuators = vec![
        ActuatorSpec::motor("a", target(), 1.0),
        ActuatorSpec::motor("b", target(), 1.0),
    ];
    let forces = |ctrl: &[f64]| {
        let sim = forward(&builder, ctrl);
        let force = &sim.workspace().force;
        (force.actuator_force.clone(), force.qfrc_actuator.clone())
    };
    let (within, _) = forces(&[2.0, 0.5]);
    assert_eq!(within, [2.0, 0.5]);
    let (above, qfrc) = forces(&[8.0, -2.0]);
    assert!(distance(&above, &[4.0, -1.0]) < 1e-15);
    assert!(distance(&qfrc, &[3.0, 6.0]) < 1e-15);
    let (below, _) = forces(&[-3.0, 1.0]);
    assert!(distance(&below, &[-1.5, 0.5]) < 1e-15);
    let (opposed, _) = forces(&[5.0, -5.0]);
    assert_eq!(opposed, [5.0, -5.0]);
}

#[test]
fn a_joint_limit_holds_all_actuation_and_compensated_weight() {
    let mut builder = sliders();
    builder.bodies[2].gravcomp = 1.0;
    builder.bodies[2].joints[0].actuatorgravcomp = true;
    let target = TransmissionSpec::Joint("z".into());
    builder.actuators = vec![ActuatorSpec::motor("lift", target, 2.0)];
    let weight = 2.0 * 9.81;
    let free = forward(&builder, &[3.0]);
    let force = &free.workspace().force;
    assert!((force.qfrc_actuator[1] - (weight + 6.0)).abs() < 1e-12);
    assert_eq!(force.qfrc_passive[1], 0.0);

    builder.bodies[2].joints[0].actuatorfrcrange = [-10.0, 20.0];
    let held = forward(&builder, &[3.0]);
    assert_eq!(held.workspace().force.qfrc_actuator[1], 20.0);

    builder.bodies[2].joints[0].actuatorgravcomp = false;
    let passive = forward(&builder, &[3.0]);
    let force = &passive.workspace().force;
    assert_eq!(force.qfrc_actuator[1], 6.0);
    assert!((force.qfrc_passive[1] - weight).abs() < 1e-12);
}

#[test]
fn a_switched_off_group_does_nothing() {
    let mut builder = sliders();
    let target = || TransmissionSpec::Joint("x".into());
    let mut off = ActuatorSpec::motor("off", target(), 1.0);
    off.group = 3;
    builder.actuators = vec![off, ActuatorSpec::motor("on", target(), 1.0)];
    builder.physics.disabled_actuator_groups = vec![3];
    let sim = forward(&builder, &[5.0, 2.0]);
    assert_eq!(sim.workspace().force.actuator_force, [0.0, 2.0]);
}

#[test]
fn a_servo_on_a_ball_takes_the_short_way_round() {
    let mut builder = world("ball");
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("ball")
            .joint(JointSpec::ball("ball"))
            .geom(GeomSpec::cuboid([0.1, 0.2, 0.3])),
    );
    let target = TransmissionSpec::Joint("ball".into());
    let mut servo = ActuatorSpec::position("servo", target, 3.0, 0.0);
    servo.gear = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0];
    builder.actuators = vec![servo];
    let mut sim = sim(&builder);
    let angle = 2.5;
    let turned = Quat::from_axis_angle(clench_math::Vec3::new(0.0, 0.0, 1.0), angle);
    turned.write(&mut sim.state.qpos);
    for (setpoint, error) in [(5.5, 0.5), (-5.5, 2.0 * TAU - 10.5), (5.5 + 6.0 * TAU, 0.5)] {
        sim.set_ctrl(&[setpoint]).expect("one control");
        sim.forward().expect("finite");
        let force = sim.workspace().force.actuator_force[0];
        assert!((force - 3.0 * error).abs() < 1e-12, "{setpoint}: {force}");
    }
}
