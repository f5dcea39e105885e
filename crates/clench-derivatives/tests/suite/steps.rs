//! Derivatives by state, controls and parameters.

use crate::common::{elliptic, load};
use crate::differences::Differences;
use clench_derivatives::{Linearizer, Request};
use clench_dynamics::dynamics::integrate::integrate_positions;
use clench_dynamics::model::{Integrator, ParamField};
use clench_rigid::options::{ContactModel, RigidOptions};
use clench_rigid::readout::constraint_rows;
use clench_rigid::{Model, Sim};
use clench_solver::ConstraintSolver;
use std::sync::Arc;

/// The largest share of entries whose differences disagree, because a constraint switches within the interval.
const SWITCHING: f64 = 0.05;

/// Compares all derivatives by state and controls.
fn check(model: Model, options: RigidOptions, steps: usize) {
    let mut differences = Differences::new(Arc::new(model), options, steps);
    let mut linearizer = Linearizer::new(differences.sim.model()).expect("lanes of this processor");
    let request = Request::default();
    let result = linearizer.linearize(&differences.sim, &request);
    let result = result.expect("derivatives").clone();
    let model = differences.sim.model().clone();
    let (nv, na) = (model.nv, model.na);
    let mut switching = 0;
    for dof in 0..nv {
        switching += differences.compare([&result.a, &result.c], dof, |sim, h| {
            let mut velocity = vec![0.0; nv];
            velocity[dof] = h;
            integrate_positions(&model, &mut sim.state.qpos, &velocity, 1.0);
        });
        switching += differences.compare([&result.a, &result.c], nv + dof, |sim, h| {
            sim.state.qvel[dof] += h;
        });
    }
    for a in 0..na {
        switching += differences.compare([&result.a, &result.c], 2 * nv + a, |sim, h| {
            sim.state.act[a] += h;
        });
    }
    for u in 0..model.nu() {
        switching += differences.compare([&result.b, &result.d], u, |sim, h| {
            sim.state.ctrl[u] += h;
        });
    }
    if model.integrator != Integrator::Rk4 {
        differences.sim.state.copy_from(&differences.from);
        differences.sim.forward().expect("a forward pass");
        let rows = constraint_rows(differences.sim.workspace(), 0);
        assert_eq!(result.switching.len(), rows.len());
    }
    let all = (result.a.values.len() + result.b.values.len()) as f64;
    let limit = (SWITCHING * all) as usize;
    assert!(switching <= limit, "{switching} of {all} entries switch");
}

#[test]
fn robots_in_contact() {
    check(load("humanoid.xml"), RigidOptions::new(), 100);
    check(load("humanoid.xml"), elliptic(), 100);
    check(load("quadruped.xml"), RigidOptions::new(), 100);
    check(load("arm_and_box.xml"), RigidOptions::new(), 100);
}

#[test]
fn coulomb_friction_sticks_and_slides() {
    let coulomb = RigidOptions::new().contact_model(ContactModel::Coulomb);
    check(load("humanoid.xml"), coulomb, 100);
    check(load("rolling_sphere.xml"), coulomb, 100);
    check(load("quadruped.xml"), coulomb.stiction(true), 100);
}

#[test]
fn other_constraints() {
    check(load("four_bar.xml"), RigidOptions::new(), 100);
    check(load("geared_pair.xml"), RigidOptions::new(), 100);
    check(load("toggled_weld.xml"), RigidOptions::new(), 50);
    check(load("suction_gripper.xml"), RigidOptions::new(), 50);
    check(load("rolling_sphere.xml"), RigidOptions::new(), 100);
}

#[test]
fn other_solvers() {
    let cg = RigidOptions::new().constraint_solver(ConstraintSolver::Cg);
    check(load("quadruped.xml"), cg, 100);
    check(
        load("arm_and_box.xml"),
        elliptic().noslip_iterations(3),
        100,
    );
}

/// Two links with a ball joint, springs, a tendon and several actuators, near a plane.
fn mixed(integrator: &str) -> Model {
    let text = format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004" density="1.2" viscosity="0.1"/>
          <worldbody>
            <geom type="plane" size="2 2 .1"/>
            <body pos="0 0 .35">
              <joint name="a" type="ball" damping=".1" stiffness=".2"/>
              <geom type="capsule" fromto="0 0 0 .2 0 -.1" size=".03"/>
              <site name="s" pos=".1 0 0"/>
              <body pos=".2 0 -.1">
                <joint name="b" axis="0 1 0" damping=".05" armature=".01" frictionloss=".02" range="-60 20"/>
                <geom type="ellipsoid" pos=".1 0 -.1" size=".1 .05 .04"/>
                <site name="t" pos=".1 0 .05"/>
              </body>
            </body>
          </worldbody>
          <tendon>
            <spatial name="rope" stiffness="3" damping=".1"><site site="s"/><site site="t"/></spatial>
          </tendon>
          <actuator>
            <position joint="b" kp="2" kv=".1"/>
            <muscle tendon="rope" lengthrange=".05 .3"/>
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
fn integrators() {
    for integrator in ["Euler", "implicitfast", "implicit", "RK4", "discrete"] {
        check(mixed(integrator), RigidOptions::new(), 40);
    }
}

/// Some passes are along controls alone. Sensors read the results of all stages, of which these passes repeat few.
#[test]
fn many_controls() {
    let motors = [r#"<motor joint="a"/><motor joint="b" gear="2"/>"#; 20].concat();
    let text = format!(
        r#"<mujoco>
          <worldbody>
            <geom type="plane" size="2 2 .1"/>
            <body pos="0 0 .2">
              <joint name="a" axis="0 1 0" damping=".1"/>
              <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
              <body pos=".2 0 0">
                <joint name="b" axis="1 1 0" damping=".1"/>
                <geom type="capsule" fromto="0 0 0 .2 0 -.1" size=".03"/>
                <site name="t" pos=".2 0 -.1"/>
              </body>
            </body>
          </worldbody>
          <actuator>{motors}</actuator>
          <sensor>
            <accelerometer site="t"/>
            <force site="t"/>
            <jointvel joint="b"/>
            <actuatorfrc actuator="0"/>
          </sensor>
        </mujoco>"#
    )
    .replacen("<motor ", "<motor name=\"0\" ", 1);
    check(
        clench_formats::load_str(&text).expect("a model"),
        RigidOptions::new(),
        100,
    );
}

/// Every muscle at rest, and every command of zero, is at an end of a range. The derivatives there are those of the
/// inside, from which a command can come and to which it can go.
#[test]
fn controls_and_activations_at_an_end_of_their_range() {
    let text = r#"<mujoco>
      <worldbody>
        <body>
          <joint name="j" axis="0 1 0" range="-90 90"/>
          <geom size=".1" pos=".1 0 0"/>
        </body>
      </worldbody>
      <actuator>
        <motor joint="j" ctrlrange="0 1" forcerange="0 5"/>
        <damper joint="j" kv="2" ctrlrange="0 1"/>
        <muscle joint="j" ctrlrange="0 1"/>
        <general joint="j" dyntype="filter" dynprm=".1" actrange="0 1" ctrlrange="0 1"/>
      </actuator>
    </mujoco>"#;
    let model = Arc::new(clench_formats::load_str(text).expect("a model"));
    let mut sim = Sim::<f64>::new(model.clone()).expect("a simulation");
    let mut linearizer = Linearizer::new(&model).expect("lanes of this processor");
    let after = |sim: &mut Sim<f64>| {
        sim.step().expect("a step");
        [&sim.state.qpos[..], &sim.state.qvel, &sim.state.act].concat()
    };
    // A muscle at its command switches between activation and deactivation.
    for (muscle, errors) in [((0.2, 0.0), false), ((0.0, 0.5), false), ((0.0, 0.5), true)] {
        sim.state.qvel[0] = 0.3;
        (sim.state.ctrl[2], sim.state.act[0]) = muscle;
        let from = sim.state.clone();
        let request = Request {
            errors,
            ..Request::default()
        };
        let result = linearizer.linearize(&sim, &request).expect("derivatives");
        let (a, b) = (result.a.clone(), result.b.clone());
        let still = after(&mut sim);
        let h = 1e-7;
        for column in 0..model.na + model.nu() {
            sim.state.copy_from(&from);
            let (matrix, k) = match column.checked_sub(model.na) {
                None => {
                    sim.state.act[column] += h;
                    (&a, 2 * model.nv + column)
                }
                Some(u) => {
                    sim.state.ctrl[u] += h;
                    (&b, u)
                }
            };
            let moved = after(&mut sim);
            for (row, (moved, still)) in moved.iter().zip(&still).enumerate() {
                let difference = (moved - still) / h;
                let exact = matrix.values[row * matrix.shape[1] + k];
                let error = (difference - exact).abs();
                assert!(
                    error < 1e-5,
                    "row {row}, column {column}: {difference}, {exact}"
                );
            }
        }
        sim.state.copy_from(&from);
    }
}

/// Rotations have no axis at rest.
#[test]
fn joints_at_rest() {
    let text = r#"<mujoco>
      <worldbody>
        <body pos="0 0 1">
          <freejoint/>
          <geom type="box" size=".1 .2 .3"/>
          <body pos="0 0 -.3">
            <joint type="ball" stiffness="2" damping=".1" pos="0 0 .1"/>
            <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/>
          </body>
        </body>
      </worldbody>
    </mujoco>"#;
    let model = clench_formats::load_str(text).expect("a model");
    check(model, RigidOptions::new(), 0);
}

#[test]
fn parameters() {
    let fields = [
        "body_mass",
        "body_ipos",
        "dof_damping",
        "dof_frictionloss",
        "geom_friction",
        "geom_size",
        "geom_solref",
        "actuator_gainprm",
        "gravity",
    ];
    let mut differences = Differences::new(Arc::new(load("quadruped.xml")), elliptic(), 100);
    let sim = &differences.sim;
    let mut parameters = Vec::new();
    for name in fields {
        let field = ParamField::find(name).expect("a parameter");
        let count: usize = field.shape(sim.model()).iter().product();
        let values = sim.param(name).expect("a parameter");
        // A mass of zero could not decrease.
        let numbers = (0..count)
            .step_by(7)
            .filter(|&number| values[number] != 0.0);
        parameters.extend(numbers.map(|number| (field, number)));
    }
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let request = Request {
        parameters: parameters.clone(),
        ..Request::default()
    };
    let result = linearizer
        .linearize(sim, &request)
        .expect("derivatives")
        .clone();
    for (column, (field, number)) in parameters.into_iter().enumerate() {
        let base = differences.sim.param(field.name()).expect("a parameter");
        differences.compare([&result.e, &result.f], column, |sim, h| {
            let mut values = base.clone();
            values[number] += h;
            sim.set_param(field.name(), &values)
                .expect("a valid parameter");
        });
        let reset = differences.sim.set_param(field.name(), &base);
        reset.expect("a valid parameter");
    }
}

/// The distance is zero where the force of a contact vanishes.
#[test]
fn a_contact_that_lets_go_is_reported() {
    let text = r#"<mujoco>
      <worldbody>
        <geom type="plane" size="1 1 .1" condim="1"/>
        <body pos="0 0 .0999">
          <freejoint/>
          <geom size=".1" condim="1"/>
        </body>
      </worldbody>
    </mujoco>"#;
    let model = Arc::new(clench_formats::load_str(text).expect("a model"));
    let mut sim = Sim::<f64>::new(model.clone()).expect("a simulation");
    let mut linearizer = Linearizer::new(&model).expect("lanes of this processor");
    let mut pressed = |velocity: f64| {
        sim.state.qvel[2] = velocity;
        let result = linearizer.linearize(&sim, &Request::default());
        let distance = result.expect("derivatives").switching[0];
        sim.forward().expect("a forward pass");
        (sim.workspace().solver.force()[0] > 0.0, distance)
    };
    let (mut down, mut up) = (-1.0, 1.0);
    assert!(pressed(down).0 && pressed(down).1 > 1.0);
    assert!(!pressed(up).0 && pressed(up).1 > 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (down + up);
        match pressed(middle).0 {
            true => down = middle,
            false => up = middle,
        }
    }
    assert!(pressed(down).1 < 1e-9);
}

#[test]
fn derivatives_depend_on_the_state_alone() {
    let mut differences =
        Differences::new(Arc::new(load("humanoid.xml")), RigidOptions::new(), 100);
    let sim = &mut differences.sim;
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let first = linearizer
        .linearize(sim, &Request::default())
        .expect("derivatives")
        .clone();
    // The state does not change, and the same state gives the same derivatives.
    assert_eq!(sim.state, differences.from);
    let again = linearizer
        .linearize(sim, &Request::default())
        .expect("derivatives");
    assert_eq!(&first, again);
}

/// The derivatives by anchors, which follow from sites, do not depend on the other parameters of a request.
#[test]
fn anchors_that_follow_from_sites() {
    let text = r#"<mujoco>
      <worldbody>
        <body pos="0 0 1"><freejoint/><geom size=".1 .05 .02" type="box"/><site name="s" pos=".05 0 .1"/></body>
        <body pos=".3 0 1"><freejoint/><geom size=".1 .05 .02" type="box"/><site name="t" pos=".05 0 .1"/></body>
      </worldbody>
      <equality><weld site1="s" site2="t"/></equality>
    </mujoco>"#;
    let model = Arc::new(clench_formats::load_str(text).expect("a model"));
    let mut sim = Sim::new(Arc::clone(&model)).expect("a simulation");
    // Inertias matter to a body that spins.
    sim.state.qvel[3..6].copy_from_slice(&[1.0, 2.0, 3.0]);
    (0..5).for_each(|_| sim.step().expect("a step"));
    // Now the anchors differ from the sites.
    sim.weld_here(0).expect("an equality");
    let mut linearizer = Linearizer::new(&model).expect("lanes of this processor");
    let mut derivatives = |parameters: &[(ParamField, usize)]| {
        let request = Request {
            parameters: parameters.to_vec(),
            ..Request::default()
        };
        let linear = linearizer.linearize(&sim, &request).expect("derivatives");
        linear.e.clone()
    };
    let parameters = [
        (ParamField::eq_anchor2, 0),
        (ParamField::site_pos, 4),
        (ParamField::eq_anchor1, 1),
        (ParamField::site_quat, 2),
        (ParamField::body_inertia, 5),
        (ParamField::eq_quat1, 3),
        (ParamField::site_pos, 1),
        (ParamField::eq_anchor2, 1),
    ];
    let together = derivatives(&parameters);
    for (column, &parameter) in parameters.iter().enumerate() {
        let alone = derivatives(&[parameter]).values;
        let rows = together.values.chunks_exact(parameters.len());
        let found = Vec::from_iter(rows.map(|row| row[column]));
        assert!(alone.iter().any(|x| x.abs() > 1e-3), "{parameter:?}");
        for (x, y) in found.iter().zip(&alone) {
            assert!(
                (x - y).abs() < 1e-12 * (1.0 + y.abs()),
                "{parameter:?}: {x}, {y}"
            );
        }
    }
}
