//! Derivatives by the fields of the state other than positions, velocities, activations and controls.

use crate::differences::Differences;
use clench_derivatives::{InputTangent, Linearizer, Matrix, Request, StateField};
use clench_rigid::State;
use clench_rigid::options::RigidOptions;
use std::sync::Arc;

/// Compares the columns of the fields that a step changes and of those that a user sets. `compares` chooses among the
/// former: differences of numbers that stand for geoms mean nothing.
fn check(
    text: &str,
    options: RigidOptions,
    steps: usize,
    compares: impl Fn(&State<f64>, StateField, usize) -> bool,
) {
    let model = clench_formats::load_str(text).expect("a model");
    let mut differences = Differences::new(Arc::new(model), options, steps);
    differences.memory = true;
    let model = differences.sim.model().clone();
    let inputs = StateField::INPUTS.into_iter();
    let inputs = inputs.flat_map(|field| (0..field.count(&model)).map(move |i| (field, i)));
    let request = Request {
        inputs: inputs.collect(),
        memory: true,
        ..Request::default()
    };
    let mut linearizer = Linearizer::new(&model).expect("lanes of this processor");
    let result = linearizer.linearize(&differences.sim, &request);
    let result = result.expect("derivatives").clone();
    let mut column = 2 * model.nv + model.na;
    let mut switching = 0;
    for field in StateField::MEMORY {
        for i in 0..field.count(&model) {
            if compares(&differences.from, field, i) {
                switching += differences.compare([&result.a, &result.c], column, |sim, h| {
                    *field.number(&mut sim.state, i) += h;
                });
            }
            column += 1;
        }
    }
    assert_eq!(result.a.shape, [column, column]);
    for (column, &(field, i)) in request.inputs.iter().enumerate() {
        switching += differences.compare([&result.e, &result.f], column, |sim, h| {
            *field.number(&mut sim.state, i) += h;
        });
    }
    assert_eq!(switching, 0);

    // The product with ones.
    differences.sim.state.copy_from(&differences.from);
    let ones = |rows: usize| Matrix {
        shape: [rows, 1],
        values: vec![1.0; rows],
    };
    let tangent = InputTangent {
        x: ones(column),
        u: ones(model.nu()),
        p: ones(request.inputs.len()),
    };
    let along = linearizer.jvp(&differences.sim, &request, &tangent);
    let along = along.expect("a directional derivative").x.values.iter();
    for (row, found) in along.enumerate() {
        let parts = [&result.a, &result.b, &result.e].map(|matrix| {
            let width = matrix.shape[1];
            &matrix.values[row * width..][..width]
        });
        let (sum, size) = parts.concat().iter().fold((0.0, 1.0), |(sum, size), x| {
            (sum + x, f64::max(size, x.abs()))
        });
        assert!((found - sum).abs() < 1e-11 * size, "{found} {sum}");
    }
}

#[test]
fn delays_rest_positions_and_applied_forces() {
    let text = r#"<mujoco>
      <option timestep="0.005"/>
      <worldbody>
        <body name="hand" mocap="true" pos="0 0 1"><geom size=".02" contype="0" conaffinity="0"/></body>
        <body name="load" pos="0 0 .9">
          <freejoint/>
          <geom type="box" size=".05 .04 .03"/>
        </body>
        <body pos="1 0 1">
          <joint name="a" axis="0 1 0" stiffness="20" springyield="3" springref="40" damping=".1"/>
          <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
          <body pos=".2 0 0">
            <joint name="b" type="ball" stiffness="3" springyield="2" damping=".1"/>
            <geom type="capsule" fromto="0 0 0 .2 0 -.1" size=".03"/>
          </body>
        </body>
      </worldbody>
      <equality><weld body1="hand" body2="load"/></equality>
      <actuator>
        <motor joint="a" nsample="4" interp="linear" delay=".0125"/>
        <motor joint="a" nsample="5" interp="cubic" delay=".0125"/>
      </actuator>
      <sensor>
        <jointpos joint="a" nsample="4" interp="linear" delay=".012"/>
        <framepos objtype="body" objname="load" nsample="3" interval=".01 0"/>
      </sensor>
    </mujoco>"#;
    let model = clench_formats::load_str(text).expect("a model");
    // The first number of a buffer is the time when a sample is due.
    let due = Vec::from_iter(model.histories().map(|history| history.start));
    for integrator in ["Euler", "implicitfast", "RK4"] {
        let option = format!(r#"<option integrator="{integrator}" timestep"#);
        let text = text.replacen("<option timestep", &option, 1);
        check(&text, RigidOptions::new(), 60, |_, field, i| {
            field != StateField::History || !due.contains(&i)
        });
    }
}

#[test]
fn stick_references() {
    let text = r#"<mujoco>
      <worldbody>
        <geom type="plane" size="2 2 .1" euler="0 8 0"/>
        <body pos="0 0 .1" euler="0 8 0">
          <freejoint/>
          <geom type="box" size=".1 .1 .1"/>
        </body>
        <body pos="1 0 .5">
          <joint axis="0 1 0" frictionloss=".5"/>
          <geom type="capsule" fromto="0 0 0 .1 0 0" size=".03"/>
        </body>
      </worldbody>
    </mujoco>"#;
    let sticking = RigidOptions::new().stiction(true);
    check(text, sticking, 60, |state, field, i| match field {
        StateField::StickReferences => {
            let slot = &state.stick_references[i / 9];
            slot.first != 0.0 && i % 9 >= 2
        }
        _ => true,
    });
}
