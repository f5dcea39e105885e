//! Servos that control an orientation.

use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, SensorSpec, TransmissionSpec,
};
use clench_rigid::model::{
    BiasKind, ControlInput, DynamicsKind, GainKind, Integrator, JointKind, SensorKind,
};
use clench_rigid::{Batch, Model, Sim};
use std::sync::Arc;

const KP: f64 = 3.0;
const KV: f64 = 0.5;

fn servo() -> ActuatorSpec {
    let mut servo = ActuatorSpec::motor("servo", TransmissionSpec::Joint("ball".into()), 1.0);
    servo.gain = GainKind::So3;
    servo.bias = BiasKind::So3;
    servo.gainprm[0] = KP;
    servo.biasprm[1] = -KP;
    servo.biasprm[2] = -KV;
    servo
}

/// Builds a box on a ball joint without gravity, and its servo.
fn build(servo: ActuatorSpec) -> Result<Arc<Model>, String> {
    let mut builder = ModelBuilder::new("turning");
    builder.physics.gravity = [0.0; 3];
    builder.physics.integrator = Integrator::ImplicitFast;
    let mut ball = JointSpec::hinge("ball", [0.0, 0.0, 1.0]);
    ball.kind = JointKind::Ball;
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("block")
            .joint(ball)
            .geom(GeomSpec::cuboid([0.1, 0.2, 0.3]).mass(2.0)),
    );
    builder.actuators.push(servo);
    let sensor = SensorSpec::new(SensorKind::ActuatorFrc, "servo");
    builder.sensors.push(sensor);
    let built = builder.build().map(Arc::new);
    built.map_err(|error| error.to_string())
}

fn orientation(sim: &Sim) -> Quat<f64> {
    Quat::from_slice(&sim.state.qpos)
}

#[test]
fn the_body_comes_to_rest_in_the_commanded_orientation() {
    let model = build(servo()).expect("valid");
    assert_eq!((model.nu(), model.nout(), model.nsensordata()), (3, 3, 3));
    let target = Vec3::new(0.5, -1.0, 0.7);
    let mut sim = Sim::new(model).expect("valid");
    target.write(&mut sim.state.ctrl);
    for _ in 0..10_000 {
        sim.step().expect("finite");
    }
    let left = Quat::from_rotation_vector(target).difference(orientation(&sim));
    assert!(left.norm() < 1e-6, "{left:?}");
}

#[test]
fn the_norm_of_a_commanded_quaternion_is_irrelevant() {
    let mut by_quaternion = servo();
    by_quaternion.inputs = Some(vec![ControlInput::Quaternion; 4]);
    let target = Vec3::new(0.5, -1.0, 0.7);
    let mut vector = Sim::new(build(servo()).expect("valid")).expect("valid");
    target.write(&mut vector.state.ctrl);
    vector.forward().expect("finite");
    let expected = Vec3::from_slice(&vector.workspace().force.qfrc_actuator);
    let mut sim = Sim::new(build(by_quaternion).expect("valid")).expect("valid");
    assert_eq!(sim.state.ctrl, [1.0, 0.0, 0.0, 0.0], "at first no rotation");
    let quaternion = Quat::from_rotation_vector(target).to_array();
    for scale in [1.0, -1.0, 7.0] {
        sim.state
            .ctrl
            .copy_from_slice(&quaternion.map(|x| scale * x));
        sim.forward().expect("finite");
        let found = Vec3::from_slice(&sim.workspace().force.qfrc_actuator);
        assert!((found - expected).norm() < 1e-12, "{found:?}");
    }
}

#[test]
fn the_limit_holds_the_norm_and_keeps_the_direction() {
    let mut limited = servo();
    limited.forcerange = [0.0, 0.2];
    let mut sim = Sim::new(build(limited).expect("valid")).expect("valid");
    sim.state.ctrl.copy_from_slice(&[0.3, 0.4, 0.0]);
    sim.forward().expect("finite");
    let torque = Vec3::from_slice(&sim.workspace().force.actuator_force);
    assert!(
        (torque - Vec3::new(0.12, 0.16, 0.0)).norm() < 1e-12,
        "{torque:?}"
    );
}

#[test]
fn an_integrated_target_stays_within_half_a_turn() {
    let mut integrated = servo();
    integrated.dynamics = DynamicsKind::Integrator;
    let model = build(integrated).expect("valid");
    assert_eq!(model.na, 3);
    let mut sim = Sim::new(model).expect("valid");
    sim.state.ctrl.copy_from_slice(&[0.0, 2.0, 0.0]);
    let mut largest: f64 = 0.0;
    for _ in 0..5_000 {
        sim.step().expect("finite");
        largest = largest.max(Vec3::from_slice(&sim.state.act).norm());
    }
    assert!(
        largest < std::f64::consts::PI + 0.01 && largest > 3.0,
        "{largest}"
    );
}

#[test]
fn environments_of_a_batch_move_as_alone() {
    let mut limited = servo();
    limited.forcerange = [0.0, 0.6];
    let model = build(limited).expect("valid");
    let mut batch = Batch::<f64>::new(model.clone(), 5).expect("valid");
    let mut alone = Vec::new();
    for env in 0..5 {
        let mut sim = Sim::new(model.clone()).expect("valid");
        let k = env as f64;
        sim.state.ctrl.copy_from_slice(&[k - 2.0, 0.4 * k, 3.0 - k]);
        sim.state.qvel.copy_from_slice(&[k, -1.0, 0.2 * k]);
        batch.state.write(env, &sim.state).expect("fits");
        for _ in 0..200 {
            sim.step().expect("finite");
        }
        alone.extend_from_slice(&sim.state.qpos);
    }
    batch.step_n(200).expect("finite");
    assert_eq!(batch.state.qpos.as_slice(), alone);
}

#[test]
fn orientation_servos_that_cannot_be_are_refused() {
    let refused = |change: fn(&mut ActuatorSpec)| {
        let mut servo = servo();
        change(&mut servo);
        build(servo).expect_err("wrong")
    };
    let of_one_kind = refused(|servo| servo.bias = BiasKind::Affine);
    assert!(of_one_kind.contains("so3"), "{of_one_kind}");
    assert!(refused(|servo| servo.gainprm[0] = 1.0).contains("gainprm"));
    assert!(refused(|servo| servo.dynamics = DynamicsKind::Filter).contains("integrator"));
    assert!(refused(|servo| servo.forcerange = [-1.0, 1.0]).contains("norm"));
    assert!(refused(|servo| servo.inputs = Some(vec![ControlInput::Position])).contains("expmap"));
    let parent = |servo: &mut ActuatorSpec| {
        servo.transmission = TransmissionSpec::JointInParent("ball".into());
    };
    assert!(refused(parent).contains("ball joint"));
}
