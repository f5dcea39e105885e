//! Numbering, completion and validation of models by the builder.

use clench_dynamics::model::RowPattern;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, ConnectAnchor, EqualityKind, EqualitySpec, ExcludeSpec, GeomSpec,
    JointSpec, KeyframeSpec, ModelBuilder, Origin, PairSpec, TendonSpec, TransmissionSpec,
    WrapSpec,
};

const X: [f64; 3] = [1.0, 0.0, 0.0];

fn ball(name: &str) -> BodySpec {
    BodySpec::new(name).geom(GeomSpec::sphere(0.1).named(format!("{name} geom")))
}

fn hinged(name: &str) -> BodySpec {
    ball(name).joint(JointSpec::hinge(format!("{name} joint"), X))
}

#[test]
fn bodies_are_depth_first_and_have_their_moving_joints() {
    let mut builder = ModelBuilder::new("tree");
    let a = builder.add_body(ModelBuilder::WORLD, hinged("a"));
    let b = builder.add_body(ModelBuilder::WORLD, ball("b"));
    let a1 = builder.add_body(a, ball("a1"));
    builder.add_body(b, ball("b1").joint(JointSpec::ball("b1 joint")));
    builder.add_body(a, hinged("a2"));
    builder.add_body(a1, hinged("a11"));
    let mocap = BodySpec {
        mocap: true,
        ..ball("m")
    };
    let m = builder.add_body(ModelBuilder::WORLD, mocap);
    builder.add_body(m, ball("m1"));
    let model = builder.build().unwrap();

    let names: Vec<&str> = model.bodies.iter().map(|b| &b.name[..]).collect();
    assert_eq!(
        names,
        ["world", "a", "a1", "a11", "a2", "b", "b1", "m", "m1"]
    );
    let of = |f: &dyn Fn(&clench_rigid::model::Body) -> usize| {
        model.bodies.iter().map(f).collect::<Vec<_>>()
    };
    assert_eq!(of(&|b| b.parent), [0, 0, 1, 2, 1, 0, 5, 0, 7]);
    assert_eq!(of(&|b| b.root), [0, 1, 1, 1, 1, 5, 5, 7, 7]);
    assert_eq!(of(&|b| b.weld), [0, 1, 1, 3, 4, 0, 6, 7, 7]);
    let last: Vec<_> = model.bodies.iter().map(|b| b.last_dof).collect();
    assert_eq!(
        last,
        [
            None,
            Some(0),
            Some(0),
            Some(1),
            Some(2),
            None,
            Some(5),
            None,
            None
        ]
    );
    let parents: Vec<_> = (0..model.nv).map(|d| model.tree.parent(d)).collect();
    assert_eq!(parents, [None, Some(0), Some(0), None, Some(3), Some(4)]);
    assert_eq!((model.nq, model.nv, model.nmocap), (3 + 4, 6, 1));
    assert_eq!(model.body("a11"), Some(3));
    assert_eq!(model.joint("b1 joint"), Some(3));
    assert_eq!(model.geom("m1 geom"), Some(7));
    assert_eq!((model.body("nobody"), model.site("")), (None, None));
}

#[test]
fn an_empty_world_is_a_model() {
    let model = ModelBuilder::new("empty").build().unwrap();
    assert_eq!((model.nbody(), model.nq, model.nv), (1, 0, 0));
    assert_eq!(model.body("world"), Some(0));
}

#[test]
fn ranges_limit_if_limited_or_autolimits_is_set() {
    let mut builder = ModelBuilder::new("limits");
    let range = |limited| JointSpec {
        range: [-1.0, 2.0],
        limited,
        ..JointSpec::slide("", X)
    };
    let body = ball("a")
        .joint(range(None))
        .joint(JointSpec {
            axis: Vec3::new(0.0, 1.0, 0.0),
            ..range(Some(false))
        })
        .joint(JointSpec::hinge("plain", X));
    builder.add_body(ModelBuilder::WORLD, body);
    let limited = |b: &ModelBuilder| {
        b.build()
            .map(|m| m.joints.iter().map(|j| j.limited).collect::<Vec<_>>())
    };
    assert_eq!(limited(&builder).unwrap(), [true, false, false]);
    builder.compiler.autolimits = false;
    assert!(
        limited(&builder)
            .unwrap_err()
            .message
            .contains("autolimits is off")
    );
    builder.bodies[1].joints[0].limited = Some(true);
    assert_eq!(limited(&builder).unwrap(), [true, false, false]);
}

#[test]
fn a_servo_inherits_a_share_of_its_joints_range() {
    let mut builder = ModelBuilder::new("inherit");
    let joint = JointSpec::hinge("j", X).limited(-1.0, 3.0);
    builder.add_body(ModelBuilder::WORLD, ball("a").joint(joint));
    let servo = ActuatorSpec::position("s", TransmissionSpec::Joint("j".into()), 10.0, 1.0);
    builder.actuators.push(ActuatorSpec {
        inheritrange: 0.5,
        ..servo
    });
    let model = builder.build().unwrap();
    assert_eq!(model.params.actuator_ctrlrange[0], [0.0, 2.0]);
    assert!(model.actuators[0].ctrllimited[0]);
}

#[test]
fn pairs_mix_parameters_that_are_not_set() {
    let mut builder = ModelBuilder::new("pairs");
    let rough = GeomSpec {
        condim: 4,
        friction: [0.5, 0.1, 0.2],
        solmix: 3.0,
        solref: [0.04, 2.0],
        margin: 0.1,
        ..GeomSpec::cuboid([0.1; 3]).named("rough")
    };
    let free = |name: &str, geom| BodySpec::new(name).joint(JointSpec::free("")).geom(geom);
    builder.add_body(ModelBuilder::WORLD, free("a", rough));
    builder.add_body(
        ModelBuilder::WORLD,
        free("b", GeomSpec::sphere(0.1).named("plain")),
    );
    let pair = |condim| PairSpec {
        geom1: "plain".into(),
        geom2: "rough".into(),
        condim,
        ..PairSpec::default()
    };
    builder.pairs = vec![pair(None), pair(Some(1))];
    let model = builder.build().unwrap();
    let p = &model.params;
    // The geom of the earlier body comes first, in any order of the pair.
    assert_eq!(model.pairs[0].geoms, [0, 1]);
    assert_eq!((model.pairs[0].condim, model.pairs[1].condim), (4, 1));
    assert_eq!(p.pair_friction[0], [1.0, 1.0, 0.1, 0.2, 0.2]);
    assert_eq!(
        p.pair_solref[0],
        [0.75 * 0.04 + 0.25 * 0.02, 0.75 * 2.0 + 0.25]
    );
    assert_eq!((p.pair_margin[0], p.pair_gap[0]), (0.1, 0.0));
    builder.bodies[2].geoms[0].priority = 1;
    let model = builder.build().unwrap();
    assert_eq!(model.pairs[0].condim, 3);
    assert_eq!(model.params.pair_solref[0], [0.02, 1.0]);
}

#[test]
fn keyframes_are_completed_from_the_initial_state() {
    let mut builder = ModelBuilder::new("keys");
    let reference = JointSpec {
        reference: 0.7,
        ..JointSpec::hinge("h", X)
    };
    builder.add_body(ModelBuilder::WORLD, ball("a").joint(JointSpec::ball("b")));
    builder.add_body(ModelBuilder::WORLD, ball("c").joint(reference));
    builder
        .keyframes
        .push(KeyframeSpec::at("turned", vec![0.0, 2.0, 0.0, 0.0]));
    let model = builder.build().unwrap();
    assert_eq!(model.keyframes[0].qpos, [0.0, 1.0, 0.0, 0.0, 0.7]);
    assert_eq!(model.keyframes[0].qvel, [0.0; 4]);
}

/// A change to a valid model, the element that the error must name, and a part of its message.
type Case = (fn(&mut ModelBuilder), &'static str, &'static str);

fn joint(b: &mut ModelBuilder) -> &mut JointSpec {
    &mut b.bodies[1].joints[0]
}
fn geom(b: &mut ModelBuilder) -> &mut GeomSpec {
    &mut b.bodies[1].geoms[0]
}
/// Returns a servo that pushes away from its target, so that no damping is critical.
fn backwards() -> ActuatorSpec {
    let joint = TransmissionSpec::Joint("a joint".into());
    ActuatorSpec {
        dampratio: Some(1.0),
        ..ActuatorSpec::position("servo", joint, -2.0, 0.0)
    }
}

fn motor(target: &str) -> ActuatorSpec {
    ActuatorSpec::motor("motor", TransmissionSpec::Joint(target.into()), 1.0)
}
fn connect(body1: &str, body2: &str) -> EqualitySpec {
    let (body1, body2, anchor) = (body1.into(), body2.into(), Vec3::ZERO);
    let anchor = ConnectAnchor::Bodies {
        body1,
        body2,
        anchor,
    };
    EqualitySpec::new("eq", EqualityKind::Connect(anchor))
}
fn pair(geom1: &str, geom2: &str) -> PairSpec {
    PairSpec {
        name: "pair".into(),
        geom1: geom1.into(),
        geom2: geom2.into(),
        ..PairSpec::default()
    }
}

const A: &str = "body \"a\"";
const JOINT: &str = "joint \"a joint\" of body \"a\"";
const GEOM: &str = "geom \"a geom\" of body \"a\"";

#[rustfmt::skip]
const CASES: &[Case] = &[
    (|b| b.bodies.clear(), "model", "no body"),
    (|b| b.physics.timestep = f64::NAN, "model", "timestep"),
    (|b| b.physics.timestep = 0.0, "model", "timestep"),
    (|b| b.options.impratio = Some(0.0), "model", "impratio"),
    (|b| b.bodies[2].parent = 7, "body \"b\"", "parent must come before"),
    (|b| b.bodies[2].parent = 2, "body \"b\"", "parent must come before"),
    (|b| b.bodies[2].name = "a".into(), A, "already in use"),
    (|b| b.bodies[2].name = "world".into(), "body \"world\"", "already in use"),
    (|b| b.bodies[0].parent = 7, "body \"world\"", "cannot have a parent"),
    (|b| (b.bodies[0].parent, b.compiler.fusestatic) = (7, true), "body \"world\"", "cannot have a parent"),
    (|b| b.bodies[0].joints.push(JointSpec::free("")), "body \"world\"", "cannot have joints"),
    (|b| b.bodies[1].pos.x = f64::INFINITY, A, "pos"),
    (|b| b.bodies[1].quat = Quat::new(0.0, 0.0, 0.0, 0.0), A, "quat is zero"),
    (|b| b.bodies[1].mocap = true, A, "mocap"),
    (|b| b.bodies[1].joints.push(JointSpec::free("")), A, "free joint must be the only"),
    (|b| b.bodies[2].joints = vec![JointSpec::free("")], "body \"b\"", "child of the world"),
    (|b| b.bodies[1].joints.extend([JointSpec::ball(""), JointSpec::hinge("", X)]), A, "follow a ball"),
    (|b| b.bodies[1].joints.extend(vec![JointSpec::slide("", X); 6]), A, "7 degrees of freedom"),
    (|b| b.bodies[1].geoms.clear(), A, "must have a mass"),
    (|b| geom(b).mass = clench_rigid::builder::GeomMass::Mass(0.0), A, "must have a mass"),
    (|b| geom(b).mass = clench_rigid::builder::GeomMass::Mass(-1.0), GEOM, "mass cannot be negative"),
    (|b| geom(b).size.x = 1e200, GEOM, "mass must be finite"),
    (|b| geom(b).size.x = 0.0, GEOM, "size[0]"),
    (|b| geom(b).size.x = f64::NAN, GEOM, "size"),
    (|b| geom(b).condim = 2, GEOM, "condim"),
    (|b| geom(b).friction[1] = -0.1, GEOM, "friction"),
    (|b| geom(b).solimp[2] = f64::NAN, GEOM, "solimp"),
    (|b| *geom(b) = GeomSpec::plane(), "unnamed geom of body \"a\"", "plane"),
    (|b| b.bodies[1] = b.bodies[1].clone().inertial(f64::NAN, [0.0; 3], [1.0; 3]), "inertial of body \"a\"", "mass"),
    (|b| b.bodies[1] = b.bodies[1].clone().inertial(1.0, [0.0; 3], [1.0, 1.0, 3.0]), A, "principal moments"),
    (|b| joint(b).axis = Vec3::ZERO, JOINT, "axis"),
    (|b| joint(b).armature = -1.0, JOINT, "armature"),
    (|b| joint(b).damping[1] = f64::NAN, JOINT, "damping"),
    (|b| (joint(b).range, joint(b).limited) = ([1.0, -1.0], Some(true)), JOINT, "range must be increasing"),
    (|b| joint(b).range = [f64::NAN, 1.0], JOINT, "NaN"),
    (|b| joint(b).springdamper = [0.1, -1.0], JOINT, "springdamper"),
    (|b| b.bodies[2].joints[0].name = "a joint".into(), "joint \"a joint\"", "already in use"),
    (|b| b.tendons.push(TendonSpec::fixed("t", &[])), "tendon \"t\"", "neither joints nor sites"),
    (|b| b.tendons.push(TendonSpec::fixed("t", &[("a joint", 1.0), ("a joint", 2.0)])), "tendon \"t\"", "twice"),
    (|b| string(b, vec![site("tip")]), "tendon \"t\"", "one element"),
    (|b| string(b, vec![site("tip"), site("tip")]), "tendon \"t\"", "twice in a row"),
    (|b| string(b, vec![site("tip"), site("x")]), "tendon \"t\"", "no site \"x\""),
    (|b| string(b, vec![site("tip"), around("x"), site("base")]), "tendon \"t\"", "no geom \"x\""),
    (|b| { string(b, vec![site("tip"), around("a geom"), site("base")]); *geom(b) = GeomSpec::cuboid([0.1; 3]).named("a geom") }, "tendon \"t\"", "a sphere or a cylinder"),
    (|b| string(b, vec![site("tip"), around("drum")]), "tendon \"t\"", "between two sites"),
    (|b| string(b, vec![site("tip"), around("drum"), around("drum"), site("base")]), "tendon \"t\"", "between two sites"),
    (|b| string(b, vec![site("tip"), site("base"), WrapSpec::Pulley(2.0)]), "tendon \"t\"", "starts no branch"),
    (|b| string(b, vec![WrapSpec::Pulley(2.0)]), "tendon \"t\"", "starts no branch"),
    (|b| string(b, vec![WrapSpec::Pulley(2.0), WrapSpec::Pulley(2.0), site("tip"), site("base")]), "tendon \"t\"", "starts no branch"),
    (|b| string(b, vec![site("tip"), WrapSpec::Pulley(2.0), site("tip"), site("base")]), "tendon \"t\"", "one element"),
    (|b| string(b, vec![site("tip"), site("base"), WrapSpec::Pulley(0.0), site("tip"), site("base")]), "tendon \"t\"", "divisor"),
    (|b| string(b, vec![site("tip"), WrapSpec::Joint { joint: "a joint".into(), coef: 1.0 }]), "tendon \"t\"", "not of both"),
    (|b| { string(b, vec![site("tip"), around("drum"), site("base")]); b.tendons[0].armature = 1.0 }, "tendon \"t\"", "armature"),
    (|b| pull(b, TransmissionSpec::SliderCrank { crank: "tip".into(), slider: "base".into() }), "actuator \"pull\"", "cranklength"),
    (|b| pull(b, TransmissionSpec::Site("x".into())), "actuator \"pull\"", "no site \"x\""),
    (|b| pull(b, TransmissionSpec::Body("x".into())), "actuator \"pull\"", "no body \"x\""),
    (|b| b.actuators.push(motor("knee")), "actuator \"motor\"", "no joint \"knee\""),
    (|b| b.actuators.push(motor("")), "actuator \"motor\"", "names no joint"),
    (|b| b.actuators.push(ActuatorSpec { dampratio: Some(1.0), ..motor("a joint") }), "actuator \"motor\"", "needs an affine bias"),
    (|b| b.actuators.push(backwards()), "actuator \"servo\"", "dampratio needs a gain that is not negative"),
    (|b| b.actuators.push(ActuatorSpec { actrange: [0.0, 1.0], ..motor("a joint") }), "actuator \"motor\"", "no activation"),
    (|b| b.equalities.push(connect("a", "a")), "equality constraint \"eq\"", "itself"),
    (|b| b.equalities.push(connect("a", "c")), "equality constraint \"eq\"", "no body \"c\""),
    (|b| b.pairs.push(pair("a geom", "a geom")), "contact pair \"pair\"", "itself"),
    (|b| b.pairs.push(pair("a geom", "x")), "contact pair \"pair\"", "no geom \"x\""),
    (|b| b.excludes.push(ExcludeSpec { body1: "x".into(), ..ExcludeSpec::default() }), "unnamed contact exclude", "no body \"x\""),
    (|b| b.keyframes.push(KeyframeSpec::at("k", vec![0.0; 3])), "keyframe \"k\"", "qpos has 3 numbers, the model has 2"),
    (|b| b.keyframes.push(KeyframeSpec::at("k", vec![f64::NAN])), "keyframe \"k\"", "qpos"),
];

/// Adds a tendon between existing sites and geoms.
fn string(b: &mut ModelBuilder, path: Vec<WrapSpec>) {
    b.bodies[2] = std::mem::take(&mut b.bodies[2]).site("tip", [0.0; 3]);
    b.bodies[0] = std::mem::take(&mut b.bodies[0]).site("base", [0.0, 1.0, 0.0]);
    b.add_ground(GeomSpec {
        name: "drum".into(),
        ..GeomSpec::cylinder(0.1, 0.1)
    });
    b.tendons.push(TendonSpec::spatial("t", path));
}

fn site(name: &str) -> WrapSpec {
    WrapSpec::Site(name.into())
}

fn around(geom: &str) -> WrapSpec {
    WrapSpec::Geom {
        geom: geom.into(),
        side: None,
    }
}

/// Adds an actuator and the sites that it may name.
fn pull(b: &mut ModelBuilder, target: TransmissionSpec) {
    string(b, vec![site("tip"), site("base")]);
    b.actuators.push(ActuatorSpec::motor("pull", target, 1.0));
}

#[test]
fn invalid_elements_are_refused_by_name() {
    let mut sound = ModelBuilder::new("sound");
    let a = sound.add_body(ModelBuilder::WORLD, hinged("a"));
    sound.add_body(a, hinged("b"));
    sound.build().unwrap();
    for (index, (spoil, element, message)) in CASES.iter().enumerate() {
        let mut builder = sound.clone();
        spoil(&mut builder);
        let error = match builder.build() {
            Ok(_) => panic!("case {index} ({element}: {message}) was accepted"),
            Err(error) => error,
        };
        assert_eq!(&error.element, element, "case {index}: {error}");
        assert!(error.message.contains(message), "case {index}: {error}");
    }
}

#[test]
fn an_error_has_the_location_of_the_element() {
    let mut builder = ModelBuilder::new("origin");
    let origin = Some(Origin {
        file: "robot.xml".into(),
        line: 12,
    });
    let joint = JointSpec {
        origin,
        axis: Vec3::ZERO,
        ..JointSpec::hinge("knee", X)
    };
    builder.add_body(ModelBuilder::WORLD, ball("shin").joint(joint));
    let error = builder.build().unwrap_err();
    assert_eq!(
        error.to_string(),
        "robot.xml:12: joint \"knee\" of body \"shin\": axis is zero"
    );
}

/// Two hinges about the same axis have indistinguishable motions.
#[test]
fn a_mass_matrix_without_inverse_is_refused() {
    let mut builder = ModelBuilder::new("singular");
    let point = |name: &str, mass| BodySpec::new(name).inertial(mass, [0.0; 3], [1e-15; 3]);
    let hinge = |name: &str| JointSpec::hinge(name, X);
    builder.add_body(
        ModelBuilder::WORLD,
        point("a", 1.0).joint(hinge("1")).joint(hinge("2")),
    );
    let error = builder.build().unwrap_err();
    assert!(error.message.contains("mass matrix"), "{error}");
}

#[test]
fn rows_are_ascending_and_name_each_dof_once() {
    let mut pattern = RowPattern::default();
    pattern.push([5, 2, 5, 0]);
    pattern.push([]);
    pattern.push([5]);
    assert_eq!(pattern.dofs(0), [0, 2, 5]);
    assert_eq!(pattern.dofs(1), [0; 0]);
    assert_eq!(pattern.range(2), 3..4);
    let row: Vec<_> = pattern.row(&[1.0, 2.0, 3.0, 4.0], 0).collect();
    assert_eq!(row, [(0, 1.0), (2, 2.0), (5, 3.0)]);
}
