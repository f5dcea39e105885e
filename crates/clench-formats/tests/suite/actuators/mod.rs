//! Actuators and the parameters that their shortcuts set. The tests of controllers and motor circuits are in
//! `controllers`.

mod controllers;

use clench_formats::read_str;
use clench_rigid::builder::{ActuatorSpec, TransmissionSpec};
use clench_rigid::model::{BiasKind, ControlInput, DynamicsKind, GainKind};

/// Returns the actuator of a model with these defaults.
fn actuator(defaults: &str, element: &str) -> ActuatorSpec {
    let text =
        format!("<mujoco><default>{defaults}</default><actuator>{element}</actuator></mujoco>");
    match read_str(&text) {
        Ok(builder) => builder.actuators[0].clone(),
        Err(error) => panic!("{element}: {error}"),
    }
}

fn rejected(element: &str) -> String {
    let text = format!("<mujoco><actuator>{element}</actuator></mujoco>");
    read_str(&text).unwrap_err().message
}

/// Returns the gain, the bias on length and the bias on velocity.
fn servo(actuator: &ActuatorSpec) -> [f64; 3] {
    [
        actuator.gainprm[0],
        actuator.biasprm[1],
        actuator.biasprm[2],
    ]
}

#[test]
fn a_motor_passes_its_control_on() {
    let motor = actuator(
        "",
        "<motor name='m' joint='j' gear='2 3' ctrlrange='-1 1'/>",
    );
    assert_eq!(motor.transmission, TransmissionSpec::Joint("j".into()));
    assert_eq!((motor.gain, motor.bias, motor.dynamics), Default::default());
    assert_eq!((motor.gainprm[0], motor.ctrlrange), (1.0, [-1.0, 1.0]));
    assert_eq!(motor.gear, [2.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn an_actuator_acts_on_its_target() {
    let tendon = actuator("", "<motor tendon='t'/>").transmission;
    assert_eq!(tendon, TransmissionSpec::Tendon("t".into()));
    let parent = actuator("", "<motor jointinparent='j'/>").transmission;
    assert_eq!(parent, TransmissionSpec::JointInParent("j".into()));
    let site = actuator("", "<motor site='s'/>").transmission;
    assert_eq!(site, TransmissionSpec::Site("s".into()));
    let relative = actuator("", "<position site='s' refsite='r'/>").transmission;
    let (site, reference) = ("s".into(), "r".into());
    assert_eq!(relative, TransmissionSpec::SiteInFrame { site, reference });
    let crank = actuator(
        "<general cranklength='0.3'/>",
        "<motor cranksite='c' slidersite='s'/>",
    );
    let (pin, slider) = ("c".into(), "s".into());
    assert_eq!(
        crank.transmission,
        TransmissionSpec::SliderCrank { crank: pin, slider }
    );
    assert_eq!(crank.cranklength, 0.3);
    let body = actuator("", "<general body='b'/>").transmission;
    assert_eq!(body, TransmissionSpec::Body("b".into()));
}

#[test]
fn an_actuator_needs_exactly_one_target() {
    for (element, message) in [
        ("<motor/>", "required"),
        ("<motor refsite='r'/>", "refsite needs site"),
        ("<motor joint='j' tendon='t'/>", "both"),
        ("<motor joint='j' site='s'/>", "both"),
        ("<motor joint='j' refsite='r'/>", "refsite needs site"),
        (
            "<motor joint='j' slidersite='s'/>",
            "slidersite needs cranksite",
        ),
        (
            "<motor joint='j' cranklength='1'/>",
            "cranklength needs cranksite",
        ),
        ("<motor cranksite='c'/>", "slidersite"),
        ("<motor body='b'/>", "unknown attribute"),
        ("<adhesion ctrlrange='0 1'/>", "body"),
        ("<adhesion body='b' ctrlrange='-1 1'/>", "ctrlrange"),
        ("<adhesion body='b' ctrlrange='0 1' gain='-1'/>", "gain"),
    ] {
        let error = rejected(element);
        assert!(error.contains(message), "{element}: {error}");
    }
}

#[test]
fn an_adhesion_draws_only() {
    let adhesion = actuator("", "<adhesion body='b' ctrlrange='0 2' gain='3'/>");
    assert_eq!(adhesion.transmission, TransmissionSpec::Body("b".into()));
    assert_eq!(
        (adhesion.gainprm[0], adhesion.ctrllimited),
        (3.0, Some(true))
    );
    assert_eq!(
        (adhesion.gain, adhesion.bias),
        (GainKind::Fixed, BiasKind::None)
    );
}

#[test]
fn position_pulls_to_its_target() {
    let plain = actuator("", "<position joint='j'/>");
    assert_eq!(
        (servo(&plain), plain.bias),
        ([1.0, -1.0, 0.0], BiasKind::Affine)
    );
    let damped = actuator("", "<position joint='j' kp='3' kv='2'/>");
    assert_eq!(servo(&damped), [3.0, -3.0, -2.0]);
    let ratio = actuator("", "<position joint='j' kp='3' dampratio='0.7'/>");
    assert_eq!(
        (servo(&ratio), ratio.dampratio),
        ([3.0, -3.0, 0.0], Some(0.7))
    );
    let slow = actuator("", "<position joint='j' timeconst='0.1'/>");
    assert_eq!(
        (slow.dynamics, slow.dynprm[0]),
        (DynamicsKind::FilterExact, 0.1)
    );
    let quick = actuator("", "<position joint='j' timeconst='0'/>");
    assert_eq!(quick.dynamics, DynamicsKind::None);
    let class = "<position timeconst='0'/>";
    let filter = actuator(class, "<general joint='j' dyntype='filter'/>");
    assert_eq!(filter.dynprm[0], 0.0, "a class hands its zero on");
    let unfiltered = actuator(class, "<position joint='j'/>");
    assert_eq!(
        (unfiltered.dynamics, unfiltered.dynprm[0]),
        (DynamicsKind::None, 1.0),
        "a servo of its own begins anew"
    );
    assert!(rejected("<position joint='j' kv='1' dampratio='1'/>").contains("both"));
    assert!(rejected("<position joint='j' kv='-1'/>").contains("negative"));
}

#[test]
fn servos_dampers_and_cylinders_have_the_parameters_of_their_shortcuts() {
    let velocity = actuator("", "<velocity joint='j' kv='4'/>");
    assert_eq!(servo(&velocity), [4.0, 0.0, -4.0]);
    let integrated = actuator("", "<intvelocity joint='j' kp='4' actrange='-1 1'/>");
    assert_eq!(
        (servo(&integrated), integrated.dynamics),
        ([4.0, -4.0, 0.0], DynamicsKind::Integrator)
    );
    let class = "<general dyntype='filterexact' dynprm='0.5 0.6'/><intvelocity/>";
    let filter = actuator(class, "<general joint='j' dyntype='filter'/>");
    assert_eq!(filter.dynprm[..2], [0.5, 0.0], "its class's time constant");
    let damper = actuator("", "<damper joint='j' kv='2' ctrlrange='0 1'/>");
    assert_eq!((damper.gain, damper.gainprm[2]), (GainKind::Affine, -2.0));
    assert_eq!(damper.ctrllimited, Some(true));
    let cylinder = actuator(
        "",
        "<cylinder joint='j' timeconst='.2' diameter='2' bias='1 2 3'/>",
    );
    assert_eq!(
        (cylinder.dynamics, cylinder.dynprm[0]),
        (DynamicsKind::Filter, 0.2)
    );
    assert!((cylinder.gainprm[0] - std::f64::consts::PI).abs() < 1e-15);
    assert_eq!(cylinder.biasprm[..3], [1.0, 2.0, 3.0]);
}

/// A negative value of a muscle's own attribute counts as unset, so `scale` determines the force.
#[test]
fn a_muscle_has_the_same_parameters_for_gain_and_bias() {
    let defaults = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2, 0.0];
    let plain = actuator("", "<muscle joint='j' lengthrange='0.1 0.9'/>");
    assert_eq!((plain.gainprm, plain.biasprm), (defaults, defaults));
    assert_eq!(plain.dynprm[..3], [0.01, 0.04, 0.0]);
    let kinds = (plain.dynamics, plain.gain, plain.bias);
    let muscle = (DynamicsKind::Muscle, GainKind::Muscle, BiasKind::Muscle);
    assert_eq!((kinds, plain.lengthrange), (muscle, [0.1, 0.9]));
    let own = actuator(
        "<muscle force='7' timeconst='1 2' scale='3'/>",
        "<muscle joint='j' timeconst='-1 0.3' tausmooth='0.2' range='0.8 1.1' force='-5' lmin='0.4' vmax='2'/>",
    );
    assert_eq!(own.dynprm[..3], [0.01, 0.3, 0.2]);
    let expected = [0.8, 1.1, -1.0, 3.0, 0.4, 1.6, 2.0, 1.3, 1.2, 0.0];
    assert_eq!((own.gainprm, own.biasprm), (expected, expected));
    assert!(rejected("<muscle joint='j' tausmooth='-1'/>").contains("negative"));
    let class = "<mujoco><default><muscle tausmooth='1'/></default></mujoco>";
    let error = read_str(class).expect_err("not in a class").message;
    assert!(
        error.contains("tausmooth cannot be given in a default"),
        "{error}"
    );
}

#[test]
fn a_muscle_takes_its_parameters_from_a_general_of_its_gain() {
    let general = "<general gaintype='muscle' gainprm='0.7 1 5 6 0.3 2 3 4 5' dynprm='2 3 4'/>";
    let muscle = actuator(general, "<muscle joint='j'/>");
    assert_eq!(muscle.dynprm[..3], [2.0, 3.0, 4.0]);
    assert_eq!(muscle.gainprm[..4], [0.7, 1.0, 5.0, 6.0]);
    let other = actuator("<general gainprm='3'/>", "<muscle joint='j'/>");
    assert_eq!(other.gainprm[0], 0.75);
}

#[test]
fn a_shortcut_takes_its_parameters_from_its_own_kind_and_the_rest_from_any() {
    let position = "<position kp='5' kv='2' ctrlrange='-1 1'/>";
    assert_eq!(
        servo(&actuator(position, "<position joint='j' kp='7'/>")),
        [7.0, -7.0, -2.0]
    );
    let motor = actuator(position, "<motor joint='j'/>");
    assert_eq!(
        (servo(&motor), motor.ctrlrange),
        ([1.0, 0.0, 0.0], [-1.0, 1.0])
    );
    assert_eq!(
        servo(&actuator(position, "<velocity joint='j'/>")),
        [1.0, 0.0, -1.0]
    );
    assert_eq!(
        servo(&actuator(position, "<general joint='j'/>")),
        [5.0, -5.0, -2.0]
    );
}

#[test]
fn parameters_are_looked_for_in_ancestor_classes() {
    let classes =
        "<position kp='5'/><default class='b'><velocity kv='3' ctrlrange='0 1'/></default>";
    let position = actuator(classes, "<position joint='j' class='b'/>");
    assert_eq!(
        (servo(&position), position.ctrlrange),
        ([5.0, -5.0, 0.0], [0.0, 1.0])
    );
}

#[test]
fn a_general_default_applies_if_the_gain_matches() {
    let stiff = "<general gainprm='400' biasprm='1 -400 -3' biastype='affine' dyntype='filter' dynprm='7'/>";
    let position = actuator(stiff, "<position joint='j'/>");
    assert_eq!(
        (servo(&position), position.dynamics),
        ([400.0, -400.0, -3.0], DynamicsKind::None)
    );
    let affine = "<general gainprm='400 1 2' gaintype='affine'/>";
    assert_eq!(
        servo(&actuator(affine, "<position joint='j'/>")),
        [1.0, -1.0, 0.0]
    );
}

#[test]
fn of_inheritrange_and_a_range_the_one_on_the_actuator_counts() {
    let own_range = actuator(
        "<position inheritrange='1'/>",
        "<position joint='j' ctrlrange='0 1'/>",
    );
    assert_eq!(
        (own_range.inheritrange, own_range.ctrlrange),
        (0.0, [0.0, 1.0])
    );
    let inherits = actuator(
        "<position ctrlrange='0 1'/>",
        "<position joint='j' inheritrange='1'/>",
    );
    assert_eq!(
        (inherits.inheritrange, inherits.ctrlrange),
        (1.0, [0.0, 0.0])
    );
    assert!(rejected("<position joint='j' ctrlrange='0 1' inheritrange='1'/>").contains("both"));
}

/// As in MuJoCo, which replaces the range of a `general` actuator when it compiles a servo, and keeps it otherwise.
#[test]
fn a_general_actuator_keeps_its_range_beside_inheritrange() {
    let range_and_share = |defaults: &str, element: &str| {
        let general = actuator(defaults, element);
        (general.ctrlrange, general.actrange, general.inheritrange)
    };
    let (own, none) = ([-1.0, 1.0], [0.0; 2]);
    let no_servo = "<general joint='j' inheritrange='0.5' ctrlrange='-1 1'/>";
    assert_eq!(range_and_share("", no_servo), (own, none, 0.0));
    let no_servo = "<general joint='j' inheritrange='0.5'/>";
    let class = "<general ctrlrange='-1 1'/>";
    assert_eq!(range_and_share(class, no_servo), (own, none, 0.0));
    let integral = "<general joint='j' dyntype='integrator' inheritrange='0.5' actrange='-1 1'/>";
    assert_eq!(range_and_share("", integral), (none, own, 0.0));
    let servo =
        "<general joint='j' gainprm='3' biastype='affine' biasprm='0 -3' ctrlrange='-1 1'/>";
    let class = "<general inheritrange='0.5'/>";
    assert_eq!(range_and_share(class, servo), (own, none, 0.5));
    let class = "<general inheritrange='0.5' ctrlrange='-1 1'/>";
    assert_eq!(
        range_and_share(class, "<motor joint='j'/>"),
        (own, none, 0.0)
    );
    let text = format!(
        "<mujoco><default>{class}</default><actuator><position joint='j'/></actuator></mujoco>"
    );
    let error = read_str(&text).expect_err("a position servo of both");
    assert!(error.message.contains("both"));
}

#[test]
fn a_positive_velocity_bias_of_a_servo_is_a_damping_ratio() {
    let general = actuator(
        "",
        "<general joint='j' biastype='affine' biasprm='0 -1 2'/>",
    );
    assert_eq!((general.dampratio, general.biasprm[2]), (Some(2.0), 0.0));
}

#[test]
fn an_orientation_servo_is_a_general_actuator() {
    let orientation = actuator(
        "<orientation kp='2' input='quat'/>",
        "<orientation joint='j' kv='0.5'/>",
    );
    assert_eq!(
        (orientation.gain, orientation.bias),
        (GainKind::So3, BiasKind::So3)
    );
    assert_eq!(servo(&orientation), [2.0, -2.0, -0.5]);
    assert_eq!(orientation.inputs, Some(vec![ControlInput::Quaternion; 4]));
    let vector = actuator("", "<orientation joint='j' dampratio='1' input='expmap'/>");
    assert_eq!((vector.dampratio, vector.gainprm[0]), (Some(1.0), 1.0));
    assert_eq!(vector.inputs, Some(vec![ControlInput::RotationVector; 3]));
    for (element, what) in [
        ("<orientation joint='j' kv='1' dampratio='1'/>", "dampratio"),
        ("<orientation joint='j' kv='-1'/>", "kv"),
        ("<orientation joint='j' input='pos'/>", "input"),
        ("<orientation joint='j' gear='1'/>", "gear"),
        ("<position joint='j' input='quat'/>", "input"),
        ("<pid joint='j' kp='1' input='pos quat'/>", "input"),
    ] {
        assert!(rejected(element).contains(what), "{element}");
    }
}

/// A damping ratio applies if the bias is the negated gain, whatever its type. Otherwise the same parameter is a
/// coefficient.
#[test]
fn a_damping_ratio_of_a_class_applies_if_the_bias_opposes_the_gain() {
    let defaults = "<intvelocity kp='3' dampratio='0.6'/>";
    for gain in ["fixed", "affine"] {
        let element = format!("<general joint='j' gaintype='{gain}' inheritrange='1'/>");
        let pulls_back = actuator(defaults, &element);
        assert_eq!(
            (pulls_back.dampratio, servo(&pulls_back)),
            (Some(0.6), [3.0, -3.0, 0.0])
        );
        // Only servos inherit a range.
        assert_eq!(pulls_back.inheritrange == 1.0, gain == "fixed");
    }
    let softer = actuator(defaults, "<general joint='j' gainprm='2'/>");
    assert_eq!((softer.dampratio, servo(&softer)), (None, [2.0, -3.0, 0.6]));
}

#[test]
fn a_filter_without_a_time_constant_in_a_class_filters_no_position() {
    let kind = |dynprm: &str| {
        let general = format!("<general dyntype='filterexact' dynprm='{dynprm}'/>");
        actuator(&general, "<position joint='j'/>").dynamics
    };
    assert_eq!(kind("0"), DynamicsKind::None);
    assert_eq!(kind("0.1"), DynamicsKind::FilterExact);
}

/// MuJoCo ignores `actlimited` here: the activation is limited if and only if it has a range.
#[test]
fn an_integrated_velocity_with_a_range_is_limited() {
    for limited in ["false", "true", "auto"] {
        let element = format!("<intvelocity joint='j' actrange='-1 1' actlimited='{limited}'/>");
        assert_eq!(actuator("", &element).actlimited, None);
        let default = format!("<intvelocity actlimited='{limited}'/>");
        assert_eq!(actuator(&default, "<general joint='j'/>").actlimited, None);
    }
}

#[test]
fn damping_and_armature_come_from_any_default() {
    let own = actuator(
        "<motor damping='1 2 3' armature='0.5'/>",
        "<position joint='j' damping='4'/>",
    );
    assert_eq!((own.damping, own.armature), ([4.0, 2.0, 3.0], 0.5));
    assert!(rejected("<motor joint='j' damping='1 2 3 4'/>").contains("more than 3"));
}
