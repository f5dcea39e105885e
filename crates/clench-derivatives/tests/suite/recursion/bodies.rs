//! Bodies that are tied, lifted, pushed or free.

use super::{check, check_text};
use crate::common::load;
use clench_math::Vec3;
use clench_rigid::options::RigidOptions;

/// Connects and welds between bodies of one tree, of two trees, and of a tree and the world.
pub(super) fn tied(integrator: &str) -> String {
    format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004"/>
          <worldbody>
            <body name="mocap" mocap="true" pos="-.4 .1 .3" quat="1 .2 .1 0"/>
            <body name="a" pos="0 0 .5">
              <joint type="ball" damping=".01"/>
              <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
              <body name="b" pos=".2 0 0">
                <joint axis="0 1 0" pos=".01 0 0"/><joint type="slide" axis="1 0 .2" damping="1"/>
                <geom type="capsule" fromto="0 0 0 .2 .1 0" size=".02"/>
              </body>
              <body name="c" pos=".1 .1 0">
                <joint axis="0 .1 1"/>
                <geom type="box" size=".05 .03 .02"/>
                <body name="d" pos=".1 0 0"><joint axis="1 1 0"/><geom type="box" size=".05 .03 .02"/></body>
              </body>
            </body>
            <body name="e" pos=".3 0 .2">
              <joint type="ball"/><geom type="ellipsoid" pos=".1 0 0" size=".1 .05 .03"/>
            </body>
            <body name="f" pos="-.3 0 .2">
              <joint axis="1 0 .3"/><joint type="ball" pos=".1 0 0"/><geom type="box" pos=".1 .1 0" size=".1 .05 .03"/>
            </body>
          </worldbody>
          <contact><exclude body1="b" body2="e"/><exclude body1="c" body2="b"/><exclude body1="b" body2="d"/></contact>
          <equality>
            <connect body1="b" body2="d" anchor=".1 .1 0"/>
            <connect body1="e" body2="a" anchor=".12 0 .1"/>
            <weld body1="d" body2="e" torquescale=".3" relpose=".1 .1 .2 1 .3 .2 .1" solref=".1 1"/>
            <weld body1="f" body2="mocap" solimp=".8 .95 .5 .5 2" solref=".2 1"/>
            <weld body1="f" relpose="-.4 .1 .2 1 .4 0 .3" solref=".1 .5"/>
          </equality>
        </mujoco>"#
    )
}

#[test]
fn connects_and_welds() {
    for integrator in ["Euler", "implicitfast", "RK4"] {
        check_text(&tied(integrator), &["equality"], |_| {});
    }
    check_text(&tied("Euler"), &["equality", "dynamic"], |sim| {
        let bodies = &sim.model().bodies;
        let body = |name: &str| bodies.iter().position(|body| body.name == name);
        let [a, b, c, f] = ["a", "b", "c", "f"].map(|name| body(name).expect("a body"));
        sim.add_weld(c, b).expect("a slot");
        sim.add_connect(f, a, Vec3::new(0.1, 0.0, 0.3))
            .expect("a slot");
    });
    check(load("four_bar.xml"), RigidOptions::new(), 100);
}

/// Gravity compensation, in part by actuators, and forces and torques that a user applies.
#[test]
fn forces_on_bodies() {
    let text = r#"<mujoco>
      <option integrator="Euler" timestep="0.004" gravity="1 2 -9"/>
      <worldbody>
        <body gravcomp=".7" pos="0 0 .5">
          <joint type="free" damping=".5"/><geom type="box" size=".1 .05 .03"/>
          <body pos=".1 0 0" gravcomp="1.2">
            <joint name="a" axis="0 1 .2" pos="-.02 .01 0" actuatorgravcomp="true"/>
            <geom type="capsule" fromto="0 0 0 .2 0 .1" size=".03"/>
            <body pos=".2 0 .1" gravcomp="1">
              <joint name="b" type="slide" axis="1 0 0" actuatorgravcomp="true" actuatorfrcrange="-1 1"
                actuatorfrclimited="true"/>
              <joint type="ball" pos="0 .05 0" damping=".02"/>
              <geom type="capsule" fromto="0 0 0 .1 .1 .1" size=".02"/>
              <body pos=".1 .1 .1" gravcomp="-.5"><geom size=".03"/></body>
            </body>
          </body>
        </body>
      </worldbody>
      <actuator><motor joint="a"/><position joint="b" kp="10" kv="1"/></actuator>
    </mujoco>"#;
    check_text(text, &[], |_| {});
    let text = text.replace("Euler", "implicitfast");
    check_text(&text, &[], |sim| {
        for (b, wrench) in sim.state.xfrc_applied.iter_mut().enumerate() {
            let x = b as f64;
            (wrench.linear.x, wrench.linear.y, wrench.linear.z) = (0.5 - x, 0.3, 0.2 * x);
            (wrench.angular.x, wrench.angular.y, wrench.angular.z) = (0.02, -0.03 * x, 0.01);
        }
    });
}

/// Free bodies that spin, with and without a welded or jointed child, whose gyroscopic forces act at the end of a step.
#[test]
fn free_bodies_with_implicit_steps() {
    let text = r#"<mujoco>
      <option integrator="implicitfast" timestep="0.004"/>
      <worldbody>
        <geom type="plane" size="2 2 .1"/>
        <body pos="0 0 .2">
          <freejoint/><geom type="box" size=".1 .05 .02" pos=".05 .02 .03" euler="20 30 10"/>
          <body pos=".1 0 .1"><geom type="capsule" size=".02 .1"/></body>
        </body>
        <body pos="0 .5 .2">
          <joint type="free" damping=".1" stiffness=".3"/><geom type="ellipsoid" size=".1 .06 .03"/>
        </body>
        <body pos="0 -.5 .2">
          <freejoint/><geom type="box" size=".1 .05 .02"/>
          <body pos=".1 0 0"><joint axis="0 1 1" damping=".01"/><geom type="capsule" size=".02 .1"/></body>
        </body>
      </worldbody>
    </mujoco>"#;
    check_text(text, &["contact"], |sim| {
        for (i, v) in sim.state.qvel.iter_mut().enumerate() {
            *v = (i as f64).sin() * if i % 6 < 3 { 0.1 } else { 5.0 };
        }
    });
}
