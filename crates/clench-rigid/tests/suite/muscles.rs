//! Muscles, and the length ranges that they need.

use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, TransmissionSpec,
};
use clench_rigid::model::{BiasKind, DynamicsKind, GainKind};
use clench_rigid::{Budget, Model, Sim};
use std::sync::Arc;

/// Returns a muscle on a slider that is limited to [−0.1, 0.2] m.
fn muscle() -> ActuatorSpec {
    let mut spec = ActuatorSpec::motor("muscle", TransmissionSpec::Joint("slide".into()), 1.0);
    let prm = [0.75, 1.05, 30.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2, 0.0];
    (spec.dynamics, spec.gain, spec.bias) =
        (DynamicsKind::Muscle, GainKind::Muscle, BiasKind::Muscle);
    (spec.dynprm, spec.gainprm, spec.biasprm) = ([0.01; 10], prm, prm);
    spec.dynprm[2] = 0.0;
    spec
}

fn slider(spec: ActuatorSpec, change: impl FnOnce(&mut ModelBuilder)) -> Result<Model, String> {
    let mut builder = ModelBuilder::new("slider");
    let mut joint = JointSpec::slide("slide", [1.0, 0.0, 0.0]);
    joint.range = [-0.1, 0.2];
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("block")
            .joint(joint)
            .geom(GeomSpec::sphere(0.1).mass(2.0)),
    );
    builder.actuators.push(spec);
    change(&mut builder);
    builder.build().map_err(|error| error.to_string())
}

fn sim(spec: ActuatorSpec) -> Sim {
    Sim::new(Arc::new(slider(spec, |_| ()).expect("valid"))).expect("valid")
}

#[test]
fn a_muscle_pulls_only() {
    let mut sim = sim(muscle());
    for k in 0..200 {
        let x = f64::from(k) / 200.0;
        sim.set_configuration(&[0.6 * x - 0.3], &[4.0 * x - 2.0])
            .expect("valid");
        sim.state.act[0] = x;
        sim.forward().expect("valid");
        assert!(sim.workspace().force.actuator_force[0] <= 0.0);
    }
}

#[test]
fn a_muscle_is_strongest_at_its_resting_length_and_has_no_force_when_it_shortens_fastest() {
    let mut spec = muscle();
    spec.lengthrange = [-0.25, 0.05];
    let mut sim = sim(spec);
    let mut force = |q: f64, v: f64| {
        sim.set_configuration(&[q], &[v]).expect("valid");
        sim.state.act[0] = 1.0;
        sim.forward().expect("valid");
        sim.workspace().force.actuator_force[0]
    };
    // L₀ is 0.3 / 0.3 = 1 m, so that L = 1 at q = 0 and V = −1 at 1.5 m/s.
    assert!((force(0.0, 0.0) + 30.0).abs() < 1e-12);
    assert!(force(0.0, -1.5).abs() < 1e-12);
    assert!((force(0.0, 2.0) + 1.2 * 30.0).abs() < 1e-12);
    assert!(force(-0.1, 0.0) > -30.0);
}

#[test]
fn a_length_range_that_is_not_given_is_as_far_as_the_limits_yield() {
    let model = slider(muscle(), |_| ()).expect("valid");
    let [low, high] = model.params.actuator_lengthrange[0];
    assert!(
        (-0.11..-0.1).contains(&low) && (0.2..0.21).contains(&high),
        "{low} {high}"
    );
    let copied = slider(muscle(), |b| b.compiler.lengthrange.uselimit = true).expect("valid");
    assert_eq!(copied.params.actuator_lengthrange[0], [-0.1, 0.2]);
    assert!((model.params.actuator_acc0[0] - 0.5).abs() < 1e-15);
}

#[test]
fn a_model_without_constraints_has_the_length_ranges_that_it_would_have_with_them() {
    let free = slider(muscle(), |b| {
        b.physics.flags.constraint = false;
        b.options.disable_constraint = Some(true);
        b.options.enable_joint_limit = Some(false);
    });
    let (free, held) = (
        free.expect("valid"),
        slider(muscle(), |_| ()).expect("valid"),
    );
    let range = |model: &Model| model.params.actuator_lengthrange[0];
    assert_eq!(range(&free), range(&held));
}

#[test]
fn an_unbounded_length_is_an_error() {
    let endless = slider(muscle(), |b| b.bodies[1].joints[0].limited = Some(false));
    assert!(endless.unwrap_err().contains("did not converge"));
    let short = slider(muscle(), |b| b.compiler.lengthrange.inttotal = 0.0);
    assert!(short.unwrap_err().contains("is not increasing"));
}

#[test]
fn the_search_for_length_ranges_has_a_budget() {
    let long = slider(muscle(), |b| b.compiler.lengthrange.inttotal = 1e9);
    assert!(long.unwrap_err().contains("steps"));
    let small = slider(muscle(), |b| {
        b.budget = Budget {
            steps: 100,
            ..Budget::default()
        };
    });
    assert!(small.unwrap_err().contains("more than 100"));
}

#[test]
fn invalid_muscles_are_errors() {
    let with = |index: usize, value: f64| {
        let mut spec = muscle();
        spec.gainprm[index] = value;
        slider(spec, |_| ()).unwrap_err()
    };
    assert!(with(0, 1.05).contains("range must be increasing"));
    assert!(with(4, 1.0).contains("lmin must be below 1"));
    assert!(with(5, 0.9).contains("lmin must be below 1"));
    for index in [3, 6, 7, 8] {
        assert!(with(index, 0.0).contains("must be positive"));
    }
}
