//! Compares derivatives after coarse solves with those after exact ones: their difference is within the bounds.

use crate::common::{elliptic, load};
use clench_derivatives::{ErrorBound, Linearization, Linearizer, Matrix, Request};
use clench_rigid::options::{ContactModel, RigidOptions};
use clench_rigid::{Model, Output, Sim, State};
use clench_solver::ConstraintSolver;
use std::sync::Arc;

/// The rounding errors of derivatives, relative to the largest.
const ROUNDING: f64 = 1e-11;
/// A geometric mean of bound / error that says nothing.
const VACUOUS: f64 = 30.0;

fn exact(options: RigidOptions) -> RigidOptions {
    options
        .constraint_solver(ConstraintSolver::Newton)
        .tolerance(0.0)
        .iterations(200)
}

/// Returns states of a motion under varying controls.
fn states(model: &Arc<Model>, options: RigidOptions, count: usize) -> Vec<State<f64>> {
    let mut sim = Sim::<f64>::with_options(model.clone(), exact(options)).expect("a simulation");
    let mut states = Vec::new();
    for step in 0..10 * count {
        for (u, control) in sim.state.ctrl.iter_mut().enumerate() {
            *control = 0.3 * (0.07 * step as f64 + u as f64).sin();
        }
        sim.step().expect("a step");
        if step % 10 == 9 {
            states.push(sim.state.clone());
        }
    }
    states
}

/// Returns the derivatives of a step from a state that was reached exactly. The solve starts cold.
fn linearize(model: &Arc<Model>, options: RigidOptions, state: &State<f64>) -> Linearization {
    let mut sim = Sim::<f64>::with_options(model.clone(), options).expect("a simulation");
    sim.state.copy_from(state);
    sim.state.qacc_warmstart.fill(0.0);
    let mut linearizer = Linearizer::new(model).expect("lanes of this processor");
    let request = Request {
        outputs: vec![Output::find("qacc").expect("an output")],
        errors: true,
        ..Request::default()
    };
    let linear = linearizer.linearize(&sim, &request);
    linear.expect("derivatives").clone()
}

/// Returns the columns of the derivatives of `qacc` by x and u.
fn columns(linear: &Linearization, nv: usize) -> Vec<Vec<f64>> {
    let of = |matrix: &Matrix| {
        let [rows, columns] = matrix.shape;
        let number = |row: usize, column: usize| matrix.values[row * columns + column];
        let column = |k| Vec::from_iter((rows - nv..rows).map(|row| number(row, k)));
        Vec::from_iter((0..columns).map(column))
    };
    [of(&linear.c), of(&linear.d)].concat()
}

/// Returns the acceleration of the step that [`linearize`] differentiates, and the simulation.
fn accelerate(
    model: &Arc<Model>,
    options: RigidOptions,
    state: &State<f64>,
) -> (Vec<f64>, Sim<f64>) {
    let mut sim = Sim::<f64>::with_options(model.clone(), options).expect("a simulation");
    sim.state.copy_from(state);
    sim.state.qacc_warmstart.fill(0.0);
    sim.forward().expect("a forward pass");
    (sim.workspace().qacc.clone(), sim)
}

/// Returns the size of the difference of two accelerations in the norm of the mass matrix.
fn distance(sim: &Sim<f64>, [a, b]: [&[f64]; 2]) -> f64 {
    let problem = &sim.workspace().problem;
    let difference = Vec::from_iter(a.iter().zip(b).map(|(a, b)| a - b));
    let mut force = vec![0.0; difference.len()];
    let tree = problem.tree();
    problem.mass.mul(tree, &difference, &mut force);
    let squares = difference.iter().zip(&force).map(|(x, f)| x * f);
    squares.sum::<f64>().max(0.0).sqrt()
}

/// The bounds of several states, compared with the errors.
#[derive(Debug, Default)]
struct Found {
    /// The sum of the logarithms of bound / error and its number of terms: the errors above rounding.
    logarithms: f64,
    compared: f64,
    /// The largest bound, relative to rounding errors.
    largest: f64,
}

impl Found {
    /// Compares the bounds of one state.
    fn compare(&mut self, model: &Arc<Model>, coarse: RigidOptions, state: &State<f64>) {
        let approximate = linearize(model, coarse, state);
        let reference = linearize(model, exact(coarse), state);
        let bound = &approximate.errors;
        let (found, _) = accelerate(model, coarse, state);
        let (expected, sim) = accelerate(model, exact(coarse), state);
        let zero = vec![0.0; model.nv];
        let rounding = ROUNDING * (1.0 + distance(&sim, [&expected, &zero]));
        let error = distance(&sim, [&found, &expected]);
        let limit = bound.acceleration;
        assert!(error <= limit + rounding, "{error} is not below {limit}");
        let both = approximate.switching.iter().zip(&reference.switching);
        for ((a, b), reach) in both.zip(&bound.reach).filter(|((a, _), _)| a.is_finite()) {
            let limit = reach + ROUNDING * (1.0 + a.abs());
            assert!((a - b).abs() <= limit, "{a} is not near {b}: {reach}");
        }
        let [approximate, reference] =
            [approximate.clone(), reference].map(|x| columns(&x, model.nv));
        assert_eq!(bound.directions.len(), approximate.len());
        let sizes = reference
            .iter()
            .map(|column| distance(&sim, [column, &zero]));
        let rounding = ROUNDING * sizes.fold(1.0, f64::max);
        for ((a, b), &limit) in approximate.iter().zip(&reference).zip(&bound.directions) {
            let error = distance(&sim, [a, b]);
            assert!(error <= limit + rounding, "{error} is not below {limit}");
            for ((a, b), dof) in a.iter().zip(b).zip(&bound.dofs) {
                assert!((a - b).abs() <= dof * (limit + rounding));
            }
            self.largest = self.largest.max(limit / rounding);
            if error > 100.0 * rounding {
                self.logarithms += (limit / error).ln();
                self.compared += 1.0;
            }
        }
    }

    /// Returns the geometric mean of bound / error.
    fn ratio(&self) -> f64 {
        (self.logarithms / self.compared).exp()
    }
}

/// Compares the bounds of several states after coarse solves. Returns the number of errors above rounding.
fn check(model: Arc<Model>, options: RigidOptions) -> f64 {
    let states = states(&model, options, 8);
    let few = |iterations| options.iterations(iterations);
    let cg = |tolerance| {
        let options = options.constraint_solver(ConstraintSolver::Cg);
        options.iterations(300).tolerance(tolerance)
    };
    let coarse = [
        few(1),
        few(2),
        options.tolerance(1e-1),
        options.tolerance(1e-4),
        cg(1e-1),
        cg(1e-4),
        cg(1e-8),
    ];
    let mut all = Found::default();
    for coarse in coarse {
        let mut found = Found::default();
        for state in &states {
            found.compare(&model, coarse, state);
        }
        all.logarithms += found.logarithms;
        all.compared += found.compared;
    }
    assert!(all.ratio() < VACUOUS, "{all:?}");
    // At the working precision the bounds are rounding errors.
    for precise in [exact(options), cg(0.0)] {
        let mut found = Found::default();
        for state in &states {
            found.compare(&model, precise, state);
        }
        assert!(found.largest < 1.0, "{found:?}");
    }
    all.compared
}

#[test]
fn errors_of_coarse_solves_are_within_their_bounds() {
    assert!(check(Arc::new(load("humanoid.xml")), RigidOptions::new()) > 100.0);
    assert!(check(Arc::new(load("humanoid.xml")), elliptic()) > 100.0);
    assert!(check(Arc::new(load("quadruped.xml")), RigidOptions::new()) > 100.0);
    assert!(check(Arc::new(load("arm_and_box.xml")), elliptic()) > 100.0);
}

#[test]
fn integrators_and_metrics() {
    for integrator in ["Euler", "implicitfast", "implicit", "discrete"] {
        let text = format!(
            r#"<mujoco>
              <option integrator="{integrator}" timestep="0.004" cone="elliptic"/>
              <worldbody>
                <geom type="plane" size="2 2 .1"/>
                <body pos="0 0 .11" euler="20 0 0">
                  <freejoint/>
                  <geom type="box" size=".1 .08 .1"/>
                  <site name="s" pos=".1 0 .1"/>
                  <body pos=".1 0 0">
                    <joint name="a" axis="0 1 0" damping=".1" frictionloss=".02" range="-60 20"/>
                    <geom type="capsule" fromto="0 0 0 .2 0 -.1" size=".03"/>
                    <site name="t" pos=".2 0 0"/>
                  </body>
                </body>
              </worldbody>
              <tendon>
                <spatial name="rope" damping=".1" armature=".01"><site site="s"/><site site="t"/></spatial>
              </tendon>
              <actuator><position joint="a" kp="2" kv=".1"/></actuator>
            </mujoco>"#
        );
        let model = clench_formats::load_str(&text).expect("a model");
        let compared = check(Arc::new(model), RigidOptions::new());
        assert!(compared > 10.0, "{integrator}");
    }
}

/// Accelerations that are not the minimiser of one problem have no bounds.
#[test]
fn unknown_errors_are_infinite() {
    let model = Arc::new(load("quadruped.xml"));
    let coulomb = RigidOptions::new().contact_model(ContactModel::Coulomb);
    for options in [coulomb, elliptic().noslip_iterations(3)] {
        let states = states(&model, options, 20);
        let mut linear = states.iter().map(|state| linearize(&model, options, state));
        let linear = linear.find(|linear| !linear.switching.is_empty());
        let linear = linear.expect("a state in contact");
        let bound = &linear.errors;
        assert_eq!(bound.acceleration, f64::INFINITY);
        assert_eq!(
            bound.directions.len(),
            linear.a.shape[1] + linear.b.shape[1]
        );
        assert_eq!(bound.reach.len(), linear.switching.len());
        let mut numbers = bound.directions.iter().chain(&bound.reach);
        assert!(numbers.all(|&x| x == f64::INFINITY));
    }
}

#[test]
fn bounds_are_computed_on_demand() {
    let sim = Sim::<f64>::new(Arc::new(load("quadruped.xml"))).expect("a simulation");
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let linear = linearizer.linearize(&sim, &Request::default());
    assert_eq!(linear.expect("derivatives").errors, ErrorBound::default());
}
