//! Compares gradients of rollouts with products of the matrices of each step.

use crate::common::{Random, elliptic, load};
use clench_derivatives::{BatchLinearizer, Linearizer, Matrix, Request};
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, Model, Sim};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const STEPS: usize = 6;

fn random_matrix(random: &mut Random, columns: usize) -> Matrix {
    Matrix {
        shape: [STEPS, columns],
        values: (0..STEPS * columns).map(|_| random.next()).collect(),
    }
}

/// Returns the product of a row vector and a matrix.
fn product(row: &[f64], matrix: &Matrix) -> Vec<f64> {
    let [rows, columns] = matrix.shape;
    assert_eq!(row.len(), rows);
    let entry = |column| (0..rows).map(move |k| row[k] * matrix.values[k * columns + column]);
    (0..columns).map(|column| entry(column).sum()).collect()
}

fn assert_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let size = expected.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() <= 1e-9 * size,
            "{found} is not {expected}"
        );
    }
}

/// Returns the simulation after the rollout.
fn check(model: Model, options: RigidOptions, before: usize, memory: bool) -> Sim<f64> {
    let mut sim = Sim::with_options(Arc::new(model), options).expect("a simulation");
    let mut random = Random(3);
    for velocity in &mut sim.state.qvel {
        *velocity = 0.1 * random.next();
    }
    for _ in 0..before {
        sim.step().expect("a step");
    }
    let request = Request {
        memory,
        omits_sensors: true,
        ..Request::default()
    };
    let nx = request.x_len(sim.model());
    let mut controls = random_matrix(&mut random, sim.model().nu());
    controls.values.iter_mut().for_each(|x| *x *= 0.2);
    let gradient = random_matrix(&mut random, nx);
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let start = sim.state.clone();
    let found = linearizer.rollout_vjp(&sim, memory, &controls, &gradient);
    let found = found.expect("derivatives").clone();
    assert_eq!(sim.state, start);

    let mut steps = Vec::new();
    let nu = controls.shape[1];
    for step in 0..STEPS {
        (sim.state.ctrl).copy_from_slice(&controls.values[step * nu..][..nu]);
        let linear = linearizer.linearize(&sim, &request).expect("derivatives");
        steps.push((linear.a.clone(), linear.b.clone()));
        sim.step().expect("a step");
    }
    let mut by_state = vec![0.0; nx];
    for (step, (a, b)) in steps.iter().enumerate().rev() {
        let own = &gradient.values[step * nx..][..nx];
        by_state.iter_mut().zip(own).for_each(|(x, own)| *x += own);
        let by_control = &found.u.values[step * b.shape[1]..][..b.shape[1]];
        assert_near(by_control, &product(&by_state, b));
        by_state = product(&by_state, a);
    }
    assert_near(&found.x.values, &by_state);
    sim
}

#[test]
fn steps_of_recursions_and_of_passes() {
    check(load("humanoid.xml"), elliptic(), 100, false);
    check(load("quadruped.xml"), RigidOptions::new(), 100, true);
    check(load("four_bar.xml"), RigidOptions::new(), 100, true);
    check(
        load("rolling_sphere.xml"),
        RigidOptions::new().stiction(true),
        50,
        true,
    );
}

/// Returns a box on a plane beside a pendulum with a motor.
fn box_and_pendulum(option: &str) -> Model {
    let text = format!(
        r#"<mujoco>
          {option}
          <worldbody>
            <geom type="plane" size="2 2 .1"/>
            <body pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
            <body pos="1 0 1">
              <joint name="swing" axis="0 1 0"/>
              <geom type="capsule" fromto="0 0 0 .2 0 -.3" size=".03"/>
            </body>
          </worldbody>
          <actuator><motor joint="swing"/></actuator>
        </mujoco>"#
    );
    clench_formats::load_str(&text).expect("a model")
}

#[test]
fn steps_in_which_a_body_sleeps_and_of_several_stages() {
    let check = |option| check(box_and_pendulum(option), RigidOptions::new(), 1000, false);
    let sleeping = check(r#"<option><flag sleep="enable"/></option>"#);
    let asleep = Vec::from_iter(
        sleeping
            .state
            .tree_asleep
            .iter()
            .map(|&counter| counter >= 0.0),
    );
    assert_eq!(asleep, [true, false]);
    check(r#"<option integrator="RK4"/>"#);
}

#[test]
fn environments_of_a_batch_have_their_own_rollouts() {
    let model = Arc::new(load("quadruped.xml"));
    let mut batch = Batch::<f64>::new(model.clone(), 3).expect("a batch");
    let mut random = Random(2);
    let mut each = |columns| Vec::from_iter((0..3).map(|_| random_matrix(&mut random, columns)));
    let (controls, gradients) = (each(model.nu()), each(2 * model.nv + model.na));
    let mut together = BatchLinearizer::new(&batch);
    let found = together.rollout_vjp(&mut batch, false, &controls, &gradients);
    let found = found.expect("derivatives").to_vec();
    let mut linearizer = Linearizer::new(&model).expect("lanes of this processor");
    for (env, found) in found.iter().enumerate() {
        let sim = batch.sim(env).expect("an environment");
        let alone = linearizer.rollout_vjp(&sim, false, &controls[env], &gradients[env]);
        assert_eq!(found, alone.expect("derivatives"));
    }
}

#[test]
fn a_stopped_rollout_has_no_gradient_and_the_next_one_has() {
    let model = Arc::new(load("quadruped.xml"));
    let mut batch = Batch::<f64>::new(model.clone(), 3).expect("a batch");
    let mut random = Random(4);
    let mut each = |columns| Vec::from_iter((0..3).map(|_| random_matrix(&mut random, columns)));
    let (controls, gradients) = (each(model.nu()), each(2 * model.nv + model.na));
    let mut linearizer = BatchLinearizer::new(&batch);
    let calls = AtomicUsize::new(0);
    let go_on = || calls.fetch_add(1, Ordering::Relaxed) < 2;
    let stopped = linearizer.rollout_vjp_while(&mut batch, false, &controls, &gradients, &go_on);
    for found in stopped.expect("finite states") {
        assert_eq!(found.u.shape, [STEPS, model.nu()]);
        let mut numbers = found.x.values.iter().chain(&found.u.values);
        assert!(numbers.all(|number| number.is_nan()));
    }
    assert!(calls.into_inner() < 3 * (STEPS - 1));
    let found = linearizer.rollout_vjp(&mut batch, false, &controls, &gradients);
    let found = found.expect("derivatives").to_vec();
    let mut fresh = BatchLinearizer::new(&batch);
    let expected = fresh.rollout_vjp(&mut batch, false, &controls, &gradients);
    assert_eq!(found, expected.expect("derivatives"));
}

#[test]
fn the_error_of_an_environment_names_it() {
    let model = Arc::new(load("quadruped.xml"));
    let mut batch = Batch::<f64>::new(model, 3).expect("a batch");
    batch.state.qvel.row_mut(1)[0] = f64::NAN;
    let mut linearizer = BatchLinearizer::new(&batch);
    let error = linearizer.linearize(&mut batch, &Request::default());
    let error: Box<dyn std::error::Error> = error.expect_err("NaN is refused").into();
    assert!(error.to_string().starts_with("environment 1: "), "{error}");
}
