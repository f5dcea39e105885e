//! What files say of sensors, and what is refused.

use clench_formats::load_str;
use clench_rigid::model::{FrameObject, SensorData, SensorKind, SensorTarget};

const BODIES: &str = "<worldbody><geom name='floor' type='plane' size='1 1 1'/>
    <body name='arm'><joint name='hinge'/><geom name='rod' size='.1'/><site name='tip' type='box' size='.1 .2 .3'/>
    <body name='hand'><joint name='ball' type='ball'/><geom name='fist' size='.1'/></body></body></worldbody>
    <actuator><motor name='motor' joint='hinge'/></actuator>";

fn model(sensors: &str) -> Result<clench_rigid::Model, String> {
    let text = format!("<mujoco>{BODIES}<sensor>\n{sensors}</sensor></mujoco>");
    load_str(&text).map_err(|error| error.to_string())
}

#[test]
fn sensors_have_their_places_in_the_order_of_the_file() {
    let model = model(
        "<gyro name='spin' site='tip' cutoff='3' noise='.1'/><clock/><framequat objtype='xbody' objname='hand'
         reftype='geom' refname='rod'/><user name='mine' dim='5' datatype='positive'/>",
    )
    .expect("valid");
    let numbers: Vec<_> = model.sensors.iter().map(|s| s.numbers.clone()).collect();
    assert_eq!(numbers, [0..3, 3..4, 4..8, 8..13]);
    assert_eq!(model.nsensordata(), 13);
    assert_eq!(model.sensor("mine"), Some(3));
    assert_eq!(
        (model.sensors[0].cutoff, model.sensors[0].noise),
        (3.0, 0.1)
    );
    assert_eq!(model.sensors[3].data, SensorData::Positive);
    let expected = SensorTarget::Frame {
        object: FrameObject::Body(2),
        reference: Some(FrameObject::Geom(1)),
    };
    assert_eq!(model.sensors[2].target, expected);
    assert_eq!(model.sensors[2].kind, SensorKind::FrameQuat);
}

#[test]
fn what_no_sensor_can_be_is_refused_with_its_line() {
    for (sensor, reason) in [
        ("<gyro site='no'/>", "there is no site \"no\""),
        ("<gyro/>", "the attribute \"site\" is required"),
        ("<gyro site='tip' cutoff='-1'/>", "cutoff"),
        ("<gyro site='tip' noise='nan'/>", "noise"),
        (
            "<gyro site='tip' joint='hinge'/>",
            "unknown attribute \"joint\"",
        ),
        (
            "<gyro site='tip' nsample='4'/>",
            "nsample is not supported yet",
        ),
        ("<giro site='tip'/>", "did you mean \"gyro\"?"),
        ("<jointpos joint='ball'/>", "must be a slide or a hinge"),
        ("<ballquat joint='hinge'/>", "must be a ball joint"),
        ("<framepos objname='arm'/>", "objtype"),
        ("<framepos objtype='body'/>", "objname"),
        ("<framepos objtype='arm' objname='arm'/>", "objtype"),
        ("<framepos objtype='camera' objname='eye'/>", "camera"),
        (
            "<framepos objtype='body' objname='arm' reftype='site'/>",
            "refname",
        ),
        (
            "<framelinacc objtype='body' objname='arm' reftype='site' refname='tip'/>",
            "reftype",
        ),
        (
            "<framequat objtype='body' objname='arm' cutoff='1'/>",
            "no cutoff",
        ),
        ("<distance geom1='rod'/>", "either geom2 or body2"),
        ("<distance geom1='rod' body1='arm' geom2='fist'/>", "body1"),
        ("<distance geom1='rod' geom2='rod'/>", "must be different"),
        ("<user/>", "dim"),
        ("<user dim='99999999'/>", "numbers"),
        ("<clock name='a'/><clock name='a'/>", "taken already"),
        ("<contact/>", "not supported yet"),
    ] {
        let error = model(sensor).expect_err(sensor);
        assert!(error.contains(reason), "{sensor}: {error}");
        assert!(error.contains('5'), "{sensor} names no line: {error}");
    }
}

#[test]
fn a_site_needs_a_volume() {
    for (site, reason) in [
        ("<site size='0'/>", "positive"),
        ("<site type='box' size='.1 -.1 .1'/>", "positive"),
        ("<site type='plane'/>", "plane"),
    ] {
        let text = format!("<mujoco><worldbody>\n{site}</worldbody></mujoco>");
        let error = load_str(&text).expect_err(site).to_string();
        assert!(
            error.contains(reason) && error.contains('2'),
            "{site}: {error}"
        );
    }
}
