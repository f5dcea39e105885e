//! Limits of actuator forces, and setpoints on a circle.

use crate::machines::{distance, sim, world};
use clench_math::Quat;
use clench_rigid::Sim;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomMass, GeomSpec, JointSpec, ModelBuilder, TendonSpec,
    TransmissionSpec,
};
use clench_rigid::model::{DynamicsKind, Integrator};
use std::f64::consts::TAU;

/// Builds two free sliders.
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
fn a_tendon_limit_scales_all_its_actuators_equally() {
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
fn an_actuator_cut_by_its_own_range_leaves_the_others_of_its_tendon_their_damping() {
    let mut builder = sliders();
    builder.physics.gravity = [0.0; 3];
    builder.physics.integrator = Integrator::ImplicitFast;
    builder.physics.timestep = 0.01;
    for body in &mut builder.bodies[1..] {
        body.geoms[0].mass = GeomMass::Mass(1.0);
    }
    let mut tendon = TendonSpec::fixed("t", &[("x", 1.0), ("z", 0.5)]);
    tendon.actuatorfrcrange = [-3.0, 3.0];
    builder.tendons.push(tendon);
    let target = || TransmissionSpec::Tendon("t".into());
    builder.actuators = vec![
        ActuatorSpec::velocity("a", target(), 5.0),
        ActuatorSpec::velocity("b", target(), 3.0),
    ];
    let accelerations = |builder: &ModelBuilder, ctrl: &[f64]| {
        let mut sim = forward(builder, ctrl);
        sim.step().expect("finite");
        Vec::from_iter(sim.state.qvel.iter().map(|v| v / 0.01))
    };
    // From MuJoCo 4.0. The tendon's range limits both; rounding exceeds it slightly.
    for ctrl in [[0.5, 0.2], [0.1, 3.0], [3.0, 0.1]] {
        assert!(distance(&accelerations(&builder, &ctrl), &[3.0, 1.5]) < 1e-12);
    }
    // The first is clamped further, and the sum is within the tendon's range.
    builder.actuators[0].forcerange = [-2.0, 2.0];
    let found = accelerations(&builder, &[0.5, 0.2]);
    assert!(distance(&found, &[2.505_480_739_1, 1.280_717_201_6]) < 1e-9);
    let found = accelerations(&builder, &[0.1, 3.0]);
    assert!(distance(&found, &[3.0, 1.5]) < 1e-12);
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

/// Builds a box on a ball joint.
fn ball() -> ModelBuilder {
    let mut builder = world("ball");
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("ball")
            .joint(JointSpec::ball("ball"))
            .geom(GeomSpec::cuboid([0.1, 0.2, 0.3]).mass(1.0)),
    );
    builder
}

#[test]
fn a_servo_on_a_ball_takes_the_shortest_rotation() {
    let mut builder = ball();
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

/// Builds a servo of gain 3 along z with a filter of 0.1 s.
fn filtered(dynamics: DynamicsKind) -> ModelBuilder {
    let mut builder = ball();
    let target = TransmissionSpec::Joint("ball".into());
    let mut servo = ActuatorSpec::position("servo", target, 3.0, 0.0);
    servo.gear = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    servo.dynamics = dynamics;
    servo.dynprm[0] = 0.1;
    builder.actuators = vec![servo];
    builder
}

#[test]
fn a_filtered_servo_on_a_ball_takes_the_shortest_rotation() {
    // Angle, activation, control; then, from MuJoCo 4.0: rate, input of the gain, and the activation after 2 ms with a
    // filter and with an exact one.
    let cases = [
        ([0.0, 0.0, 3.0], [30.0, 0.0, 0.06, 0.059_403_980]),
        ([2.5, 5.0, 3.0], [-20.0, 5.0, 4.96, 4.960_397_347]),
        (
            [2.5, 2.4, 9.0],
            [3.168_146_928, 2.4, 2.406_336_294, 2.406_273_351],
        ),
        (
            [2.5, 9.0, 9.0],
            [0.0, 2.716_814_693, 2.716_814_693, 2.716_814_693],
        ),
        (
            [2.5, 40.0, 20.0],
            [-11.504_440_785, 2.300_888_157, 2.277_879_275, 2.278_107_838],
        ),
    ];
    for (k, dynamics) in [DynamicsKind::Filter, DynamicsKind::FilterExact]
        .into_iter()
        .enumerate()
    {
        let mut sim = sim(&filtered(dynamics));
        for ([angle, act, ctrl], expected) in cases {
            sim.reset();
            let turned = Quat::from_axis_angle(clench_math::Vec3::new(0.0, 0.0, 1.0), angle);
            turned.write(&mut sim.state.qpos);
            sim.state.act[0] = act;
            sim.set_ctrl(&[ctrl]).expect("one control");
            sim.step().expect("finite");
            let force = &sim.workspace().force;
            let input = force.actuator_force[0] / 3.0 + angle;
            let found = [force.act_dot[0], input, sim.state.act[0]];
            let expected = [expected[0], expected[1], expected[2 + k]];
            assert!(
                distance(&found, &expected) < 1e-8,
                "{dynamics:?} from {angle}, {act} to {ctrl}: {found:?}"
            );
        }
    }
}

#[test]
fn a_filtered_servo_on_a_ball_swings_through_half_a_turn_like_mujoco() {
    let mut builder = filtered(DynamicsKind::FilterExact);
    builder.actuators[0].gainprm[0] = 1.0;
    builder.actuators[0].biasprm[1..3].copy_from_slice(&[-1.0, -0.01]);
    builder.physics.timestep = 0.002;
    let mut sim = sim(&builder);
    sim.set_ctrl(&[3.0]).expect("one control");
    sim.state.qvel[2] = 2.0;
    for _ in 0..2500 {
        sim.step().expect("finite");
    }
    // From MuJoCo 4.0.
    let expected = [0.299_221_711_967, 0.0, 0.0, 0.954_183_612_880];
    let found = &sim.state.qpos;
    assert!(distance(found, &expected) < 1e-9, "{found:?}");
    assert!((sim.state.qvel[2] - 1.587_289_956_270).abs() < 1e-9);
}
