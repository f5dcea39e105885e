//! Sensors of forces and accelerations, and of some bodies alone.

use super::bodies::tied;
use super::coordinates::{curved, fingers};
use super::{check, check_text};
use clench_rigid::options::RigidOptions;

/// Returns a model with sensors, and with a site in each of some bodies.
fn with(text: &str, sites: &[(&str, &str)], sensors: &str) -> String {
    let mut text = text.replace("</mujoco>", &format!("<sensor>{sensors}</sensor></mujoco>"));
    for (body, site) in sites {
        let start = text
            .find(&format!(r#"<body name="{body}""#))
            .expect("a body");
        let end = start + text[start..].find('>').expect("an end of its element") + 1;
        let site =
            format!(r#"<site name="{site}" pos=".01 .02 -.1" quat="1 .2 .3 .1" size=".2"/>"#);
        text.insert_str(end, &site);
    }
    text
}

const IMU: &str = r#"
  <gyro site="imu"/><velocimeter site="imu"/><accelerometer site="imu"/>
  <framequat objtype="site" objname="imu"/><framelinacc objtype="body" objname="front_left_hip"/>
  <accelerometer site="imu" nsample="3" interp="linear" delay=".003"/>"#;
const FEET: &str = r#"<touch site="left"/><touch site="right"/>"#;
const JOINTS: &str = r#"
  <jointpos joint="front_left_knee"/><jointvel joint="rear_right_knee"/>
  <jointactuatorfrc joint="rear_right_knee"/><actuatorfrc actuator="front_left_knee"/>"#;
const REACTIONS: &str = r#"<force site="left"/><torque site="right"/><force site="hip"/>"#;
const CONTACTS: &str = r#"
  <contact subtree1="trunk" num="3" data="found force torque dist pos normal tangent linvel angvel"/>
  <contact subtree1="trunk" reduce="netforce" data="force torque pos"/>"#;

#[test]
fn sensors_of_a_robot() {
    let text = include_str!("../../../../../models/quadruped.xml");
    let sites = [
        ("trunk", "imu"),
        ("front_left_hip", "hip"),
        ("front_left_shank", "left"),
        ("rear_right_shank", "right"),
    ];
    let all = [IMU, FEET, JOINTS, REACTIONS, CONTACTS].concat();
    let some = [IMU, FEET].concat();
    for sensors in [IMU, FEET, JOINTS, REACTIONS, CONTACTS, &some, &all] {
        check_text(&with(text, &sites, sensors), &["contact"], |_| {});
    }
    let pyramids = text.replace("elliptic", "pyramidal");
    check_text(&with(&pyramids, &sites, &all), &["contact"], |_| {});
    let implicit = text.replace("<option", r#"<option integrator="implicitfast""#);
    check_text(&with(&implicit, &sites, &all), &["contact"], |_| {});
    let runge_kutta = text.replace("<option", r#"<option integrator="RK4""#);
    check_text(&with(&runge_kutta, &sites, IMU), &["contact"], |_| {});
}

/// Sensors that read other results of a step, or forces at its start after others overwrote them, need passes.
#[test]
fn other_sensors_need_passes() {
    let text = include_str!("../../../../../models/quadruped.xml");
    let sites = [("front_left_shank", "left"), ("rear_right_shank", "right")];
    let other = r#"<e_kinetic/><jointlimitpos joint="front_left_knee"/>"#;
    let runge_kutta = text.replace("<option", r#"<option integrator="RK4""#);
    for text in [with(text, &[], other), with(&runge_kutta, &sites, FEET)] {
        let model = clench_formats::load_str(&text).expect("a model");
        assert!(check(model, RigidOptions::new(), 60) > 1);
    }
}

#[test]
fn forces_of_limits() {
    let sensors = r#"
      <jointlimitfrc joint="a0"/><tendonlimitfrc tendon="spread"/><tendonactuatorfrc tendon="flexor"/>
      <jointactuatorfrc joint="a2"/>"#;
    let text = with(&fingers("Euler"), &[], sensors);
    check_text(&text, &["limit_tendon"], |_| {});
    let cone = r#"<mujoco>
      <worldbody>
        <body>
          <joint name="ball" type="ball" range="0 40" limited="true"/>
          <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
        </body>
      </worldbody>
    </mujoco>"#;
    let text = with(cone, &[], r#"<jointlimitfrc joint="ball"/>"#);
    check_text(&text, &["limit_joint"], |sim| sim.state.qvel[0] = 3.0);
}

/// Forces in joints, which connects, welds and spatial tendons change.
#[test]
fn reactions_of_ties() {
    let sites = [("b", "b"), ("c", "c"), ("e", "e")];
    let sensors = r#"<force site="b"/><torque site="c"/><force site="e"/><torque site="e"/>"#;
    let text = with(&tied("Euler"), &sites, sensors);
    check_text(&text, &["equality"], |_| {});
    let sensors = r#"
      <force site="a1"/><torque site="side"/><torque site="f"/><tendonlimitfrc tendon="pulley"/>
      <actuatorfrc actuator="pose"/>"#;
    let text = with(&curved("Euler"), &[], sensors);
    let forces = ["equality", "friction_tendon", "limit_tendon"];
    check_text(&text, &forces, |sim| sim.state.qvel[1] = 2.0);
}
