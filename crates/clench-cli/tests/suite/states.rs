//! States that are read and written as lines of JSON.

use crate::program::command;
use clench::formats::load_str;
use clench::{RigidOptions, Sim};
use clench_cli::protocol::NextState;
use clench_cli::state_line::apply;
use serde_json::{Value, json};
use std::sync::Arc;

/// A motor whose control acts 10 ms later.
const DELAYED: &str = r#"<mujoco>
    <worldbody><body><joint name="j" axis="0 1 0"/><geom size=".1" pos=".2 0 0"/></body></worldbody>
    <actuator><motor joint="j" delay="0.01" nsample="6"/></actuator>
</mujoco>"#;

/// A box that the weight along a slope pulls, and friction holds.
const SLOPE: &str = r#"<mujoco>
    <option gravity="3 0 -9" cone="elliptic"/>
    <worldbody>
        <geom type="plane" size="5 5 .1"/>
        <body pos="0 0 .0999"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    </worldbody>
</mujoco>"#;

/// Takes steps in one simulation, and steps that each begin from the line of the last; asserts that both move alike.
fn assert_continues(text: &str, options: RigidOptions, ctrl: &[f64]) {
    let model = Arc::new(load_str(text).expect("the model is valid"));
    let sim =
        || Sim::<f64>::with_options(Arc::clone(&model), options).expect("it can be simulated");
    let (mut direct, mut chained) = (sim(), sim());
    direct.state.ctrl.copy_from_slice(ctrl);
    let mut line = json!({});
    for _ in 0..100 {
        direct.step().expect("it can be stepped");
        line["ctrl"] = json!(ctrl);
        chained.reset();
        apply(&line.to_string(), &mut chained).expect("a next state is a state");
        let next = NextState::after(&mut chained, None).expect("it can be stepped");
        line = serde_json::to_value(next).expect("states can be written");
    }
    let qpos: Vec<f64> =
        serde_json::from_value(line["qpos"].clone()).expect("positions are numbers");
    for (direct, chained) in direct.state.qpos.iter().zip(&qpos) {
        assert!(
            (direct - chained).abs() < 1e-12,
            "{qpos:?} instead of {direct}"
        );
    }
}

#[test]
fn a_next_state_has_the_history_of_delays() {
    assert_continues(DELAYED, RigidOptions::default(), &[1.0]);
}

#[test]
fn a_next_state_remembers_where_contacts_stuck() {
    assert_continues(SLOPE, RigidOptions::new().stiction(true), &[]);
}

#[test]
fn the_help_of_forward_names_the_fields_of_a_state() {
    let done = command("forward --help")
        .output()
        .expect("the program can be run");
    let help = String::from_utf8_lossy(&done.stdout);
    let model = Arc::new(load_str("<mujoco/>").expect("the model is valid"));
    let mut sim = Sim::<f64>::new(model).expect("it can be simulated");
    let next = NextState::after(&mut sim, None).expect("it can be stepped");
    let next: Value = serde_json::to_value(next).expect("states can be written");
    for name in next.as_object().expect("it is an object").keys() {
        assert!(help.contains(name.as_str()), "{name} is not in: {help}");
    }
}
