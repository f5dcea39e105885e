//! A simulation accepts valid input, refuses invalid input, and reports when it cannot go on.

use crate::scenes::{add, free, joint, model, plane, run, sim, sphere, world};
use clench_collide::frame_from_normal;
use clench_math::{Mat3, Quat, Vec3};
use clench_rigid::builder::{
    DEFAULT_SOLIMP, DEFAULT_SOLREF, GeomSpec, HeightFieldSpec, KeyframeSpec, ModelBuilder,
};
use clench_rigid::contact::Contact;
use clench_rigid::model::JointKind;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Fault, Sim, SimError, readout};
use clench_solver::Switch;

fn ball() -> ModelBuilder {
    let mut b = world();
    b.bodies[0].geoms.push(plane());
    add(
        &mut b,
        0,
        "ball",
        [0.0, 0.0, 0.5],
        free(),
        vec![sphere(0.1)],
    );
    b
}

#[test]
fn wrong_lengths_and_numbers_are_errors_with_their_index() {
    let mut sim = sim(&ball());
    sim.state.qpos.pop();
    let wrong = SimError::WrongLength {
        field: "qpos",
        found: 6,
        expected: 7,
    };
    assert_eq!(sim.step(), Err(wrong));
    sim.reset();
    sim.state.qvel[4] = f64::NAN;
    let error = sim.forward().expect_err("not a number");
    assert_eq!(error.to_string(), "qvel[4] is NaN");
    sim.reset();
    sim.state.xfrc_applied[1].linear.y = f64::INFINITY;
    assert_eq!(
        sim.step().expect_err("infinite").to_string(),
        "xfrc_applied[7] is inf"
    );
    sim.reset();
    sim.state.eq_active.push(true);
    assert!(matches!(
        sim.step(),
        Err(SimError::WrongLength {
            field: "eq_active",
            ..
        })
    ));
    sim.reset();
    assert!(sim.set_ctrl(&[0.0]).is_err());
    assert!(sim.set_configuration(&[0.0; 7], &[0.0; 5]).is_err());
    assert!(sim.set_timestep(0.0).is_err());
    assert!(sim.reset_to_keyframe(0).is_err());
    sim.step().expect("all is well again");
}

#[test]
fn options_out_of_range_are_errors() {
    for options in [
        RigidOptions::new().tolerance(f64::NAN),
        RigidOptions::new().tolerance(-1.0),
        RigidOptions::new().impratio(0.0),
        RigidOptions::new().constraint_timeconst(f64::INFINITY),
    ] {
        assert!(matches!(
            Sim::<f64>::with_options(model(&ball()), options),
            Err(SimError::Option(_))
        ));
    }
}

#[test]
fn the_user_wins_over_the_file_and_the_file_over_the_defaults() {
    let settings = |edit: fn(&mut ModelBuilder), user: RigidOptions| {
        let mut builder = ball();
        builder.options = RigidOptions::new().iterations(7);
        edit(&mut builder);
        *Sim::<f64>::with_options(model(&builder), user)
            .expect("valid")
            .settings()
    };
    let plain = settings(|_| {}, RigidOptions::new().impratio(2.0));
    assert_eq!((plain.solver.iterations, plain.impratio), (7, 2.0));
    assert_eq!(
        (plain.solver.ls_iterations, plain.constraint_timeconst),
        (50, 0.01)
    );
    let off: fn(&mut ModelBuilder) = |b| {
        let flags = &mut b.physics.flags;
        (flags.constraint, flags.limit, flags.warmstart, flags.island) =
            (false, false, false, false);
    };
    let file = settings(off, RigidOptions::new());
    assert!(!file.flags.constraint && !file.enable_joint_limit && !file.solver.warmstart);
    assert_eq!(file.solver.islands, Switch::Off);
    let insistent = RigidOptions::new()
        .disable_constraint(false)
        .enable_joint_limit(true)
        .warmstart(true)
        .islands(Switch::On);
    let user = settings(off, insistent);
    assert!(user.flags.constraint && user.enable_joint_limit && user.solver.warmstart);
    assert_eq!(user.solver.islands, Switch::On);
    assert!(!user.flags.limit, "limits of tendons stay off");
}

#[test]
fn shapes_that_cannot_be_collided_are_refused_before_the_first_step() {
    let mut b = world();
    b.bodies[0].geoms.push(plane());
    b.height_fields.push(HeightFieldSpec {
        name: "hills".into(),
        rows: 2,
        columns: 2,
        heights: vec![0.0, 1.0, 2.0, 0.0],
        size: [1.0, 1.0, 0.2, 0.1],
        origin: None,
    });
    let tray = GeomSpec::height_field("hills").named("tray");
    add(&mut b, 0, "a", [0.0, 0.0, 1.0], free(), vec![tray]);
    let refused = Sim::<f64>::new(model(&b));
    let Err(error @ SimError::UnsupportedPair(_)) = refused else {
        panic!("terrain that falls on a plane");
    };
    let text = error.to_string();
    assert!(
        text.contains("\"tray\"") && text.contains("plane against heightfield"),
        "{text}"
    );
    let without = RigidOptions::new().disable_constraint(true);
    assert!(
        Sim::<f64>::with_options(model(&b), without).is_ok(),
        "nothing can touch"
    );
}

#[test]
fn divergence_is_reported_and_the_state_stays_good() {
    let mut b = world();
    let mut spring = joint(JointKind::Slide, "spring", [1.0, 0.0, 0.0]);
    spring.stiffness[0] = 1e9;
    add(&mut b, 0, "mass", [0.0; 3], vec![spring], vec![sphere(0.1)]);
    let mut sim = sim(&b);
    sim.state.qpos[0] = 1.0;
    let error = loop {
        let before = (sim.state.time, sim.state.qpos[0], sim.state.qvel[0]);
        if let Err(error) = sim.step() {
            assert_eq!(
                before,
                (sim.state.time, sim.state.qpos[0], sim.state.qvel[0])
            );
            break error;
        }
    };
    let SimError::Fault(Fault::Diverged { time, index: 0, .. }) = error else {
        panic!("{error}");
    };
    assert_eq!(time, sim.state.time);
    assert!(sim.state.qpos[0].is_finite());
    sim.reset();
    sim.step().expect("starts anew");
}

#[test]
fn reset_and_keyframes_restore_states() {
    let mut b = ball();
    b.keyframes.push(KeyframeSpec {
        name: "thrown".into(),
        time: 2.0,
        qvel: Some(vec![1.0, 0.0, 3.0, 0.0, 0.0, 0.0]),
        ..KeyframeSpec::default()
    });
    let mut sim = sim(&b);
    let initial = sim.state.qpos.clone();
    run(&mut sim, 0.5);
    assert_ne!(sim.state.qpos, initial);
    sim.reset_to_keyframe(0).expect("it exists");
    assert_eq!((sim.state.time, sim.state.qvel[2]), (2.0, 3.0));
    assert_eq!(
        (&sim.state.qpos, sim.state.qacc_warmstart[2]),
        (&initial, 0.0)
    );
    sim.reset();
    assert_eq!((sim.state.time, sim.state.qvel[2]), (0.0, 0.0));
}

#[test]
fn a_replay_is_the_same_to_the_bit() {
    let mut sim = sim(&ball());
    let trace = |sim: &mut Sim| {
        run(sim, 1.0);
        sim.state
            .qpos
            .iter()
            .map(|x| x.to_bits())
            .collect::<Vec<_>>()
    };
    sim.state.qvel[3] = 2.0;
    let first = trace(&mut sim);
    sim.reset();
    sim.state.qvel[3] = 2.0;
    assert_eq!(trace(&mut sim), first);
}

/// Returns a contact of the ball with the floor that pushes it up, in the given frame.
fn contact_in(frame: Mat3<f64>) -> Contact<f64> {
    Contact {
        geoms: [0, 1],
        active: true,
        dim: 6,
        dist: -0.01,
        pos: Vec3::new(0.0, 0.0, 0.4),
        frame,
        includemargin: 0.0,
        friction: [1.0; 5],
        solref: DEFAULT_SOLREF,
        solreffriction: [0.0; 2],
        solimp: DEFAULT_SOLIMP,
        adhesion: 0.0,
        surfacevel: [0.0; 3],
        block: None,
    }
}

#[test]
fn given_contacts_replace_detection_once() {
    let mut sim = sim(&ball());
    let contact = Contact {
        dim: 1,
        ..contact_in(frame_from_normal(Vec3::new(0.0, 0.0, 1.0)))
    };
    sim.forward_with_contacts(&[contact]).expect("valid");
    let force = readout::contact_force(sim.workspace(), 0, 0);
    assert!(force[0] > 9.81, "it pushes the ball up: {force:?}");
    let far = Contact {
        dist: 0.01,
        ..contact
    };
    sim.forward_with_contacts(&[far]).expect("valid");
    assert_eq!(readout::contact_force(sim.workspace(), 0, 0), [0.0; 6]);
    for wrong in [
        Contact {
            geoms: [0, 7],
            ..contact
        },
        Contact { dim: 2, ..contact },
        Contact {
            dist: f64::NAN,
            ..contact
        },
        Contact {
            dim: 3,
            friction: [0.0; 5],
            ..contact
        },
    ] {
        let refused = sim.forward_with_contacts(&[contact, wrong]);
        assert!(matches!(refused, Err(SimError::Contact { index: 1, .. })));
    }
    sim.forward().expect("valid");
    assert!(sim.contacts().is_empty(), "the ball is in the air");
    let before = sim.state.clone();
    sim.step_with_contacts(&[contact]).expect("valid");
    assert!(sim.state.qvel[2] > 0.0, "the contact throws the ball up");
    sim.state = before;
    sim.step().expect("valid");
    assert!(sim.state.qvel[2] < 0.0, "without it the ball falls");
}

#[test]
fn a_provided_contact_has_a_right_handed_orthonormal_frame_and_two_geoms() {
    let mut sim = sim(&ball());
    let upright = frame_from_normal(Vec3::new(0.6, 0.0, 0.8));
    let [n, t, b] = upright.rows;
    let slanted = (t + n * 0.01).normalize().0;
    let refused = [
        (
            "orthonormal",
            Mat3::from_rows(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO),
        ),
        ("orthonormal", Mat3::from_rows(n, Vec3::ZERO, Vec3::ZERO)),
        ("orthonormal", Mat3::from_rows(n * 1.001, t, b)),
        ("orthonormal", Mat3::from_rows(n, slanted, b)),
        ("orthonormal", Mat3::from_rows(n, t, t)),
        ("right-handed", Mat3::from_rows(n, t, -b)),
        ("right-handed", Mat3::from_rows(n, b, t)),
    ];
    for (reason, frame) in refused {
        let error = sim.forward_with_contacts(&[contact_in(upright), contact_in(frame)]);
        let error = error.expect_err("no frame").to_string();
        assert!(
            error.starts_with("provided contact 1: ") && error.contains(reason),
            "{error}"
        );
    }
    let same = Contact {
        geoms: [1, 1],
        ..contact_in(upright)
    };
    let error = sim.forward_with_contacts(&[same]).expect_err("one geom");
    assert_eq!(
        error.to_string(),
        "provided contact 0: both of its geoms are the same"
    );
}

#[test]
fn a_given_frame_may_be_rounded_to_single_precision() {
    let mut sim = sim(&ball());
    for k in 0..1000 {
        let turn = Quat::from_rotation_vector(Vec3::new(1.0, 0.3, -0.7) * f64::from(k) * 0.1);
        let single = |v: Vec3<f64>| Vec3::from_array(v.to_array().map(|x| f64::from(x as f32)));
        let frame = Mat3 {
            rows: turn.to_matrix().rows.map(single),
        };
        let taken = sim.forward_with_contacts(&[contact_in(frame)]);
        assert!(taken.is_ok(), "{taken:?}");
    }
}

#[test]
fn energy_is_that_of_the_state() {
    let mut sim = sim(&ball());
    sim.state.qvel[2] = 2.0;
    let energy = sim.energy().expect("finite");
    assert!((energy.kinetic - 2.0).abs() < 1e-15, "{energy:?}");
    assert!((energy.potential - 9.81 * 0.5).abs() < 1e-14);
    let start = energy.kinetic + energy.potential;
    run(&mut sim, 0.2);
    let end = sim.energy().expect("finite");
    assert!(
        (end.kinetic + end.potential - start).abs() < 0.02,
        "semi-implicit Euler in free fall"
    );
}

#[test]
fn reading_energy_preserves_the_results_of_the_last_step() {
    let mut sim = sim(&ball());
    sim.state.qvel[2] = 2.0;
    run(&mut sim, 0.1);
    let before = sim.output("xpos").expect("known");
    let energy = sim.output("energy").expect("known");
    assert_eq!(sim.output("xpos").expect("known"), before);
    assert_ne!(before[5], sim.state.qpos[2], "of the start of the step");
    let height = sim.state.qpos[2];
    assert!((energy[0] - 9.81 * height).abs() < 1e-12, "of its end");
}

#[test]
fn single_precision_comes_to_rest_as_double_does() {
    let mut builder = ball();
    builder.options = RigidOptions::new();
    let model = model(&builder);
    let mut single = Sim::<f32>::new(model.clone()).expect("valid");
    let mut double = Sim::<f64>::new(model).expect("valid");
    for _ in 0..1500 {
        single.step().expect("finite");
        double.step().expect("finite");
    }
    let (found, expected) = (f64::from(single.state.qpos[2]), double.state.qpos[2]);
    assert!(
        (found - expected).abs() < 1e-5,
        "{found} against {expected}"
    );
}

#[test]
fn a_control_sees_the_poses_of_the_step_that_it_controls() {
    let (mut pulled, mut plain) = (sim(&ball()), sim(&ball()));
    plain.state.qvel[2] = 1.0;
    pulled.state.qvel[2] = 1.0;
    for _ in 0..5 {
        let spring = -2.0 * plain.state.qpos[2];
        plain.state.qfrc_applied[2] = spring;
        plain.step().expect("valid");
        let step = pulled.step_with(|sim| {
            let height = sim.workspace().position.xipos[1].z;
            sim.state.qfrc_applied[2] = -2.0 * height;
            Ok(())
        });
        step.expect("valid");
        assert_eq!(pulled.state.qpos, plain.state.qpos);
    }
    let before = pulled.state.qpos.clone();
    let refused = pulled.step_with(|sim| sim.set_ctrl(&[0.0]));
    assert!(matches!(refused, Err(SimError::WrongLength { .. })));
    assert_eq!(pulled.state.qpos, before);
}
