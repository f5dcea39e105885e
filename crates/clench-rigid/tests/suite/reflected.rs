//! Damping and armature that actuators add to their targets.

use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, TransmissionSpec,
};
use clench_rigid::model::Integrator;
use clench_rigid::{Model, Sim};
use std::sync::Arc;

/// Builds a bar that turns, with an actuator of gear 2; `change` edits both.
fn bar(change: impl FnOnce(&mut JointSpec, &mut ActuatorSpec)) -> Arc<Model> {
    let mut joint = JointSpec::hinge("turn", [0.0, 1.0, 0.0]);
    let target = TransmissionSpec::Joint("turn".into());
    let mut actuator = ActuatorSpec::motor("motor", target, 2.0);
    change(&mut joint, &mut actuator);
    let mut builder = ModelBuilder::new("bar");
    let geom = GeomSpec::capsule(0.02, 0.25).at([0.3, 0.0, 0.0]).mass(0.5);
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("bar").joint(joint).geom(geom),
    );
    builder.actuators.push(actuator);
    Arc::new(builder.build().expect("valid"))
}

fn path(model: Arc<Model>, set: impl FnOnce(&mut Sim)) -> Vec<f64> {
    let mut sim = Sim::new(model).expect("valid");
    set(&mut sim);
    sim.state.qvel[0] = 3.0;
    sim.state.ctrl[0] = 0.2;
    let mut path = Vec::new();
    for _ in 0..200 {
        sim.step().expect("finite");
        path.push(sim.state.qpos[0]);
    }
    path
}

/// Powers of two avoid different rounding.
#[test]
fn a_gear_reflects_damping_and_armature_by_its_square() {
    for integrator in [Integrator::Euler, Integrator::ImplicitFast, Integrator::Rk4] {
        let with = |model: Arc<Model>| {
            let mut model = Arc::unwrap_or_clone(model);
            model.integrator = integrator;
            path(Arc::new(model), |_| ())
        };
        let own = bar(|joint, _| {
            joint.damping = [0.5, 0.25, 0.125];
            joint.armature = 0.0625;
        });
        let reflected = bar(|_, actuator| {
            actuator.damping = [0.125, 0.0625, 0.03125];
            actuator.armature = 0.015625;
        });
        assert_eq!(own.params.dof_invweight0, reflected.params.dof_invweight0);
        assert_eq!(with(own), with(reflected));
    }
}

#[test]
fn damping_set_on_an_undamped_joint_acts() {
    let built = bar(|_, actuator| actuator.damping = [0.125, 0.0, 0.0]);
    let set = path(bar(|_, _| ()), |sim| {
        sim.set_param("actuator_damping", &[0.125]).expect("valid");
    });
    assert_eq!(path(built, |_| ()), set);
    assert_ne!(path(bar(|_, _| ()), |_| ()), set);
}
