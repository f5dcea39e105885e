//! Compares derivatives by recursion with those of passes in dual numbers, which bounds of errors need.

mod bodies;
mod coordinates;
mod sensors;

use crate::common::{Random, load};
use clench_derivatives::{
    InputGradient, InputTangent, Linearizer, Matrix, OutputGradient, Request,
};
use clench_dynamics::model::ParamField;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Model, Output, Sim};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The largest difference relative to 1 + the magnitude.
const TOLERANCE: f64 = 1e-10;

fn compare(recursive: &Matrix, passes: &Matrix) {
    assert_eq!(recursive.shape, passes.shape);
    for (k, (a, b)) in recursive.values.iter().zip(&passes.values).enumerate() {
        let (row, column) = (k / passes.shape[1], k % passes.shape[1]);
        assert!(
            (a - b).abs() <= TOLERANCE * (1.0 + b.abs()),
            "row {row}, column {column}: {a} by recursion, {b} by passes"
        );
    }
}

/// Compares all derivatives in every fifth step under random controls. Returns the most contacts of a state.
fn check(model: Model, options: RigidOptions, steps: usize) -> usize {
    let mut sim = Sim::<f64>::with_options(Arc::new(model), options).expect("a simulation");
    check_sim(&mut sim, steps).contacts
}

/// The events of a comparison.
#[derive(Debug, Default)]
struct Seen {
    /// The most contacts of a state.
    contacts: usize,
    /// True if recursions found derivatives: they round otherwise than passes.
    recursed: bool,
    /// The kinds of constraints whose force was not zero.
    forces: BTreeSet<&'static str>,
}

fn check_sim(sim: &mut Sim<f64>, steps: usize) -> Seen {
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let mut random = Random(1);
    let request = Request {
        outputs: vec![Output::find("subtree_com").expect("an output")],
        ..Request::default()
    };
    let with_passes = Request {
        errors: true,
        ..request.clone()
    };
    let mut seen = Seen::default();
    for step in 0..steps {
        if step % 10 == 0 {
            for control in &mut sim.state.ctrl {
                *control = 0.5 * random.next();
            }
        }
        sim.step().expect("a step");
        let ws = sim.workspace();
        seen.contacts = seen.contacts.max(ws.contacts.len());
        for (block, record) in ws.problem.blocks().zip(&ws.record.blocks) {
            if ws.solver.force()[block.rows()].iter().any(|&f| f != 0.0) {
                seen.forces.insert(record.source.kind());
            }
        }
        if step % 5 == 0 {
            let recursive = linearizer.linearize(sim, &request);
            let recursive = recursive.expect("derivatives").clone();
            let passes = linearizer.linearize(sim, &with_passes);
            let passes = passes.expect("derivatives");
            compare(&recursive.a, &passes.a);
            compare(&recursive.b, &passes.b);
            compare(&recursive.c, &passes.c);
            compare(&recursive.d, &passes.d);
            seen.recursed |= recursive.a != passes.a;
            assert_eq!(recursive.switching.len(), passes.switching.len());
            let [a, b] = [passes.a.clone(), passes.b.clone()];
            compare_gradients(&mut linearizer, sim, [&a, &b]);
            compare_parameters(&mut linearizer, sim);
        }
    }
    seen
}

/// Compares the gradients of two functions of the next state with products of its derivatives by state and controls.
fn compare_gradients(linearizer: &mut Linearizer, sim: &Sim<f64>, derivatives: [&Matrix; 2]) {
    let request = Request {
        omits_sensors: true,
        ..Request::default()
    };
    let nx = derivatives[0].shape[0];
    let mut random = Random(2);
    let gradient = OutputGradient {
        x: Matrix {
            shape: [2, nx],
            values: (0..2 * nx).map(|_| random.next()).collect(),
        },
        y: Matrix {
            shape: [2, 0],
            values: Vec::new(),
        },
    };
    let found = linearizer.vjp(sim, &request, &gradient);
    let InputGradient { x, u, .. } = found.expect("a gradient");
    for (found, by) in [x, u].into_iter().zip(derivatives) {
        assert_eq!(found.shape, [2, by.shape[1]]);
        for row in 0..2 {
            for column in 0..by.shape[1] {
                let (mut sum, mut size) = (0.0, 1.0);
                for k in 0..nx {
                    let term =
                        gradient.x.values[row * nx + k] * by.values[k * by.shape[1] + column];
                    sum += term;
                    size += term.abs();
                }
                let found = found.values[row * by.shape[1] + column];
                assert!(
                    (found - sum).abs() <= TOLERANCE * size,
                    "function {row}, column {column}: {found}, {sum} by passes"
                );
            }
        }
    }
}

/// Compares derivatives by parameters, and those along a tangent, with and without passes along the state.
fn compare_parameters(linearizer: &mut Linearizer, sim: &Sim<f64>) {
    let field = ParamField::find("body_mass").expect("a parameter");
    let mut request = Request {
        parameters: vec![(field, 1)],
        ..Request::default()
    };
    let apart = linearizer.linearize(sim, &request);
    let apart = apart.expect("derivatives").clone();
    request.errors = true;
    let together = linearizer.linearize(sim, &request).expect("derivatives");
    compare(&apart.a, &together.a);
    compare(&apart.e, &together.e);
    let ones = |rows: usize| Matrix {
        shape: [rows, 1],
        values: vec![1.0; rows],
    };
    let tangent = InputTangent {
        x: ones(apart.a.shape[0]),
        u: ones(apart.b.shape[1]),
        p: ones(0),
    };
    request.parameters.clear();
    let passes = linearizer.jvp(sim, &request, &tangent);
    let passes = passes.expect("a directional derivative").x.clone();
    let product = linearizer.jvp(sim, &Request::default(), &tangent);
    compare(&product.expect("a directional derivative").x, &passes);
}

#[test]
fn robots_in_contact() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let options = RigidOptions::new().friction_cone(cone);
        // The humanoid also touches itself, the arm a table and a box.
        for name in ["humanoid.xml", "quadruped.xml", "arm_and_box.xml"] {
            assert!(check(load(name), options, 150) > 1);
        }
        assert!(check(load("box_stack.xml"), options, 20) > 4);
        check(load("rolling_sphere.xml"), options, 100);
    }
}

/// A chain of all kinds of joints, with springs, curved dampers, dry friction and limits, and several actuators.
fn mixed(integrator: &str, root: &str) -> String {
    format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004"/>
          <worldbody>
            <geom type="plane" size="2 2 .1"/>
            <geom type="box" size=".05 .3 .1" pos=".35 0 .1"/>
            <body pos="0 0 .3">
              {root}
              <geom type="capsule" fromto="0 0 0 .2 0 -.1" size=".03" condim="6"/>
              <body pos=".2 0 -.1">
                <joint name="a" axis="0 1 .2" damping=".05 .02" armature=".01" frictionloss=".02" range="-60 20"/>
                <joint name="b" type="slide" axis="1 0 .1" damping=".5" stiffness="30 5" frictionloss=".1"/>
                <joint name="c" axis="1 0 0" pos=".02 .01 0" actuatorfrcrange="-.3 .3" actuatorfrclimited="true"/>
                <geom type="ellipsoid" pos=".1 0 -.1" size=".1 .05 .04" condim="4"/>
                <body pos=".2 0 -.1">
                  <joint name="d" type="ball" pos=".01 .02 .03" stiffness=".3" damping=".02"/>
                  <geom type="box" pos=".05 0 0" size=".05 .02 .03"/>
                </body>
              </body>
            </body>
          </worldbody>
          <actuator>
            <position joint="a" kp="2" kv=".1" forcerange="-.5 .5"/>
            <general joint="b" dyntype="filter" dynprm=".05" gainprm="2" gear="1.5"/>
            <damper joint="b" kv=".4" ctrlrange="0 1"/>
            <motor joint="c" gear="3"/>
            <motor joint="c" ctrlrange="-.1 .1" ctrllimited="true"/>
          </actuator>
        </mujoco>"#
    )
}

#[test]
fn joints_actuators_and_integrators() {
    let ball = r#"<joint type="ball" damping=".1" stiffness=".2"/>"#;
    let free = r#"<joint type="free" damping=".1" stiffness=".2"/>"#;
    let forces = ["contact", "friction_dof"];
    for root in [ball, free] {
        for integrator in ["Euler", "implicitfast", "RK4"] {
            check_text(&mixed(integrator, root), &forces, |_| {});
        }
    }
}

/// Compares steps of a model in text, in which constraints of the kinds `forces` must act. `prepare` changes the first
/// state.
fn check_text(text: &str, forces: &[&str], prepare: impl Fn(&mut Sim<f64>)) {
    let model = clench_formats::load_str(text).expect("a model");
    let mut sim = Sim::<f64>::new(Arc::new(model)).expect("a simulation");
    prepare(&mut sim);
    let seen = check_sim(&mut sim, 200);
    assert!(seen.recursed, "recursions cover the step");
    for kind in forces {
        assert!(seen.forces.contains(kind), "{kind} among {:?}", seen.forces);
    }
}

/// Kinds of steps that need passes: the results are the same because they are the same.
#[test]
fn other_steps_need_passes() {
    let free = r#"<joint type="free"/>"#;
    for integrator in ["implicit", "discrete"] {
        let model = clench_formats::load_str(&mixed(integrator, free)).expect("a model");
        check(model, RigidOptions::new(), 20);
    }
}

/// An adhesive contact acts within its gap, where the force of its constraint is zero. Its steps need passes.
#[test]
fn adhesion_within_the_gap() {
    let text = r#"<mujoco><worldbody>
      <geom pos=".06 -.08 -.14" adhesion=".8" size=".08"/>
      <body>
        <joint axis="-.2 1 .3"/>
        <geom margin=".03" gap=".03" type="cylinder" size=".04 .04"/>
      </body>
    </worldbody></mujoco>"#;
    let model = clench_formats::load_str(text).expect("a model");
    assert!(check(model, RigidOptions::new(), 20) > 0);
}
