//! The models of dm-control's suite, in the folder named by the environment variable `CLENCH_DM_CONTROL`.

use crate::common::folders;

/// Each model with the number of states and their spread around the initial one.
const MODELS: &[(&str, usize, f64)] = &[
    ("acrobot", 100, 1.0),
    ("ball_in_cup", 100, 0.5),
    ("cartpole", 100, 0.5),
    ("cheetah", 100, 0.3),
    ("dog", 100, 0.3),
    ("finger", 100, 0.5),
    ("fish", 100, 0.5),
    ("hopper", 100, 0.5),
    ("humanoid", 100, 0.5),
    ("humanoid_CMU", 100, 0.5),
    ("pendulum", 100, 1.0),
    ("point_mass", 100, 0.5),
    ("quadruped", 100, 0.3),
    ("reacher", 100, 0.5),
    ("swimmer", 100, 0.5),
    ("walker", 100, 0.5),
];

/// Unsupported models. `lqr` is a world without joints, to which its task adds bodies.
const REFUSED: &[&str] = &["lqr"];

#[test]
fn trajectories_of_dm_controls_suite_drift_as_on_the_processor() {
    folders::drift_on_folder("CLENCH_DM_CONTROL", MODELS, 200);
}

#[test]
fn stages_agree_on_the_models_of_dm_controls_suite() {
    folders::agree_on_folder("CLENCH_DM_CONTROL", MODELS, REFUSED);
}
