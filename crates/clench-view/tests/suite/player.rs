//! The moments of a motion that users can go back to.

use clench::prelude::RigidOptions;
use clench::{Sim, load_str};
use clench_view::{Command, Player};
use std::sync::Arc;

#[test]
fn no_moment_before_a_reset_is_shown_after_it() {
    let stiff = "<mujoco><option gravity='0 0 0' timestep='0.01'/><worldbody><body>
        <joint type='slide' stiffness='40100'/><geom size='0.1' mass='1'/></body></worldbody></mujoco>";
    let model = Arc::new(load_str(stiff).expect("the model is valid"));
    let options = RigidOptions {
        autoreset: Some(true),
        ..RigidOptions::default()
    };
    let sim = Sim::<f64>::with_options(model, options).expect("it can be simulated");
    let mut player = Player::new(sim, true);
    let position = Command::Position {
        index: 0,
        value: 1.0,
    };
    player.apply(position).expect("the joint is a slide");
    // It diverges and stands still afterwards.
    player
        .apply(Command::Step { count: 300 })
        .expect("it is reset");
    let time = player.viewed().state.time;
    assert!(player.viewed().resets() == 1 && time > 1.0, "{time}");
    player
        .apply(Command::Rewind { seconds: 0.5 })
        .expect("there is a past");
    let state = &player.viewed().state;
    assert!((time - 0.5 - state.time).abs() < 0.02, "{}", state.time);
    assert_eq!(state.qpos, [0.0], "the state is one after the reset");
}

#[test]
fn a_reset_returns_to_the_keyframe_of_the_start() {
    let slide =
        "<mujoco><worldbody><body><joint type='slide'/><geom size='0.1'/></body></worldbody>
        <keyframe><key qpos='0.3'/><key qpos='0.7'/></keyframe></mujoco>";
    let model = Arc::new(load_str(slide).expect("the model is valid"));
    let sim = Sim::<f64>::new(model).expect("it can be simulated");
    let mut player = Player::new(sim, true);
    for (start, expected) in [(None, 0.0), (Some(1), 0.7)] {
        player.interaction().start = start;
        player.apply(Command::Reset {}).expect("it is reset");
        assert_eq!(player.viewed().state.qpos, [expected]);
    }
}
