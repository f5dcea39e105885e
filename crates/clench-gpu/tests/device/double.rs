//! Double precision: each stage equals its processor counterpart to rounding, a stricter test than single precision.

use crate::common::{self, Random, general_batch, own, random_state, text};
use clench_rigid::State;
use clench_rigid::model::Model;
use std::path::PathBuf;
use std::sync::Arc;

/// Asserts that every field of `count` random states is within `tolerance` of the processor's in double precision.
fn agree(model: &Arc<Model>, count: usize, spread: f64, tolerance: f64) {
    let mut random = Random::new(3);
    let states = Vec::from_iter((0..count).map(|_| random_state(model, &mut random, spread)));
    agree_in(model, &states, tolerance);
}

/// Asserts the same of given states.
fn agree_in(model: &Arc<Model>, states: &[State<f32>], tolerance: f64) {
    let Some(mut batch) = general_batch::<f64>(model, states.len()) else {
        return;
    };
    common::forward_agrees_in_double(&mut batch, states, tolerance);
}

/// The rounding error relative to the largest number of a field: sums have another order than on the processor.
const TOLERANCE: f64 = 1e-9;

#[test]
fn joints_tendons_actuators_and_constraints_agree() {
    for name in ["medley", "linkage"] {
        agree(&text(&own(name)), 20, 0.5, TOLERANCE);
    }
}

/// Tests a current with a time constant slightly longer than a step.
#[test]
fn currents_of_motors_agree() {
    let file = "<mujoco>
          <option timestep='0.002'/>
          <worldbody><body><joint name='shaft'/><geom size='0.1'/></body></worldbody>
          <actuator><dcmotor joint='shaft' resistance='1' inductance='0.0045 0' motorconst='0.1' input=''/></actuator>
        </mujoco>";
    agree(&text(file), 20, 0.5, TOLERANCE);
}

/// Double precision resolves the cases in such a heap that single precision leaves undecided.
#[test]
fn shapes_that_overlap_agree() {
    agree(&text(&own("hulls")), 20, 1.0, 1e-6);
}

#[test]
fn solves_take_as_many_iterations_as_on_the_processor() {
    for option in ["cone='pyramidal'", "cone='elliptic'"] {
        for name in ["runner", "medley"] {
            common::efforts::efforts_agree::<f64>(&own(name), option, 0.01);
        }
    }
}

/// Tests contacts three times as stiff as their impedance says: the estimate of their inverse inertia is the mean over
/// three directions, in two of which a body hardly moves.
#[test]
fn very_stiff_cones_are_approached_as_on_the_processor() {
    let body = "<body pos='0 0 0.098'>
          <joint axis='0 1 0' pos='-1 0 0'/>
          <joint type='slide' axis='1 0 0' armature='20'/>
          <geom size='0.1' mass='1' friction='0.8'/>
        </body>";
    let file = format!(
        "<mujoco model='stiff cones'>
           <option cone='elliptic'/>
           <default><geom solimp='0.9999 0.9999 0.001'/></default>
           <worldbody><geom type='plane' size='1 1 1'/>{body}</worldbody>
         </mujoco>"
    );
    if let Some(effort) = common::efforts::efforts_agree::<f64>(&file, "gravity='2 0 -9.81'", 0.01)
    {
        assert!(effort.iterations > 100, "no stages: {effort:?}");
    }
}

/// In some micrometres of this window the end of a cylinder misses a triangle by less than the gap's tolerance shows.
#[test]
fn cylinders_at_the_edge_of_a_step_agree() {
    let row = format!("{}{}", "0 ".repeat(10), "1 ".repeat(11));
    let file = format!(
        "<mujoco>
           <asset><hfield name='step' nrow='21' ncol='21' size='1 1 0.01 0.1' elevation='{}'/></asset>
           <worldbody>
             <geom type='hfield' hfield='step'/>
             <body pos='0 0 0.103996' euler='90 0 0'><freejoint/><geom type='cylinder' size='0.1 0.05'/></body>
           </worldbody>
         </mujoco>",
        row.repeat(21)
    );
    let model = text(&file);
    let shifted = |k: usize| {
        let mut state = random_state(&model, &mut Random::new(1), 0.0);
        state.qpos[0] = (-0.059_95 + k as f64 * 1e-6) as f32;
        state
    };
    agree_in(&model, &Vec::from_iter((0..100).map(shifted)), 1e-6);
}

/// Compares light fingers on heavy arms, for which single precision is not accurate enough.
#[test]
fn manipulators_agree() {
    let Some(folder) = std::env::var_os("CLENCH_DM_CONTROL").map(PathBuf::from) else {
        eprintln!("skipped: CLENCH_DM_CONTROL names no folder");
        return;
    };
    for name in ["manipulator", "stacker"] {
        agree(
            &common::folders::public(&folder, name),
            20,
            0.5,
            10.0 * TOLERANCE,
        );
    }
}

/// Asserts that `steps` steps of a model reach the states of the processor's double precision.
fn arrive(name: &str, integrator: &str, steps: usize) {
    let option = format!("<option integrator=\"{integrator}\" ");
    let model = text(&own(name).replace("<option ", &option));
    if let Some(mut batch) = general_batch(&model, 8) {
        common::doubles_arrive(&mut batch, steps);
    }
}

#[test]
fn steps_arrive_where_those_of_the_processor_do() {
    arrive("medley", "implicitfast", 20);
    arrive("runner", "RK4", 20);
}
