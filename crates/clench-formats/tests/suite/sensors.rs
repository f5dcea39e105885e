//! Sensors in files, and those that are refused.

use clench_formats::load_str;
use clench_math::Vec3;
use clench_rigid::model::{
    CameraMode, ContactSide, FrameObject, SensorData, SensorKind, SensorTarget,
};

const BODIES: &str = "<asset><mesh name='skin' builtin='plate' params='2 3'/></asset><worldbody><geom name='floor' type='plane' size='1 1 1'/>
    <body name='arm'><joint name='hinge'/><geom name='rod' size='.1'/><site name='tip' type='box' size='.1 .2 .3'/>
    <camera name='eye' resolution='3 2'/>
    <camera name='blind' resolution='0 2'/><camera name='huge' resolution='99999 99999'/>
    <body name='hand'><joint name='ball' type='ball'/><geom name='fist' size='.1'/></body></body>
    <body><geom name='air' contype='0' conaffinity='0' size='1'/></body><body name='bare'/></worldbody>
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
fn invalid_sensors_are_refused_with_their_line() {
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
            "<gyro site='tip' nsample='4' interval='-0.1'/>",
            "interval cannot be negative",
        ),
        (
            "<gyro site='tip' nsample='4' interval='0.1 0.1'/>",
            "within one period before zero",
        ),
        ("<gyro site='tip' delay='0.1'/>", "nsample"),
        ("<giro site='tip'/>", "did you mean \"gyro\"?"),
        ("<jointpos joint='ball'/>", "must be a slide or a hinge"),
        ("<ballquat joint='hinge'/>", "must be a ball joint"),
        ("<framepos objname='arm'/>", "objtype"),
        ("<framepos objtype='body'/>", "objname"),
        ("<framepos objtype='arm' objname='arm'/>", "objtype"),
        (
            "<framepos objtype='camera' objname='no'/>",
            "there is no camera \"no\"",
        ),
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
            "cannot have a cutoff",
        ),
        ("<distance geom1='rod'/>", "either geom2 or body2"),
        ("<distance geom1='rod' body1='arm' geom2='fist'/>", "body1"),
        ("<distance geom1='rod' geom2='rod'/>", "must be different"),
        ("<user/>", "dim"),
        ("<user dim='99999999'/>", "numbers"),
        ("<clock name='a'/><clock name='a'/>", "already in use"),
        ("<camprojection site='tip'/>", "camera"),
        (
            "<camprojection site='tip' camera='blind'/>",
            "has no pixels",
        ),
        ("<rangefinder/>", "either site or camera"),
        (
            "<rangefinder site='tip' camera='eye'/>",
            "site and camera cannot both",
        ),
        ("<rangefinder camera='blind'/>", "has no pixels"),
        ("<rangefinder camera='huge'/>", "numbers"),
        (
            "<rangefinder site='tip' data='point dist'/>",
            "in this order",
        ),
        ("<rangefinder site='tip' data='dist dist'/>", "once each"),
        (
            "<rangefinder site='tip' data='far'/>",
            "not one of dist, dir",
        ),
        (
            "<insidesite site='tip' objtype='xbody' objname='bare' enclosed='true'/>",
            "the body \"bare\" has no geom",
        ),
        (
            "<insidesite site='tip' objtype='xbody' objname='world' enclosed='true'/>",
            "the geom \"floor\" is not a bounded convex shape",
        ),
        (
            "<insidesite site='tip' objtype='camera' objname='eye' enclosed='true'/>",
            "a camera has no volume",
        ),
        (
            "<insidesite site='tip' objtype='geom' objname='rod' enclosed='yes'/>",
            "enclosed",
        ),
        ("<contact geom1='no'/>", "there is no geom \"no\""),
        (
            "<contact geom1='rod' body1='arm'/>",
            "geom1 and body1 cannot both",
        ),
        (
            "<contact site='tip' subtree1='arm'/>",
            "subtree1 and site cannot both",
        ),
        ("<contact num='0'/>", "num must be positive"),
        ("<contact num='-2'/>", "num cannot be negative"),
        ("<contact num='999999' data='pos'/>", "numbers"),
        ("<contact reduce='sum'/>", "not one of none, mindist"),
        ("<contact data='force found'/>", "in this order"),
        (
            "<contact reduce='netforce' data='linvel'/>",
            "a net force has no linvel",
        ),
        (
            "<tactile geom='fist'/>",
            "the attribute \"mesh\" is required",
        ),
        (
            "<tactile mesh='skin'/>",
            "the attribute \"geom\" is required",
        ),
        (
            "<tactile mesh='no' geom='fist'/>",
            "there is no mesh \"no\"",
        ),
        (
            "<tactile mesh='skin' geom='no'/>",
            "there is no geom \"no\"",
        ),
        (
            "<tactile mesh='skin' geom='air'/>",
            "needs a geom that can collide",
        ),
        (
            "<tactile mesh='skin' geom='fist' noise='1'/>",
            "unknown attribute \"noise\"",
        ),
    ] {
        let error = model(sensor).expect_err(sensor);
        assert!(error.contains(reason), "{sensor}: {error}");
        assert!(error.contains('8'), "{sensor} names no line: {error}");
    }
}

#[test]
fn the_numbers_of_a_sensor_follow_from_its_data() {
    let model = model(
        "<rangefinder site='tip'/><rangefinder camera='eye' data='dist point'/><camprojection site='tip' camera='eye'/>
         <contact/><contact subtree1='arm' num='3' data='found force torque dist'/><tactile mesh='skin' geom='fist'/>",
    )
    .expect("valid");
    let numbers: Vec<_> = model.sensors.iter().map(|s| s.numbers.clone()).collect();
    assert_eq!(numbers, [0..1, 1..25, 25..27, 27..28, 28..52, 52..70]);
    let SensorTarget::Contacts(query) = &model.sensors[4].target else {
        panic!("not of contacts")
    };
    assert_eq!(
        query.sides,
        [ContactSide::Subtree(1..3), ContactSide::Any],
        "the arm and the hand"
    );
}

#[test]
fn invalid_cameras_are_refused_with_their_line() {
    for (camera, reason) in [
        (
            "<camera mode='targetbody' target='no'/>",
            "there is no body \"no\"",
        ),
        ("<camera fovy='180'/>", "less than 180"),
        ("<camera fovy='30' sensorsize='1 1'/>", "cannot both"),
        ("<camera focal='1 1'/>", "needs a sensorsize"),
        (
            "<camera sensorsize='1 1' resolution='0 5'/>",
            "positive resolution",
        ),
        ("<camera resolution='5'/>", "2 numbers"),
        ("<camera mode='tracking'/>", "not one of fixed, track"),
        ("<camera quat='0 0 0 0'/>", "quat"),
        ("<camera name='a'/><camera name='a'/>", "already in use"),
    ] {
        let text = format!("<mujoco><worldbody>\n{camera}</worldbody></mujoco>");
        let error = load_str(&text).expect_err(camera).to_string();
        assert!(
            error.contains(reason) && error.contains('2'),
            "{camera}: {error}"
        );
    }
}

#[test]
fn a_tracking_camera_keeps_its_initial_frame() {
    let text = "<mujoco><default><camera resolution='4 2' fovy='30'/></default><worldbody>
        <body name='arm' pos='1 0 0' euler='0 0 90'><joint/><geom size='.1' pos='0 1 0'/>
        <camera name='eye' pos='1 0 0' mode='track'/><camera pos='1 0 0' mode='trackcom' target='arm'/></body>
        </worldbody></mujoco>";
    let model = load_str(text).expect("valid");
    let (eye, p) = (model.camera("eye").expect("named"), &model.params);
    let near = |v: Vec3<f64>, w: [f64; 3]| (v - Vec3::from_array(w)).norm() < 1e-12;
    assert!(near(p.cam_pos0[eye], [0.0, 1.0, 0.0]), "{:?}", p.cam_pos0);
    assert!(
        near(p.cam_poscom0[1], [1.0, 1.0, 0.0]),
        "{:?}",
        p.cam_poscom0
    );
    assert_eq!(model.cameras[eye].mode, CameraMode::Track);
    assert_eq!(model.cameras[1].resolution, [4, 2]);
    assert_eq!(p.cam_fovy, [30.0, 30.0]);
}

#[test]
fn what_a_sensor_measures_must_exist() {
    let rejected = |range: &str, sections: &str| {
        let text = format!(
            "<mujoco><worldbody><body name='b'><joint name='j' {range}/><geom size='1'/></body></worldbody>
             <tendon><fixed name='t' {range}><joint joint='j' coef='1'/></fixed></tendon>{sections}</mujoco>"
        );
        load_str(&text).err().map(|error| error.to_string())
    };
    for kind in ["pos", "vel", "frc"] {
        for (of, element) in [("joint", "j"), ("tendon", "t")] {
            let sensor = format!("<sensor><{of}limit{kind} {of}='{element}'/></sensor>");
            assert_eq!(rejected("range='-1 1'", &sensor), None);
            for range in ["", "range='-1 1' limited='false'"] {
                let error = rejected(range, &sensor).expect("an error");
                let reason = format!("the {of} \"{element}\" has no limit to be measured");
                assert!(error.contains(&reason), "{error}");
            }
        }
    }
}

#[test]
fn directions_and_orientations_of_users_have_their_numbers() {
    for dim in [0, 1, 2, 3, 4, 5] {
        for (data, wanted) in [
            ("axis", 3),
            ("quaternion", 4),
            ("real", dim),
            ("positive", dim),
        ] {
            let sensor = format!("<user dim='{dim}' datatype='{data}'/>");
            match model(&sensor) {
                Ok(_) => assert_eq!(dim, wanted, "{sensor}"),
                Err(error) => assert!(
                    dim != wanted && error.contains(&format!("{wanted} numbers")),
                    "{error}"
                ),
            }
        }
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
