//! Integrators: order, conservation, and exact cases.

use crate::machines::{distance, floating, shake, sim, turn_between, world};
use clench_math::{Quat, Vec3};
use clench_rigid::Sim;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, TransmissionSpec,
};
use clench_rigid::model::{DynamicsKind, Integrator};

/// Steps for `time` seconds at time step `h`.
fn after(builder: &ModelBuilder, h: f64, time: f64) -> Sim {
    let mut sim = sim(builder);
    sim.set_timestep(h).expect("a time step");
    shake(&mut sim, 7);
    let steps = (time / h).round() as usize;
    for _ in 0..steps {
        sim.step().expect("the motion stays finite");
    }
    sim
}

/// Returns the distance of two configurations, of orientations by angle.
fn pose_distance(a: &Sim, b: &Sim) -> f64 {
    for sim in [a, b] {
        assert_eq!(sim.state.qpos.len(), 16);
    }
    let quat = |sim: &Sim, at: usize| Quat::from_slice(&sim.state.qpos[at..]);
    let (trunk, arm) = (
        turn_between(quat(a, 3), quat(b, 3)),
        turn_between(quat(a, 7), quat(b, 7)),
    );
    let rest = distance(&a.state.qpos[11..], &b.state.qpos[11..]);
    let place = distance(&a.state.qpos[..3], &b.state.qpos[..3]);
    trunk.norm().max(arm.norm()).max(rest).max(place)
}

/// Returns the factor by which half the time step shrinks the error, against a much finer solution.
fn error_ratio(integrator: Integrator, h: f64) -> f64 {
    let mut builder = floating();
    builder.physics.integrator = integrator;
    let mut fine = builder.clone();
    fine.physics.integrator = Integrator::Rk4;
    let exact = after(&fine, h / 16.0, 0.4);
    let error = |h| pose_distance(&after(&builder, h, 0.4), &exact);
    error(h) / error(0.5 * h)
}

#[test]
fn runge_kutta_is_of_fourth_order_in_orientations_too() {
    let ratio = error_ratio(Integrator::Rk4, 0.02);
    assert!((13.0..20.0).contains(&ratio), "{ratio}");
}

/// MuJoCo also keeps the results of the last stage.
#[test]
fn after_runge_kutta_an_actuator_moves_as_its_joint_did_in_the_last_stage() {
    let mut builder = world("bob");
    builder.physics.integrator = Integrator::Rk4;
    let bob = GeomSpec::capsule(0.02, 0.2).at([0.3, 0.0, 0.0]).mass(1.0);
    let joint = JointSpec::hinge("swing", [0.0, 1.0, 0.0]);
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("bob").joint(joint).geom(bob),
    );
    let target = TransmissionSpec::Joint("swing".into());
    builder
        .actuators
        .push(ActuatorSpec::motor("motor", target, 3.0));
    let mut sim = sim(&builder);
    sim.step().expect("a good state");
    // The body's angular velocity about the world's y axis, the joint's axis.
    let spin = sim.workspace().velocity.cvel[1].angular.y;
    let found = sim.workspace().velocity.actuator_velocity[0];
    assert!(spin != 0.0 && (found - 3.0 * spin).abs() < 1e-12 * spin.abs());
}

#[test]
fn euler_and_implicit_are_of_first_order() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Discrete,
    ] {
        let ratio = error_ratio(integrator, 0.001);
        assert!((1.8..2.2).contains(&ratio), "{integrator:?}: {ratio}");
    }
}

#[test]
fn energy_is_conserved_to_the_order_of_the_integrator() {
    let drift = |integrator, h| {
        let mut builder = floating();
        builder.physics.integrator = integrator;
        let mut start = sim(&builder);
        shake(&mut start, 7);
        let total = |sim: &mut Sim| {
            let energy = sim.energy().expect("finite");
            energy.kinetic + energy.potential
        };
        (total(&mut after(&builder, h, 0.4)) - total(&mut start)).abs()
    };
    let ratio = drift(Integrator::Euler, 0.001) / drift(Integrator::Euler, 0.0005);
    assert!((1.8..2.2).contains(&ratio), "{ratio}");
    // Fourth order, or higher where the leading error changes its sign.
    let ratio = drift(Integrator::Rk4, 0.02) / drift(Integrator::Rk4, 0.01);
    assert!(ratio > 12.0, "{ratio}");
    assert!(drift(Integrator::Rk4, 0.005) < 1e-6);
}

#[test]
fn momentum_is_conserved_in_free_fall_without_gravity() {
    let mut builder = floating();
    builder.physics.gravity = [0.0; 3];
    builder.physics.integrator = Integrator::Rk4;
    let motor =
        |joint: &str, gear| ActuatorSpec::motor(joint, TransmissionSpec::Joint(joint.into()), gear);
    builder.actuators = vec![motor("knee", 2.0), motor("wrist", -1.5)];
    let momentum = |sim: &mut Sim| {
        sim.forward().expect("finite");
        let ws = sim.workspace();
        let com = ws.position.subtree_com[1];
        let pairs = ws.position.cinert.iter().zip(&ws.velocity.cvel);
        let (angular, linear) = pairs.fold((Vec3::ZERO, Vec3::ZERO), |(l, p), (&i, &v)| {
            let momentum = i * v;
            (l + momentum.angular, p + momentum.linear)
        });
        (angular + com.cross(linear), linear)
    };
    let mut start = sim(&builder);
    shake(&mut start, 7);
    let (angular0, linear0) = momentum(&mut start);
    let (angular, linear) = momentum(&mut after(&builder, 0.002, 1.0));
    assert!((angular - angular0).norm() < 1e-8 * angular0.norm());
    assert!((linear - linear0).norm() < 1e-8 * linear0.norm());
}

fn slider(mass: f64) -> ModelBuilder {
    let mut builder = world("slider");
    builder.physics.gravity = [0.0; 3];
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("car")
            .joint(JointSpec::slide("x", [1.0, 0.0, 0.0]))
            .geom(GeomSpec::sphere(0.1).mass(mass)),
    );
    builder
}

/// Returns the velocity after a step from 1 m/s at h = 0.1 s.
fn velocity_after_step(builder: &ModelBuilder) -> f64 {
    let mut sim = sim(builder);
    sim.set_timestep(0.1).expect("a time step");
    sim.state.qvel[0] = 1.0;
    sim.step().expect("finite");
    sim.state.qvel[0]
}

#[test]
fn damping_is_evaluated_at_the_end_of_the_step() {
    let mut builder = slider(2.0);
    builder.bodies[1].joints[0].damping[0] = 30.0;
    // m (v' − v) = −h b v', however large h b / m.
    let implicit = 1.0 / (1.0 + 0.1 * 30.0 / 2.0);
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Discrete,
    ] {
        builder.physics.integrator = integrator;
        assert!((velocity_after_step(&builder) - implicit).abs() < 1e-15);
    }
    builder.physics.integrator = Integrator::Euler;
    builder.physics.flags.eulerdamp = false;
    assert!((velocity_after_step(&builder) - (1.0 - 0.1 * 30.0 / 2.0)).abs() < 1e-15);
}

#[test]
fn servos_are_implicit_only_while_they_are_not_saturated() {
    let servo = |forcerange| {
        let mut builder = slider(2.0);
        let mut servo = ActuatorSpec::velocity("v", TransmissionSpec::Joint("x".into()), 30.0);
        servo.forcerange = forcerange;
        builder.actuators.push(servo);
        builder.physics.integrator = Integrator::ImplicitFast;
        builder
    };
    let free = velocity_after_step(&servo([0.0; 2]));
    assert!((free - 1.0 / (1.0 + 0.1 * 30.0 / 2.0)).abs() < 1e-15);
    let held = velocity_after_step(&servo([-4.0, 4.0]));
    assert!((held - (1.0 - 0.1 * 4.0 / 2.0)).abs() < 1e-15);
    let mut by_joint = servo([0.0; 2]);
    by_joint.bodies[1].joints[0].actuatorfrcrange = [-4.0, 4.0];
    assert!((velocity_after_step(&by_joint) - held).abs() < 1e-15);
}

/// Builds a spinning body with a welded part and a joint away from its centre of mass.
fn tumbler() -> ModelBuilder {
    let mut builder = world("tumbler");
    builder.physics.gravity = [0.0; 3];
    builder.physics.integrator = Integrator::ImplicitFast;
    let body = builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("body")
            .joint(JointSpec::free("root"))
            .geom(GeomSpec::cuboid([0.1, 0.2, 0.4]).at([0.1, 0.05, 0.0])),
    );
    builder.add_body(
        body,
        BodySpec::new("fin")
            .at([0.2, 0.0, 0.3])
            .geom(GeomSpec::cuboid([0.1, 0.3, 0.02])),
    );
    builder
}

#[test]
fn a_tumbling_body_gains_no_energy() {
    let mut builder = tumbler();
    builder.bodies.truncate(2);
    builder.bodies[1].geoms[0].pos = Vec3::ZERO;
    let mut sim = sim(&builder);
    sim.set_timestep(0.01).expect("a time step");
    sim.state.qvel[3..].copy_from_slice(&[0.3, 8.0, 0.4]);
    let mut last = sim.energy().expect("finite").kinetic;
    for _ in 0..2000 {
        sim.step().expect("finite");
        let kinetic = sim.energy().expect("finite").kinetic;
        assert!(kinetic <= last * (1.0 + 1e-12));
        last = kinetic;
    }
}

/// (M + h ∂bias/∂v) a = −bias, with the derivative by differences.
#[test]
fn a_single_body_is_solved_with_its_gyroscopic_derivatives() {
    let builder = tumbler();
    let mut sim = sim(&builder);
    sim.set_timestep(0.02).expect("a time step");
    shake(&mut sim, 3);
    sim.forward().expect("finite");
    let start = sim.state.clone();
    let mass = clench_rigid::readout::mass_matrix(sim.workspace(), 0);
    let bias = sim.workspace().force.qfrc_bias.clone();
    let delta = 1e-4;
    let mut slope = [[0.0; 6]; 6];
    for k in 0..6 {
        for sign in [1.0, -1.0] {
            sim.state.qvel[k] = start.qvel[k] + sign * delta;
            sim.forward().expect("finite");
            for (row, &b) in slope.iter_mut().zip(&sim.workspace().force.qfrc_bias) {
                row[k] += sign * b / (2.0 * delta);
            }
        }
        sim.state.qvel[k] = start.qvel[k];
    }
    sim.step().expect("finite");
    let a: Vec<f64> = (0..6)
        .map(|i| (sim.state.qvel[i] - start.qvel[i]) / 0.02)
        .collect();
    for r in 0..6 {
        let left: f64 = (0..6)
            .map(|c| (mass[r * 6 + c] + 0.02 * slope[r][c]) * a[c])
            .sum();
        assert!((left + bias[r]).abs() < 1e-8, "row {r}");
    }
}

#[test]
fn activations_follow_their_dynamics() {
    let step = |dynamics, integrator, actrange| {
        let mut builder = slider(1.0);
        builder.physics.integrator = integrator;
        let mut motor = ActuatorSpec::motor("m", TransmissionSpec::Joint("x".into()), 1.0);
        motor.dynamics = dynamics;
        motor.dynprm[0] = 0.3;
        motor.actrange = actrange;
        builder.actuators.push(motor);
        let mut sim = sim(&builder);
        sim.set_timestep(0.1).expect("a time step");
        sim.state.act[0] = 0.2;
        sim.state.ctrl[0] = 1.0;
        sim.step().expect("finite");
        sim.state.act[0]
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    let (euler, rk4) = (Integrator::Euler, Integrator::Rk4);
    near(step(DynamicsKind::Integrator, euler, [0.0; 2]), 0.3);
    near(
        step(DynamicsKind::Filter, euler, [0.0; 2]),
        0.2 + 0.1 * 0.8 / 0.3,
    );
    let decay = (-0.1f64 / 0.3).exp();
    near(
        step(DynamicsKind::FilterExact, euler, [0.0; 2]),
        1.0 - 0.8 * decay,
    );
    near(step(DynamicsKind::Integrator, euler, [-1.0, 0.25]), 0.25);
    // Runge–Kutta follows the series of the exponential to fourth order.
    let x: f64 = -0.1 / 0.3;
    let series = 1.0 + x + x * x / 2.0 + x.powi(3) / 6.0 + x.powi(4) / 24.0;
    near(
        step(DynamicsKind::Filter, rk4, [0.0; 2]),
        1.0 - 0.8 * series,
    );
}

#[test]
fn early_activation_acts_in_the_same_step() {
    let velocity = |actearly| {
        let mut builder = slider(1.0);
        let mut motor = ActuatorSpec::motor("m", TransmissionSpec::Joint("x".into()), 1.0);
        motor.dynamics = DynamicsKind::Integrator;
        motor.actearly = actearly;
        builder.actuators.push(motor);
        let mut sim = sim(&builder);
        sim.set_timestep(0.1).expect("a time step");
        sim.state.ctrl[0] = 2.0;
        sim.step().expect("finite");
        sim.state.qvel[0]
    };
    assert_eq!(velocity(false), 0.0);
    assert!((velocity(true) - 0.1 * 0.2).abs() < 1e-15);
}
