//! Compares directional derivatives, and gradients, with products of the matrices of a linearization.

use crate::common::{Random, elliptic, load};
use clench_derivatives::{
    BatchLinearizer, InputGradient, InputTangent, Linearizer, Matrix, OutputGradient,
    OutputTangent, Request,
};
use clench_dynamics::model::ParamField;
use clench_rigid::options::{ContactModel, RigidOptions};
use clench_rigid::{Batch, Model, Output, Sim};
use std::sync::Arc;

/// The largest difference, relative to the largest sum of the sizes of the terms of a number of the product.
const TOLERANCE: f64 = 1e-12;

impl Random {
    /// Returns a matrix, of which a third of the numbers are zero.
    fn matrix(&mut self, shape: [usize; 2]) -> Matrix {
        let number = |_| match self.next() {
            x if self.next() > 0.33 => 0.0 * x,
            x => x,
        };
        let values = (0..shape[0] * shape[1]).map(number).collect();
        Matrix { shape, values }
    }

    fn tangent(&mut self, model: &Model, request: &Request, columns: usize) -> InputTangent {
        InputTangent {
            x: self.matrix([2 * model.nv + model.na, columns]),
            u: self.matrix([model.nu(), columns]),
            p: self.matrix([request.parameters.len(), columns]),
        }
    }
}

/// Checks that `product` is the sum of the products of some matrices.
fn assert_product(terms: &[(&Matrix, &Matrix)], product: &Matrix) {
    let columns = product.shape[1];
    let (mut largest, mut error) = (1.0_f64, 0.0_f64);
    for (row, values) in product.values.chunks_exact(columns.max(1)).enumerate() {
        for (column, &found) in values.iter().enumerate() {
            let (mut sum, mut size) = (0.0, 0.0);
            for (left, right) in terms {
                assert_eq!(left.shape[0], product.shape[0]);
                let inner = left.shape[1];
                for k in 0..inner {
                    let term = left.values[row * inner + k] * right.values[k * columns + column];
                    sum += term;
                    size += term.abs();
                }
            }
            error = error.max((found - sum).abs());
            largest = largest.max(size);
        }
    }
    assert!(
        error <= TOLERANCE * largest,
        "the numbers differ by {error}; their sizes are up to {largest}"
    );
}

/// Returns some numbers of parameters of a model: those that are not zero.
fn parameters(sim: &Sim<f64>) -> Vec<(ParamField, usize)> {
    let mut chosen = Vec::new();
    for name in [
        "body_mass",
        "dof_damping",
        "geom_friction",
        "geom_size",
        "jnt_axis",
        "gravity",
        "timestep",
    ] {
        let field = ParamField::find(name).expect("a parameter");
        let values = sim.param(name).expect("a parameter");
        let numbers = (0..values.len()).filter(|&number| values[number] != 0.0);
        chosen.extend(numbers.map(|number| (field, number)));
    }
    chosen
}

fn check_gradient(
    linearizer: &mut Linearizer,
    sim: &Sim<f64>,
    request: &Request,
    random: &mut Random,
) {
    let linear = linearizer.linearize(sim, request).expect("derivatives");
    let linear = linear.clone();
    for rows in [1, 3] {
        let gradient = OutputGradient {
            x: random.matrix([rows, request.x_len(sim.model())]),
            y: random.matrix([rows, request.y_len(sim.model())]),
        };
        let found = linearizer.vjp(sim, request, &gradient);
        let InputGradient { x, u, p } = found.expect("derivatives");
        let OutputGradient { x: by_x, y: by_y } = &gradient;
        assert_product(&[(by_x, &linear.a), (by_y, &linear.c)], x);
        assert_product(&[(by_x, &linear.b), (by_y, &linear.d)], u);
        assert_product(&[(by_x, &linear.e), (by_y, &linear.f)], p);
    }
}

fn check(model: Model, options: RigidOptions, steps: usize) {
    let mut sim = Sim::with_options(Arc::new(model), options).expect("a simulation");
    let mut random = Random(1);
    for velocity in &mut sim.state.qvel {
        *velocity = 0.1 * random.next();
    }
    for step in 0..steps {
        if step % 10 == 0 {
            for control in &mut sim.state.ctrl {
                *control = 0.5 * random.next();
            }
        }
        sim.step().expect("a step");
    }
    let outputs = ["subtree_com", "qfrc_constraint"];
    let request = Request {
        outputs: Vec::from(outputs.map(|name| Output::find(name).expect("an output"))),
        parameters: parameters(&sim),
        ..Request::default()
    };
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let linear = linearizer.linearize(&sim, &request).expect("derivatives");
    let linear = linear.clone();
    for columns in [1, 3, 20] {
        let tangent = random.tangent(sim.model(), &request, columns);
        let found = linearizer.jvp(&sim, &request, &tangent);
        let OutputTangent { x, y } = found.expect("derivatives");
        let of = |[a, b, e]: [_; 3]| [(a, &tangent.x), (b, &tangent.u), (e, &tangent.p)];
        assert_product(&of([&linear.a, &linear.b, &linear.e]), x);
        assert_product(&of([&linear.c, &linear.d, &linear.f]), y);
    }
    check_gradient(&mut linearizer, &sim, &request, &mut random);
    let states = Request {
        omits_sensors: true,
        ..Request::default()
    };
    check_gradient(&mut linearizer, &sim, &states, &mut random);
    // The linearizer stores nothing that changes later results.
    let again = linearizer.linearize(&sim, &request).expect("derivatives");
    assert_eq!(&linear, again);
}

#[test]
fn robots_in_contact() {
    check(load("humanoid.xml"), RigidOptions::new(), 100);
    check(load("quadruped.xml"), elliptic(), 100);
    check(load("arm_and_box.xml"), elliptic(), 100);
}

#[test]
fn other_constraints() {
    check(load("four_bar.xml"), RigidOptions::new(), 100);
    check(load("suction_gripper.xml"), RigidOptions::new(), 50);
    check(
        load("rolling_sphere.xml"),
        RigidOptions::new().contact_model(ContactModel::Coulomb),
        100,
    );
}

/// Returns a free body with a leg on a ball joint, with muscles, filters and sensors, on a plane.
fn leg(integrator: &str) -> Model {
    let text = format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004" density="1.2" viscosity="0.1"/>
          <worldbody>
            <geom type="plane" size="2 2 .1"/>
            <body pos="0 0 .12">
              <freejoint/>
              <geom type="box" size=".1 .08 .03"/>
              <site name="s" pos="0 .02 .06"/>
              <body pos=".1 0 0">
                <joint name="a" type="ball" damping=".1" stiffness=".2"/>
                <geom type="capsule" fromto="0 0 0 .1 0 -.1" size=".03"/>
                <site name="t" pos=".05 0 .05"/>
                <body pos=".1 0 -.1">
                  <joint name="b" axis="0 1 0" damping=".05" frictionloss=".02" range="-60 20"/>
                  <geom type="capsule" fromto="0 0 0 .1 0 0" size=".02"/>
                </body>
              </body>
            </body>
          </worldbody>
          <tendon>
            <spatial name="rope" stiffness="3" damping=".1"><site site="s"/><site site="t"/></spatial>
          </tendon>
          <actuator>
            <position joint="b" kp="2" kv=".1"/>
            <muscle tendon="rope" lengthrange=".02 .3"/>
            <general tendon="rope" dyntype="filter" dynprm=".05" gainprm="2"/>
          </actuator>
          <sensor>
            <framequat objtype="site" objname="t"/>
            <accelerometer site="t"/>
            <tendonvel tendon="rope"/>
            <force site="t"/>
          </sensor>
        </mujoco>"#
    );
    clench_formats::load_str(&text).expect("a model")
}

#[test]
fn activations_sensors_and_integrators() {
    for integrator in ["Euler", "implicit", "RK4", "discrete"] {
        check(leg(integrator), RigidOptions::new(), 40);
    }
}

#[test]
fn a_tangent_without_columns_has_no_derivatives() {
    let sim = Sim::<f64>::new(Arc::new(leg("Euler"))).expect("a simulation");
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let request = Request::default();
    let tangent = Random(1).tangent(sim.model(), &request, 0);
    let found = linearizer.jvp(&sim, &request, &tangent);
    let OutputTangent { x, y } = found.expect("derivatives");
    assert_eq!((x.shape, y.shape), ([22, 0], [11, 0]));
}

#[test]
fn environments_of_a_batch_have_their_own_tangents_and_gradients() {
    let model = Arc::new(load("quadruped.xml"));
    let mut batch = Batch::<f64>::new(model.clone(), 3).expect("a batch");
    let mut random = Random(2);
    for _ in 0..20 {
        batch.step().expect("a step");
    }
    let request = Request::default();
    let tangents: Vec<_> = (0..3)
        .map(|_| random.tangent(&model, &request, 2))
        .collect();
    let mut together = BatchLinearizer::new(&batch);
    let found = together.jvp(&mut batch, &request, &tangents);
    let found = found.expect("derivatives").to_vec();
    let mut linearizer = Linearizer::new(&model).expect("lanes of this processor");
    for (env, found) in found.iter().enumerate() {
        let sim = batch.sim(env).expect("an environment");
        let alone = linearizer.jvp(&sim, &request, &tangents[env]);
        assert_eq!(found, alone.expect("derivatives"));
    }
    let mut gradient = || OutputGradient {
        x: random.matrix([1, request.x_len(&model)]),
        y: random.matrix([1, request.y_len(&model)]),
    };
    let gradients = [gradient(), gradient(), gradient()];
    let found = together.vjp(&mut batch, &request, &gradients);
    let found = found.expect("derivatives").to_vec();
    for (env, found) in found.iter().enumerate() {
        let sim = batch.sim(env).expect("an environment");
        let alone = linearizer.vjp(&sim, &request, &gradients[env]);
        assert_eq!(found, alone.expect("derivatives"));
    }
}
