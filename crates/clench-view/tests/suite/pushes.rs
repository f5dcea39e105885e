//! The displayed forces of limits and equalities agree with statics.

use clench::{Sim, load_str};
use std::sync::Arc;

/// Returns a simulation at rest.
fn settled(body: &str, rest: &str) -> Sim<f64> {
    let text = format!(
        "<mujoco><option timestep='0.002' gravity='0 0 -10'/><worldbody>{body}</worldbody>{rest}</mujoco>"
    );
    let model = load_str(&text).expect("a model");
    let mut sim = Sim::new(Arc::new(model)).expect("a simulation");
    for _ in 0..3000 {
        sim.step().expect("a step");
    }
    sim
}

/// Asserts equality up to the residual motion of soft constraints.
fn close(found: [f64; 3], wanted: [f64; 3]) {
    let apart = found.iter().zip(wanted).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 0.05, "{found:?} {wanted:?}");
}

#[test]
fn a_weld_to_the_world_carries_the_weight_and_its_lever() {
    let body =
        "<body name='b' pos='0 0 1'><freejoint/><geom size='.1' mass='2' pos='.3 0 0'/></body>";
    let rest = "<equality><weld body1='b'/></equality>";
    let mut sim = settled(body, rest);
    let pushes = sim.pushes().unwrap();
    let [push] = &pushes[..] else {
        panic!("{pushes:?}");
    };
    assert_eq!(push.body, 1);
    close(push.force, [0.0, 0.0, 20.0]);
    // The weight exerts a torque about y, and the slightly compliant weld the opposite one.
    let lever = sim.workspace().position.xipos[1].x - push.at[0];
    assert!(lever > 0.3, "{lever}");
    close(push.torque, [0.0, -20.0 * lever, 0.0]);
}

#[test]
fn a_body_is_shown_if_the_world_is_the_first_body() {
    let body = "<body name='b' pos='0 0 1'><freejoint/><geom size='.1' mass='2'/></body>";
    let rest = "<equality><connect body1='world' body2='b' anchor='0 0 1'/></equality>";
    let pushes = settled(body, rest).pushes().unwrap();
    assert_eq!(pushes.len(), 1);
    assert_eq!(pushes[0].body, 1);
    close(pushes[0].force, [0.0, 0.0, 20.0]);
    close(pushes[0].torque, [0.0; 3]);
}

#[test]
fn limits_push_along_slides_and_about_hinges() {
    let slide = "<body><joint type='slide' axis='0 0 1' limited='true' range='0 1' damping='5'/><geom size='.1' mass='2'/></body>";
    let pushes = settled(slide, "").pushes().unwrap();
    close(pushes[0].force, [0.0, 0.0, 20.0]);
    close(pushes[0].torque, [0.0; 3]);
    let hinge = "<body><joint axis='0 1 0' limited='true' range='-1 1e-3' damping='5'/><geom size='.1' pos='.5 0 0' mass='2'/></body>";
    let mut sim = settled(hinge, "");
    let angle = sim.state.qpos[0];
    let pushes = sim.pushes().unwrap();
    close(pushes[0].force, [0.0; 3]);
    close(pushes[0].torque, [0.0, -20.0 * 0.5 * angle.cos(), 0.0]);
}

#[test]
fn inactive_equalities_are_not_shown() {
    let body = "<body><joint limited='true' range='-1 1'/><geom size='.1'/></body>";
    assert_eq!(settled(body, "").pushes().unwrap(), []);
}
