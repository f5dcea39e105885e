//! The integrator `discrete` takes the forces of springs, dampers and constraints at the end of the step.

use crate::batches::{assert_state, with};
use crate::common::{model, sim};
use crate::machines::world;
use clench_math::Instructions;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, TendonSpec, TransmissionSpec,
};
use clench_rigid::model::{Integrator, SleepPolicy};
use clench_rigid::options::RigidOptions;
use clench_rigid::{Acceleration, Batch, Precision, Sim, State};
use std::sync::Arc;

const H: f64 = 0.1;

/// Builds two cars on parallel rails, of 2 and 3 kg, without gravity.
fn cars() -> ModelBuilder {
    let mut b = world("cars");
    b.physics.gravity = [0.0; 3];
    b.physics.timestep = H;
    b.physics.integrator = Integrator::Discrete;
    for (name, mass, y) in [("left", 2.0, 0.0), ("right", 3.0, 1.0)] {
        b.add_body(
            ModelBuilder::WORLD,
            BodySpec::new(name)
                .at([0.0, y, 0.0])
                .joint(JointSpec::slide(name, [1.0, 0.0, 0.0]))
                .geom(GeomSpec::sphere(0.1).mass(mass)),
        );
    }
    b
}

/// Returns the acceleration of the first step from these positions and velocities.
fn first_step(b: &ModelBuilder, qpos: [f64; 2], qvel: [f64; 2]) -> [f64; 2] {
    let mut sim = sim(b);
    sim.state.qpos.copy_from_slice(&qpos);
    sim.state.qvel.copy_from_slice(&qvel);
    sim.step().expect("finite");
    let qacc = sim.workspace().qacc.clone();
    for i in 0..2 {
        let step = (sim.state.qvel[i] - qvel[i]) / H;
        assert!((step - qacc[i]).abs() < 1e-12 * (1.0 + step.abs()));
    }
    [qacc[0], qacc[1]]
}

fn assert_near(found: [f64; 2], expected: [f64; 2]) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a}, not {b}");
    }
}

/// Solves [[a, b], [b, c]] x = y.
fn solve(a: f64, b: f64, c: f64, y: [f64; 2]) -> [f64; 2] {
    let det = a * c - b * b;
    [(c * y[0] - b * y[1]) / det, (a * y[1] - b * y[0]) / det]
}

#[test]
fn springs_are_evaluated_at_the_end_of_the_step() {
    let (k, d, m, x, v) = (400.0, 3.0, 2.0, 0.2, -1.5);
    let mut b = cars();
    let joint = &mut b.bodies[1].joints[0];
    (joint.stiffness[0], joint.damping[0]) = (k, d);
    // m (v' − v) / h = −k (x + h v') − d v'.
    let after = (m * v / H - k * x) / (m / H + k * H + d);
    let acceleration = first_step(&b, [x, 0.0], [v, 0.0])[0];
    assert_near([acceleration, 0.0], [(after - v) / H, 0.0]);
}

/// A tendon with the length l = x₀ − 2 x₁ couples trees that form no chain in the mass matrix.
#[test]
fn a_tendon_couples_trees_within_the_step() {
    let (k, d, x, v) = (500.0, 4.0, [0.3, -0.1], [0.4, 0.7]);
    let mut b = cars();
    let mut tendon = TendonSpec::fixed("rope", &[("left", 1.0), ("right", -2.0)]);
    (tendon.stiffness[0], tendon.damping[0]) = (k, d);
    tendon.springlength = Some([0.0, 0.0]);
    b.tendons.push(tendon);
    let (length, rate) = (x[0] - 2.0 * x[1], v[0] - 2.0 * v[1]);
    let s = H * d + H * H * k;
    let pull = -k * (length + H * rate) - d * rate;
    let expected = solve(2.0 + s, -2.0 * s, 3.0 + 4.0 * s, [pull, -2.0 * pull]);
    assert_near(first_step(&b, x, v), expected);
    // The acceleration without constraints is equal, and the constraint forces are zero.
    let mut sim = sim(&b);
    sim.state.qpos.copy_from_slice(&x);
    sim.state.qvel.copy_from_slice(&v);
    sim.forward().expect("finite");
    let smooth = &sim.workspace().problem.qacc_smooth;
    assert_near([smooth[0], smooth[1]], expected);
    let held = sim.output("qfrc_constraint").expect("an output");
    assert!(held.iter().all(|force| force.abs() < 1e-9), "{held:?}");
    // In its dead band the tendon is slack.
    b.tendons[0].springlength = Some([-9.0, 9.0]);
    b.tendons[0].damping[0] = 0.0;
    assert_eq!(first_step(&b, x, v), [0.0; 2]);
}

fn servo(b: &mut ModelBuilder, target: TransmissionSpec, kp: f64) {
    b.actuators
        .push(ActuatorSpec::position("servo", target, kp, 0.0));
}

#[test]
fn a_stiff_servo_is_stable_at_any_step() {
    let mut b = cars();
    servo(&mut b, TransmissionSpec::Joint("left".into()), 1e9);
    let mut sim = sim(&b);
    sim.state.qpos[0] = 1.0;
    sim.step().expect("finite");
    sim.step().expect("finite");
    assert!(sim.state.qpos[0].abs() < 1e-5 && sim.state.qvel[0].abs() < 1e-3);
}

#[test]
fn a_saturated_servo_is_not_in_the_metric() {
    let mut b = cars();
    servo(&mut b, TransmissionSpec::Joint("left".into()), 1e4);
    b.actuators[0].forcerange = [-3.0, 3.0];
    let found = first_step(&b, [1.0, 0.0], [0.5, 0.0]);
    assert_near(found, [-3.0 / 2.0, 0.0]);
}

#[test]
fn inverse_dynamics_undo_a_step_with_couplings() {
    let mut b = cars();
    let mut tendon = TendonSpec::fixed("rope", &[("left", 1.0), ("right", -2.0)]);
    (tendon.stiffness[0], tendon.damping[0]) = (300.0, 4.0);
    b.tendons.push(tendon);
    servo(&mut b, TransmissionSpec::Tendon("rope".into()), 50.0);
    let mut sim = sim(&b);
    sim.state.qpos.copy_from_slice(&[0.2, 0.3]);
    sim.state.qvel.copy_from_slice(&[-0.4, 0.9]);
    sim.state.ctrl[0] = 0.7;
    sim.forward().expect("finite");
    let qacc = sim.workspace().qacc.clone();
    let given = sim.output("qfrc_actuator").expect("an output");
    for kind in [Acceleration::Continuous, Acceleration::Discrete] {
        let mut found = vec![0.0; 2];
        sim.inverse(&qacc, kind, &mut found).expect("finite");
        let scale = given[0].abs().max(given[1].abs());
        for (a, b) in found.iter().zip(&given) {
            assert!((a - b).abs() < 1e-10 * scale, "{a}, not {b}");
        }
    }
}

/// Compares lanes with single simulations. In some environments the rope is slack, the left car is at the end of its
/// rail, or the right car rubs on a plate.
fn couplings_in_lanes<S: Precision>(rigid: &RigidOptions) {
    const ENVS: usize = 21;
    let mut b = cars();
    b.physics.timestep = 0.01;
    b.physics.flags.constraint = true;
    b.bodies[1].joints[0] = std::mem::take(&mut b.bodies[1].joints[0]).limited(-0.2, 0.2);
    let plate = GeomSpec::cuboid([0.3, 0.2, 0.1]).at([-0.35, 1.0, -0.199]);
    b.add_ground(plate);
    let mut tendon = TendonSpec::fixed("rope", &[("left", 1.0), ("right", -2.0)]);
    tendon.stiffness = [300.0, 20.0, 5.0];
    tendon.springlength = Some([-0.3, 0.3]);
    b.tendons.push(tendon);
    let model = model(&b);
    let start = |env: usize| {
        let mut state = State::<S>::new(&model);
        let x = env as f64 / ENVS as f64;
        for (to, from) in (state.qpos.iter_mut()).zip([0.5 * x - 0.25, 0.6 * x * x - 0.3]) {
            *to = S::new(from);
        }
        for (to, from) in (state.qvel.iter_mut()).zip([2.0 * x - 1.0, 0.5 - x]) {
            *to = S::new(from);
        }
        state
    };
    let (mut slack, mut rubs) = (0, 0);
    let ends: Vec<State<S>> = (0..ENVS)
        .map(|env| {
            let alone = Sim::<S>::with_options(Arc::clone(&model), *rigid);
            let mut sim = alone.expect("valid");
            sim.state = start(env);
            for _ in 0..40 {
                sim.step().expect("finite");
                slack += usize::from(!sim.workspace().metric.is_coupled());
                rubs += usize::from(!sim.workspace().contacts.is_empty());
            }
            sim.state
        })
        .collect();
    for count in [slack, rubs] {
        assert!((100..ENVS * 40 - 100).contains(&count), "{count}");
    }
    for instructions in Instructions::all_available::<S>() {
        let options = with(instructions, 1, *rigid);
        let mut batch = Batch::<S>::with_options(Arc::clone(&model), ENVS, options).expect("valid");
        for env in 0..ENVS {
            batch.state.write(env, &start(env)).expect("valid");
        }
        batch.step_n(40).expect("valid");
        for (env, end) in ends.iter().enumerate() {
            assert_state(&batch, env, end, &|| format!("{instructions:?}"));
        }
    }
}

#[test]
fn couplings_are_the_same_in_lanes() {
    for sweeps in [0, 3] {
        let rigid = RigidOptions::default().noslip_iterations(sweeps);
        couplings_in_lanes::<f64>(&rigid);
        couplings_in_lanes::<f32>(&rigid);
    }
}

/// A ball falls on a floor as stiff as the step resolves. It stays there, neither below nor thrown back.
#[test]
fn a_contact_that_the_step_cannot_resolve_does_not_rebound() {
    let mut b = ModelBuilder::new("ball");
    b.physics.timestep = 0.01;
    b.physics.integrator = Integrator::Discrete;
    b.options = RigidOptions::new().constraint_timeconst(0.0);
    let mut floor = GeomSpec::plane();
    (floor.solref, floor.priority) = ([1e-5, 1.0], 1);
    (floor.solimp[0], floor.solimp[1]) = (0.9999, 0.9999);
    b.add_ground(floor);
    let ball = BodySpec::new("ball")
        .at([0.0, 0.0, 0.0999])
        .joint(JointSpec::slide("fall", [0.0, 0.0, 1.0]))
        .geom(GeomSpec::sphere(0.1).mass(1.0));
    b.add_body(ModelBuilder::WORLD, ball);
    let mut sim = sim(&b);
    sim.state.qvel[0] = -2.0;
    for _ in 0..200 {
        sim.step().expect("finite");
        assert!(sim.state.qvel[0] < 0.2, "{}", sim.state.qvel[0]);
    }
    let depth = -(sim.state.qpos[0] - 1e-4);
    assert!((0.0..1e-3).contains(&depth), "{depth}");
}

#[test]
fn unsupported_combinations_are_refused_by_name() {
    let mut b = cars();
    b.tendons
        .push(TendonSpec::fixed("rope", &[("left", 1.0), ("right", -2.0)]));
    let rope = TransmissionSpec::Tendon("rope".to_owned());
    (b.actuators).push(ActuatorSpec::position("winch", rope, 1.0, 1.0));
    b.physics.flags.sleep = true;
    let refusal = |b: &ModelBuilder, options: RigidOptions| {
        let error = Sim::<f64>::with_options(model(b), options).err();
        error.expect("refused").to_string()
    };
    assert!(
        Sim::<f64>::new(model(&b)).is_ok(),
        "what actuators act on never sleeps"
    );
    b.bodies[1].sleep = SleepPolicy::Allowed;
    let sleep = refusal(&b, RigidOptions::new());
    assert!(sleep.contains("sleep and actuator \"winch\""), "{sleep}");
    b.bodies[1].sleep = SleepPolicy::Auto;
    b.actuators.clear();
    b.physics.flags.island = false;
    let islands = refusal(&b, RigidOptions::new());
    assert!(islands.contains("sleep without islands"), "{islands}");
    b.physics.flags.island = true;
    assert!(Sim::<f64>::new(Arc::clone(&model(&b))).is_ok());
}
