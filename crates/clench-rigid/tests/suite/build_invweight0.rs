//! Quantities that the builder derives from the whole model: inverse inertias, springs, servo damping, equality data.

use clench_dynamics::constants::CONSTANTS;
use clench_dynamics::part::Part;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, ConnectAnchor, EqualityKind, EqualitySpec, GeomSpec, JointSpec,
    ModelBuilder, TendonSpec, TransmissionSpec,
};
use clench_rigid::dynamics::{com, inertia, kinematics};
use clench_rigid::model::{EqualityTarget, Model, ParamField};
use clench_rigid::workspace::Positions;
use clench_rigid::{Batch, Sim, State};
use clench_solver::TreeMatrix;
use std::sync::Arc;

const Y: [f64; 3] = [0.0, 1.0, 0.0];

fn assert_close(actual: f64, expected: f64) {
    let error = (actual - expected).abs() / expected.abs();
    assert!(error < 1e-12, "{actual} instead of {expected}");
}

/// Returns an (almost) point mass at the end of a massless rod of length 1.
fn bob(name: &str, mass: f64) -> BodySpec {
    BodySpec::new(name).inertial(mass, [0.0, 0.0, -1.0], [1e-14; 3])
}

fn positions(model: &Model) -> (Positions<f64>, Vec<f64>) {
    let mut pos = Positions::new(model);
    let parts = &[Part::whole(model)];
    let all = kinematics::Computed::all(parts);
    kinematics::kinematics(model, &model.params, &State::new(model), all, &mut pos);
    com::com_positions(model, &model.params, parts, &mut pos);
    let mut mass = TreeMatrix::zeros(&model.tree);
    inertia::composite_inertia(model, &model.params, parts, &mut pos, &mut mass);
    let dense = mass.to_dense(&model.tree);
    (pos, dense)
}

#[test]
fn a_free_body_resists_with_its_mass_and_inertia() {
    let mut builder = ModelBuilder::new("free");
    let body = BodySpec::new("b")
        .turned([0.3, 0.1, -0.5, 0.7])
        .at([1.0, 2.0, 3.0]);
    let body = body
        .inertial(4.0, [0.0; 3], [0.5, 0.25, 0.4])
        .joint(JointSpec::free("f"));
    builder.add_body(ModelBuilder::WORLD, body);
    let p = builder.build().unwrap().params;
    let rotation = (1.0 / 0.5 + 1.0 / 0.25 + 1.0 / 0.4) / 3.0;
    assert_close(p.body_invweight0[1][0], 0.25);
    assert_close(p.body_invweight0[1][1], rotation);
    for dof in 0..3 {
        assert_close(p.dof_invweight0[dof], 0.25);
        assert_close(p.dof_invweight0[dof + 3], rotation);
    }
    assert_eq!(p.body_invweight0[0], [0.0; 2]);
}

#[test]
fn a_double_pendulum_resists_with_the_inverse_of_its_mass_matrix() {
    let (m1, m2, armature) = (2.0, 3.0, 0.5);
    let mut builder = ModelBuilder::new("double pendulum");
    let upper = builder.add_body(
        ModelBuilder::WORLD,
        bob("upper", m1).joint(JointSpec::hinge("shoulder", Y).armature(armature)),
    );
    let lower = bob("lower", m2)
        .at([0.0, 0.0, -1.0])
        .joint(JointSpec::hinge("elbow", Y));
    builder.add_body(upper, lower);
    builder.tendons.push(TendonSpec::fixed(
        "both",
        &[("shoulder", 2.0), ("elbow", -1.0)],
    ));
    let model = builder.build().unwrap();
    let p = &model.params;

    // Hanging straight, in relative angles: M = [m1 + 4 m2 + armature, 2 m2; 2 m2, m2].
    let (a, b, c) = (m1 + 4.0 * m2 + armature, 2.0 * m2, m2);
    let det = a * c - b * b;
    assert_close(p.dof_invweight0[0], c / det);
    assert_close(p.dof_invweight0[1], a / det);
    assert_close(p.tendon_invweight0[0], (4.0 * c + 4.0 * b + a) / det);
    // The lower bob moves along x by −2 and −1 per radian; the weight is a third of J M⁻¹ Jᵀ.
    assert_close(p.body_invweight0[2][0], (4.0 * c - 4.0 * b + a) / det / 3.0);
    assert_eq!(p.body_subtreemass, [5.0, 5.0, 3.0]);
}

#[test]
fn a_lone_slider_resists_with_its_mass_in_every_direction() {
    let mut builder = ModelBuilder::new("sliders");
    let slider = |axis| JointSpec::slide("", axis).armature(3.0);
    let ball = || BodySpec::new("").geom(GeomSpec::sphere(0.1).mass(2.0));
    builder.add_body(ModelBuilder::WORLD, ball().joint(slider(Y)));
    builder.add_body(ModelBuilder::WORLD, ball().joint(slider([0.0, 1.0, 1.0])));
    let p = builder.build().unwrap().params;
    // MuJoCo's rule for slides along a coordinate axis, and the general rule for others.
    assert_eq!(
        (p.body_invweight0[1], p.dof_invweight0[0]),
        ([0.5, 0.0], 0.5)
    );
    assert_close(p.body_invweight0[2][0], 1.0 / 5.0 / 3.0);
    assert_close(p.dof_invweight0[1], 1.0 / 5.0);
}

#[test]
fn springs_and_servos_have_the_requested_damping_ratio() {
    let mut builder = ModelBuilder::new("oscillators");
    let hinge = |name| JointSpec::hinge(name, Y);
    let sprung = JointSpec {
        springdamper: [0.1, 0.7],
        ..hinge("sprung")
    };
    builder.add_body(ModelBuilder::WORLD, bob("a", 2.0).joint(sprung));
    builder.add_body(ModelBuilder::WORLD, bob("b", 5.0).joint(hinge("driven")));
    let servo =
        ActuatorSpec::position("servo", TransmissionSpec::Joint("driven".into()), 80.0, 0.0);
    builder.actuators.push(ActuatorSpec {
        dampratio: Some(0.4),
        gear: [3.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ..servo
    });
    let p = builder.build().unwrap().params;

    // m ẍ + b ẋ + k x = 0 decays with time constant 2m/b and has damping ratio b / (2 √(k m)).
    let (k, b, m) = (p.jnt_stiffness[0], p.dof_damping[0], 2.0 + 1e-14);
    assert_close(2.0 * m / b, 0.1);
    assert_close(b / (2.0 * (k * m).sqrt()), 0.7);
    // With a gear of 3, nine times kp and kv act on the joint.
    let (kp, kv) = (80.0 * 9.0, -p.actuator_biasprm[0][2] * 9.0);
    assert_close(kv / (2.0 * (kp * 5.0_f64).sqrt()), 0.4);
}

#[test]
fn equalities_hold_in_the_initial_configuration() {
    let mut builder = ModelBuilder::new("equalities");
    let turned = |name: &str, pos, quat| {
        BodySpec::new(name)
            .at(pos)
            .turned(quat)
            .geom(GeomSpec::sphere(0.1))
    };
    let a = turned("a", [1.0, 2.0, 3.0], [0.3, 0.1, -0.5, 0.7]).joint(JointSpec::free("f"));
    let b = turned("b", [0.5, 0.0, 0.2], [0.1, 0.9, 0.2, 0.1]).joint(JointSpec::hinge("h", Y));
    let c = turned("c", [-1.0, 0.0, 0.0], [0.9, 0.1, 0.2, -0.1]).joint(JointSpec::ball("ball"));
    let a = builder.add_body(ModelBuilder::WORLD, a);
    builder.add_body(a, b);
    builder.add_body(ModelBuilder::WORLD, c);
    let anchor = |body1: &str, body2: &str| ConnectAnchor::Bodies {
        body1: body1.into(),
        body2: body2.into(),
        anchor: Vec3::new(0.1, -0.2, 0.4),
    };
    let weld = |anchor| EqualityKind::Weld {
        anchor,
        relpose: None,
        torquescale: 1.0,
    };
    for kind in [
        EqualityKind::Connect(anchor("b", "c")),
        EqualityKind::Connect(anchor("a", "")),
        weld(anchor("c", "b")),
        weld(anchor("a", "")),
    ] {
        builder.equalities.push(EqualitySpec::new("", kind));
    }
    let model = builder.build().unwrap();
    let (pos, _) = positions(&model);
    for (i, equality) in model.equalities.iter().enumerate() {
        let (EqualityTarget::Connect { body1, body2 } | EqualityTarget::Weld { body1, body2 }) =
            equality.target
        else {
            panic!("only connects and welds were described");
        };
        let p = &model.params;
        let first = pos.xpos[body1] + pos.xmat[body1] * p.eq_anchor1[i];
        let second = pos.xpos[body2] + pos.xmat[body2] * p.eq_anchor2[i];
        assert!((first - second).norm() < 1e-14);
        if matches!(equality.target, EqualityTarget::Weld { .. }) {
            let (first, second) = (
                pos.xquat[body1] * p.eq_quat1[i],
                pos.xquat[body2] * p.eq_quat2[i],
            );
            assert!(first.difference(second).norm() < 1e-14);
        }
    }
}

#[test]
fn an_aligned_free_body_is_the_same_body_with_a_diagonal_mass_matrix() {
    let described = |align| {
        let mut builder = ModelBuilder::new("align");
        let body = BodySpec::new("b")
            .at([1.0, 2.0, 3.0])
            .turned([0.3, 0.1, -0.5, 0.7]);
        let block = GeomSpec::cuboid([0.1, 0.2, 0.3])
            .at([0.3, 0.0, 0.1])
            .turned([0.8, 0.1, 0.2, 0.3]);
        let body = body
            .geom(block)
            .geom(GeomSpec::sphere(0.1))
            .site("s", [1.0, 1.0, 1.0]);
        builder.add_body(ModelBuilder::WORLD, body.joint(JointSpec::free("f")));
        builder.compiler.alignfree = align;
        builder.build().unwrap()
    };
    let (plain, aligned) = (described(false), described(true));
    let ((old, _), (new, mass)) = (positions(&plain), positions(&aligned));
    let near = |a: Vec3<f64>, b: Vec3<f64>| (a - b).norm() < 1e-13;
    assert!(near(old.site_xpos[0], new.site_xpos[0]));
    assert!(near(old.xipos[1], new.xipos[1]));
    for g in 0..2 {
        assert!(near(old.geom_xpos[g], new.geom_xpos[g]));
        let turn =
            Quat::from_matrix(&old.geom_xmat[g]).difference(Quat::from_matrix(&new.geom_xmat[g]));
        assert!(turn.norm() < 1e-13);
    }
    for (i, row) in mass.chunks(6).enumerate() {
        let off: f64 = row
            .iter()
            .enumerate()
            .filter(|&(j, _)| j != i)
            .map(|(_, v)| v.abs())
            .sum();
        assert!(off < 1e-12 * row[i], "row {i}: {row:?}");
    }
}

#[test]
fn constants_of_changed_numbers_are_those_of_a_model_built_with_them() {
    let arm = |mass: f64, armature: f64| {
        let mut builder = ModelBuilder::new("arm");
        let shoulder = JointSpec::hinge("shoulder", Y).armature(armature);
        let upper = bob("upper", mass).joint(shoulder);
        let upper = builder.add_body(ModelBuilder::WORLD, upper);
        let elbow = JointSpec::hinge("elbow", Y);
        builder.add_body(upper, bob("lower", 1.0).at([0.0, 0.0, -1.0]).joint(elbow));
        builder
            .tendons
            .push(TendonSpec::fixed("string", &[("elbow", 2.0)]));
        Arc::new(builder.build().unwrap())
    };
    let (light, heavy) = (arm(1.0, 0.1), arm(3.0, 0.4));
    let mut sim = Sim::<f64>::new(light.clone()).unwrap();
    let mut batch = Batch::<f64>::new(light.clone(), 3).unwrap();
    for field in ["body_mass", "dof_armature"] {
        let field = ParamField::find(field).unwrap();
        let row = heavy.params.read_lane(field, 0);
        sim.set_param(field.name(), &row).unwrap();
        batch.randomize(field.name(), &[1], &row).unwrap();
    }
    sim.set_constants().unwrap();
    batch.set_constants(&[1]).unwrap();
    for field in CONSTANTS {
        let name = field.name();
        let [before, expected] = [&light, &heavy].map(|model| model.params.read_lane(field, 0));
        assert_eq!(sim.param(name).unwrap(), expected, "{name}");
        assert_eq!(batch.param(name, 1).unwrap(), expected, "{name}");
        assert_eq!(batch.param(name, 2).unwrap(), before, "{name}");
    }
    assert!(batch.set_constants(&[3]).is_err());
}

#[test]
fn constants_of_moved_bodies_hold_them_where_they_are() {
    let anchored = |body2: &str| ConnectAnchor::Bodies {
        body1: "arm".into(),
        body2: body2.into(),
        anchor: Vec3::new(0.1, 0.2, 0.3),
    };
    let weld = |relpose| EqualityKind::Weld {
        anchor: anchored("hand"),
        relpose,
        torquescale: 1.0,
    };
    let placed = |x: f64, turn: [f64; 4]| {
        let mut builder = ModelBuilder::new("anchored");
        let arm = bob("arm", 1.0).at([x, 0.0, 1.0]).turned(turn);
        builder.add_body(ModelBuilder::WORLD, arm.joint(JointSpec::hinge("h", Y)));
        let mut hand = BodySpec::new("hand").at([0.0, x, 2.0]);
        hand.mocap = true;
        builder.add_body(ModelBuilder::WORLD, hand);
        for kind in [
            weld(None),
            weld(Some((Vec3::new(1.0, 2.0, 3.0), Quat::IDENTITY))),
            EqualityKind::Connect(anchored("hand")),
        ] {
            builder.equalities.push(EqualitySpec::new("", kind));
        }
        Arc::new(builder.build().expect("valid"))
    };
    let model = placed(0.5, [1.0, 0.0, 0.0, 0.0]);
    let moved = placed(0.8, [0.8, 0.0, 0.6, 0.0]);
    let mut sim = Sim::<f64>::new(model).expect("a simulation");
    for field in ["body_pos", "body_quat"] {
        let row = moved
            .params
            .read_lane(ParamField::find(field).expect("a field"), 0);
        sim.set_param(field, &row).expect("valid");
    }
    sim.set_constants().expect("positive");
    for field in CONSTANTS {
        let (actual, expected) = (
            sim.param(field.name()).expect("a field"),
            moved.params.read_lane(field, 0),
        );
        assert_eq!(actual, expected, "{}", field.name());
    }
}
