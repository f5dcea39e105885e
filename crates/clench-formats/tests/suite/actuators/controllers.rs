//! PID controllers and DC motors: the parameters set by their attributes, and the values inherited from their classes.

use super::{actuator, rejected, servo};
use clench_formats::load_str;
use clench_rigid::model::{BiasKind, ControlInput, DynamicsKind, GainKind};

#[test]
fn a_pid_is_a_servo_with_an_integral_and_setpoints_of_its_own() {
    let plain = actuator("", "<pid joint='j'/>");
    let kinds = (plain.dynamics, plain.gain, plain.bias);
    assert_eq!(kinds, (DynamicsKind::None, GainKind::Pid, BiasKind::Affine));
    assert_eq!((servo(&plain), plain.inputs), ([0.0, -1.0, 0.0], None));
    let whole = actuator(
        "<pid kp='3' velrange='-1 1' input='pos ff'/>",
        "<pid joint='j' kv='2' ki='4' imax='5' slewmax='6' posrange='-7 7' ctrlrange='-8 8'/>",
    );
    assert_eq!(whole.dynamics, DynamicsKind::Pid);
    assert_eq!(servo(&whole), [4.0, -3.0, -2.0]);
    assert_eq!(whole.dynprm[..2], [5.0, 6.0]);
    assert_eq!(
        (whole.ctrlrange, whole.velrange),
        ([-7.0, 7.0], [-1.0, 1.0])
    );
    assert_eq!(
        whole.inputs,
        Some(vec![ControlInput::Position, ControlInput::Feedforward])
    );
    assert_eq!(actuator("", "<pid joint='j' imax='5'/>").dynprm[0], 0.0);
    assert!(rejected("<pid joint='j' input='vel pos'/>").contains("order"));
    assert!(rejected("<pid joint='j' posrange='0 1' inheritrange='1'/>").contains("both"));
}

/// The expected numbers are MuJoCo's.
#[test]
fn a_dc_motor_finds_its_constants() {
    let constants = |element: &str| {
        let motor = actuator("", &format!("<dcmotor joint='j' {element}/>"));
        [motor.gainprm[0], motor.gainprm[1]].map(|x| (1e6 * x).round() / 1e6)
    };
    assert_eq!(
        constants("resistance='2' motorconst='.5 .4'"),
        [2.0, 0.447214]
    );
    assert_eq!(constants("resistance='2' motorconst='.5'"), [2.0, 0.5]);
    assert_eq!(constants("nominal='12 3 100'"), [0.48, 0.12]);
    assert_eq!(
        constants("nominal='12 3 100' damping='.001'"),
        [0.464, 0.116]
    );
    let damped = "nominal='12 3 100' damping='.001' resistance='2'";
    assert_eq!(constants(damped), [2.0, 0.1]);
    let half = "nominal='12 3 100' motorconst='.3 0'";
    assert_eq!(constants(half), [0.758947, 0.189737]);
    assert!(rejected("<dcmotor joint='j'/>").contains("motor constant"));
    assert!(rejected("<dcmotor joint='j' motorconst='1'/>").contains("resistance"));
    assert!(rejected("<dcmotor joint='j' motorconst='-1 1' resistance='1'/>").contains("negative"));
    assert_eq!(constants("resistance='1' input='none'"), [1.0, 0.0]);
}

#[test]
fn the_options_of_a_dc_motor_overwrite_those_of_its_class() {
    let class = "<dcmotor resistance='2' motorconst='.5 .4' inductance='.1' saturation='1 3 5' \
        thermal='1 2 0 .004 20 30' lugre='1 2 3 4 5' cogging='1 2 3' input='pos' controller='1 2 3 4 5 6'/>";
    let motor = actuator(class, "<dcmotor joint='j'/>");
    assert_eq!(
        motor.dynprm,
        [0.05, 5.0, 1.0, 2.0, 30.0, 1.0, 2.0, 4.0, 5.0, 0.0]
    );
    assert_eq!(motor.gainprm[2..8], [0.004, 20.0, 1.0, 2.0, 3.0, 6.0]);
    assert_eq!(motor.biasprm[..6], [1.0, 2.0, 3.0, 3.0, 4.0, 5.0]);
    assert_eq!((motor.forcerange, motor.actearly), ([-1.0, 1.0], true));
    let other = "<dcmotor joint='j' inductance='0' saturation='0 2' thermal='4 3 2' lugre='0' cogging='5' controller='7'/>";
    let other = actuator(class, other);
    assert_eq!(
        other.dynprm,
        [0.0, 5.0, 4.0, 0.5, 30.0, 0.0, 0.0, 4.0, 5.0, 0.0]
    );
    assert_eq!(other.gainprm[4..8], [7.0, 2.0, 3.0, 6.0]);
    assert_eq!(other.biasprm[..6], [5.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
    assert!((other.forcerange[1] - 2.0 * other.gainprm[1]).abs() < 1e-15);
    let free = actuator(class, "<dcmotor joint='j' saturation='0'/>");
    assert_eq!((free.forcerange, free.forcelimited), ([0.0; 2], None));
}

/// A positive current makes the range of a negative torque count; the builder refuses it, as MuJoCo does.
#[test]
fn a_negative_saturation_with_a_current_is_no_range() {
    let motor = |saturation: &str| {
        let element = format!("<dcmotor resistance='2' motorconst='.5' saturation='{saturation}'");
        let found = actuator("", &format!("{element} joint='j'/>"));
        (found.forcerange, found.forcelimited)
    };
    for free in ["-1", "-1 0", "-1 -1", "0 -1"] {
        assert_eq!(motor(free), ([0.0; 2], None), "{free}");
    }
    assert_eq!(motor("1 -1"), ([-1.0, 1.0], Some(true)));
    let text =
        "<mujoco><worldbody><body><joint name='j'/><geom size='1'/></body></worldbody><actuator>
        <dcmotor joint='j' resistance='2' motorconst='.5' saturation='-1 1'/></actuator></mujoco>";
    let error = load_str(text).expect_err("no range").to_string();
    assert!(error.contains("forcerange must be increasing"), "{error}");
}

#[test]
fn a_class_lends_the_saturation_of_its_motor() {
    let range = |within: &str, element: &str| {
        let classes = format!(
            "<dcmotor resistance='2' motorconst='.5' saturation='0 4'/><default class='c'>\
             <motor forcerange='-.4 .2'/>{within}</default>"
        );
        let found = actuator(&classes, &format!("<{element} class='c' joint='j'/>"));
        (found.forcerange, found.forcelimited)
    };
    let lent = ([-2.0, 2.0], Some(true));
    assert_eq!(range("", "motor"), ([-0.4, 0.2], Some(true)));
    assert_eq!(range("", "dcmotor"), lent);
    assert_eq!(range("", "dcmotor motorconst='3'"), lent);
    assert_eq!(range("<dcmotor cogging='1'/>", "motor"), lent);
    assert_eq!(
        range("<dcmotor saturation='0'/>", "motor"),
        ([0.0; 2], None)
    );
    // A `general` that is a motor by its class passes on the force range that it computes.
    let classes = "<dcmotor resistance='2' motorconst='.5' saturation='2'/><default class='b'>\
        <general forcerange='-5 6'/><default class='c'><motor forcerange='-.4 .2'/></default></default>";
    let found = actuator(classes, "<dcmotor class='c' joint='j'/>");
    assert_eq!(found.forcerange, [-5.0, 6.0]);
}

#[test]
fn a_pid_cannot_act_on_the_contacts_of_a_body() {
    let text = "<mujoco><worldbody><body name='b'><joint/><geom size='1'/></body></worldbody><actuator>
        <general body='b' gaintype='pid' biastype='affine' gainprm='0 1 1' biasprm='0 -1 -1'/></actuator></mujoco>";
    let error = load_str(text).expect_err("of a body").to_string();
    assert!(
        error.contains("cannot act on the contacts of a body"),
        "{error}"
    );
}

#[test]
fn inputs_describe_the_controls_if_the_gain_scales_them() {
    assert_eq!(
        actuator("", "<general joint='j' input='pos'/>")
            .inputs
            .map(|inputs| inputs.len()),
        Some(1)
    );
    assert!(rejected("<general joint='j' input='ff'/>").contains("\"ff\" is incompatible"));
    assert!(
        rejected("<general joint='j' gaintype='user' input='pos'/>").contains("is incompatible")
    );
    let class = "<pid input='pos'/>";
    let changed = actuator(
        class,
        "<general joint='j' gaintype='fixed' biastype='none'/>",
    );
    assert_eq!(changed.inputs, None);
}

#[test]
fn a_general_of_a_motors_class_has_its_activations_and_no_range_of_them() {
    let class = "<default class='c'><dcmotor motorconst='.1' resistance='1' lugre='9 .1 .2 .3 .4'/></default>";
    let user =
        "class='c' joint='j' dyntype='user' gaintype='user' biastype='affine' actrange='-1 1'";
    let general = actuator(class, &format!("<general {user}/>"));
    assert_eq!((general.actdim, general.actlimited), (Some(1), Some(false)));
    assert!(general.actearly);
    let class = "<default class='c'><dcmotor motorconst='.1' resistance='1'/></default>";
    let pid = "class='c' joint='j' dyntype='pid' gaintype='pid' biastype='affine' dynprm='0 2'";
    assert_eq!(actuator(class, &format!("<general {pid}/>")).actdim, None);
    // Other shortcuts reset the attributes except for the range.
    let range = "<general actlimited='true' actrange='-1 1' dyntype='filter'/>";
    let cylinder = actuator(range, "<cylinder joint='j'/>");
    assert_eq!(
        (cylinder.actlimited, cylinder.actrange),
        (None, [-1.0, 1.0])
    );
}

#[test]
fn an_orientation_servo_between_sites_damps_nothing() {
    let load = |servo: &str| {
        clench_formats::load_str(&format!(
            "<mujoco><default><general damping='1'/></default>
             <worldbody>
               <site name='w'/><body><joint name='j' type='ball'/><geom size='1'/><site name='s'/></body>
             </worldbody>
             <actuator><orientation {servo}/></actuator></mujoco>"
        ))
    };
    load("joint='j'").expect("it is a valid model");
    let error = load("site='s' refsite='w'").expect_err("MuJoCo refuses it");
    assert!(error.message.contains("damping and armature"), "{error}");
}
