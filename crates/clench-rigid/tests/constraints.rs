//! What constraints do to bodies: where things rest, what stays closed, when things slip.

mod scenes;

use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{EqualityKind, GeomSpec, JointSpec, ModelBuilder};
use clench_rigid::constraint::softness::impedance;
use clench_rigid::model::JointKind;
use clench_rigid::{Sim, readout};
use clench_solver::{FrictionCone, RigidOptions};
use scenes::{
    SOLIMP, add, bodies, cuboid, equality, free, geom, joint, plane, run, sim, sphere, world,
};

const G: f64 = 9.81;

/// A box of 1 kg and 20 cm height on a floor that is tilted by `angle` about y.
fn box_on_slope(angle: f64, friction: f64) -> ModelBuilder {
    let mut b = world();
    let turn = Quat::new((angle / 2.0).cos(), 0.0, (angle / 2.0).sin(), 0.0);
    b.bodies[0].geoms.push(GeomSpec {
        quat: turn,
        ..plane()
    });
    let up = turn.rotate(Vec3::new(0.0, 0.0, 0.1)).to_array();
    let shape = GeomSpec {
        friction: [friction, 0.0, 0.0],
        ..cuboid([0.2, 0.2, 0.1])
    };
    let body = add(&mut b, 0, "box", up, free(), vec![shape]);
    b.bodies[body].quat = turn;
    b.bodies[0].geoms[0].friction = [friction, 0.0, 0.0];
    b
}

fn with_cone(builder: &ModelBuilder, cone: FrictionCone) -> Sim {
    let options = RigidOptions::new().friction_cone(cone);
    Sim::with_options(scenes::model(builder), options).expect("valid")
}

/// The penetration at which n like contacts carry the weight of a free body of mass m, whose bodies' inverse weight is
/// 1/m: n f = m g with f = −k d r / R and R = ρ (1 − d) / (d m), where ρ is 1 for frictionless and elliptic contacts,
/// and for a pyramid's 4 edges, which together are 4/R as stiff, ρ = 2 μ² (1 + μ²).
fn rest_penetration(n: f64, rho: f64, solimp: [f64; 5], timeconst: f64) -> f64 {
    let k = 1.0 / (solimp[1] * timeconst).powi(2);
    let excess = |r: f64| {
        let d = impedance(solimp, r);
        n * k * d * d * r / (rho * (1.0 - d)) - G
    };
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn a_box_rests_at_the_penetration_that_the_formula_predicts() {
    let mu: f64 = 0.8;
    let cases = [
        (1, FrictionCone::Pyramidal, 1.0),
        (3, FrictionCone::Elliptic, 1.0),
        (
            3,
            FrictionCone::Pyramidal,
            2.0 * mu * mu * (1.0 + mu * mu) / 4.0,
        ),
    ];
    for (condim, cone, rho) in cases {
        for solimp in [SOLIMP, [0.3, 0.9, 0.02, 0.4, 3.0]] {
            let mut builder = box_on_slope(0.0, mu);
            for body in &mut builder.bodies {
                body.geoms[0].condim = condim;
                body.geoms[0].solimp = solimp;
            }
            let mut sim = with_cone(&builder, cone);
            run(&mut sim, 3.0);
            assert_eq!(sim.contacts().len(), 4);
            let predicted = rest_penetration(4.0, rho, solimp, 0.02);
            let found = 0.1 - sim.state.qpos[2];
            assert!(
                (found / predicted - 1.0).abs() < 1e-8,
                "condim {condim}, {cone:?}: {found} m instead of {predicted} m"
            );
        }
    }
}

#[test]
fn a_margin_lifts_and_a_gap_does_not() {
    let rest = |margin: f64, gap: f64| {
        let mut builder = box_on_slope(0.0, 1.0);
        builder.bodies[1].geoms[0].margin = margin;
        builder.bodies[0].geoms[0].gap = gap;
        let mut sim = sim(&builder);
        run(&mut sim, 2.0);
        sim.state.qpos[2]
    };
    let plain = rest(0.0, 0.0);
    assert!((rest(0.03, 0.0) - plain - 0.03).abs() < 1e-9);
    assert!((rest(0.0, 0.05) - plain).abs() < 1e-12);
}

#[test]
fn a_box_sticks_below_the_friction_angle_and_slides_above() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let slope: f64 = 0.5;
        let speed = |friction: f64| {
            let mut builder = box_on_slope(slope, friction);
            // So flat that it does not rock.
            let flat = &mut builder.bodies[1];
            flat.geoms[0].size.z = 0.01;
            flat.pos = flat.quat.rotate(Vec3::new(0.0, 0.0, 0.01));
            let mut sim = with_cone(&builder, cone);
            run(&mut sim, 1.0);
            sim.state.qvel[0].hypot(sim.state.qvel[2])
        };
        let creep = speed(slope.tan() * 1.05);
        // Soft friction lets some motion through.
        assert!(creep < 0.02, "{cone:?}: {creep} m/s where it should stick");
        let friction = slope.tan() * 0.8;
        let (found, expected) = (speed(friction), G * (slope.sin() - friction * slope.cos()));
        assert!(
            (found / expected - 1.0).abs() < 0.05,
            "{cone:?}: {found} m/s after 1 s instead of {expected}"
        );
    }
}

#[test]
fn contact_forces_lie_in_their_cones() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let mut builder = world();
        builder.bodies[0].geoms.push(plane());
        let friction = [0.6, 0.05, 0.02];
        let shape = |g: GeomSpec| GeomSpec {
            condim: 6,
            friction,
            ..g
        };
        builder.bodies[0].geoms[0].friction = friction;
        add(
            &mut builder,
            0,
            "a",
            [0.0, 0.0, 0.3],
            free(),
            vec![shape(cuboid([0.1, 0.15, 0.2]))],
        );
        add(
            &mut builder,
            0,
            "b",
            [0.05, 0.0, 0.7],
            free(),
            vec![shape(sphere(0.1))],
        );
        let mut sim = with_cone(&builder, cone);
        sim.state.qvel[..6].copy_from_slice(&[1.0, -0.7, -2.0, 3.0, 5.0, -4.0]);
        sim.state.qvel[6..].copy_from_slice(&[-0.5, 0.7, -2.0, 7.0, -5.0, 9.0]);
        let mut slipping = 0;
        for _ in 0..500 {
            sim.step().expect("finite");
            for (i, contact) in sim.contacts().iter().enumerate() {
                let f = readout::contact_force(sim.workspace(), i, 0);
                assert!(f[0] >= -1e-9, "contacts push: {f:?}");
                let shares: Vec<f64> = (1..6)
                    .map(|j| f[j].abs() / contact.friction[j - 1])
                    .collect();
                let used = match cone {
                    FrictionCone::Pyramidal => shares.iter().sum::<f64>(),
                    FrictionCone::Elliptic => shares.iter().map(|s| s * s).sum::<f64>().sqrt(),
                };
                assert!(used <= f[0] * (1.0 + 1e-9) + 1e-9, "{used} of {} N", f[0]);
                slipping += usize::from(f[0] > 1.0 && used > 0.99 * f[0]);
            }
        }
        assert!(
            slipping > 20,
            "{cone:?}: friction is used up at times, {slipping}"
        );
    }
}

#[test]
fn a_ball_with_rolling_friction_comes_to_rest() {
    let end_speed = |condim: u32| {
        let mut b = world();
        b.bodies[0].geoms.push(plane());
        let shape = GeomSpec {
            condim,
            friction: [1.0, 0.005, 0.01],
            ..sphere(0.1)
        };
        add(&mut b, 0, "ball", [0.0, 0.0, 0.1], free(), vec![shape]);
        let mut sim = sim(&b);
        (sim.state.qvel[0], sim.state.qvel[4]) = (1.0, 10.0);
        run(&mut sim, 3.0);
        sim.state.qvel[0]
    };
    assert!(end_speed(3) > 0.9, "nothing stops it: {}", end_speed(3));
    // Rolling decelerates by 5/7 g c / r = 0.7 m/s²: 1 m/s is gone after 1.43 s.
    assert!(
        end_speed(6).abs() < 0.01,
        "rolling friction does: {}",
        end_speed(6)
    );
}

/// A crank, a coupler and a rocker; the last joint of the loop is a connect.
fn four_bar() -> ModelBuilder {
    let mut b = world();
    let link = |half: f64| GeomSpec {
        pos: Vec3::new(half, 0.0, 0.0),
        ..scenes::ghost(geom(ShapeKind::Box, [half, 0.02, 0.02]))
    };
    let hinge = |name: &str| vec![joint(JointKind::Hinge, name, [0.0, 1.0, 0.0])];
    let crank = add(&mut b, 0, "crank", [0.0; 3], hinge("a"), vec![link(0.1)]);
    b.bodies[crank].quat = Quat::new(0.5f64.sqrt(), 0.0, -(0.5f64.sqrt()), 0.0);
    let coupler = add(
        &mut b,
        crank,
        "coupler",
        [0.2, 0.0, 0.0],
        hinge("b"),
        vec![link(0.25)],
    );
    b.bodies[coupler].quat = Quat::new(0.5f64.sqrt(), 0.0, 0.5f64.sqrt(), 0.0);
    let rocker = add(
        &mut b,
        0,
        "rocker",
        [0.5, 0.0, 0.0],
        hinge("c"),
        vec![link(0.1)],
    );
    b.bodies[rocker].quat = b.bodies[crank].quat;
    let anchor = bodies("rocker", "coupler", [0.2, 0.0, 0.0]);
    b.equalities
        .push(equality("loop", EqualityKind::Connect(anchor)));
    b
}

/// The largest violation of equality rows over some time.
fn worst_violation(sim: &mut Sim, time: f64) -> f64 {
    let end = sim.state.time + time;
    let mut worst: f64 = 0.0;
    while sim.state.time < end {
        sim.step().expect("finite");
        let rows = readout::constraint_rows(sim.workspace(), 0);
        let equalities = rows.iter().filter(|r| r.source.kind() == "equality");
        worst = equalities.map(|r| r.pos.abs()).fold(worst, f64::max);
    }
    worst
}

#[test]
fn a_four_bar_linkage_keeps_closed() {
    let play = |timeconst: f64| {
        let mut builder = four_bar();
        builder.physics.timestep = 0.001;
        builder.equalities[0].solref[0] = timeconst;
        let mut sim = sim(&builder);
        sim.state.qvel.copy_from_slice(&[3.0, -3.0, 3.0]);
        let worst = worst_violation(&mut sim, 4.0);
        let turned = sim.state.qpos[0];
        assert!(turned.abs() > 1.0, "it moves: {turned} rad");
        worst
    };
    let (soft, stiff) = (play(0.02), play(0.005));
    assert!(soft < 0.002, "{soft} m of play in links of 20 and 50 cm");
    // Stiffness goes with the inverse square of the time constant.
    assert!(stiff < soft / 10.0, "{stiff} m against {soft} m");
}

#[test]
fn a_weld_holds_and_can_be_let_go() {
    let mut b = world();
    add(
        &mut b,
        0,
        "load",
        [0.3, 0.0, 1.0],
        free(),
        vec![cuboid([0.1, 0.1, 0.1])],
    );
    // The anchor is in the second body's frame, here the world: the load's centre.
    let anchor = bodies("load", "", [0.3, 0.0, 1.0]);
    let kind = EqualityKind::Weld {
        anchor,
        relpose: None,
        torquescale: 1.0,
    };
    b.equalities.push(equality("grip", kind));
    let mut sim = sim(&b);
    run(&mut sim, 1.0);
    let held = sim.state.qpos[2];
    // It hangs where −k d² r / (1 − d) = −g, and carries its weight.
    let sag = rest_penetration(1.0, 1.0, SOLIMP, 0.02);
    assert!(
        (1.0 - held - sag).abs() < 1e-9,
        "sag of {} m instead of {sag} m",
        1.0 - held
    );
    assert!((sim.workspace().qfrc_constraint[2] - G).abs() < 1e-9);
    sim.set_equality_active(0, false).expect("it exists");
    run(&mut sim, 0.2);
    assert!(readout::constraint_rows(sim.workspace(), 0).is_empty());
    assert!((sim.state.qvel[2] + 0.2 * G).abs() < 1e-9, "free fall");
    sim.set_equality_active(0, true).expect("it exists");
    run(&mut sim, 2.0);
    assert!((sim.state.qpos[2] - held).abs() < 1e-6, "pulled back");
    assert!(sim.set_equality_active(1, true).is_err());
}

#[test]
fn a_joint_equality_gears_two_wheels() {
    let mut b = world();
    for name in ["drive", "driven"] {
        let wheel = scenes::ghost(geom(ShapeKind::Cylinder, [0.1, 0.02, 0.0]));
        let axle = JointSpec {
            armature: 0.01,
            ..joint(JointKind::Hinge, name, [0.0, 0.0, 1.0])
        };
        add(&mut b, 0, name, [0.0; 3], vec![axle], vec![wheel]);
    }
    let gear = EqualityKind::Joint {
        joint1: "driven".into(),
        joint2: Some("drive".into()),
        polycoef: [0.0, -3.0, 0.0, 0.0, 0.0],
    };
    b.equalities.push(equality("gear", gear));
    let mut sim = sim(&b);
    sim.state.qfrc_applied[0] = 0.1;
    run(&mut sim, 1.0);
    // Both wheels of inertia I follow: (I + 9 I) a = τ, but for what the impedance of 0.95 leaves over.
    let inertia = 0.5 * 0.01 + 0.01;
    let expected = 0.1 / (10.0 * inertia);
    assert!(
        (sim.state.qvel[0] / expected - 1.0).abs() < 1e-6,
        "{} rad/s",
        sim.state.qvel[0]
    );
    assert!((sim.state.qvel[1] / sim.state.qvel[0] + 3.0).abs() < 1e-6);
}

#[test]
fn limits_hold_hinge_slide_and_ball() {
    let mut b = world();
    let limited = |kind, name: &str, axis, range| JointSpec {
        range,
        limited: Some(true),
        ..joint(kind, name, axis)
    };
    let hang = || {
        vec![GeomSpec {
            pos: Vec3::new(0.3, 0.0, 0.0),
            ..scenes::ghost(sphere(0.05))
        }]
    };
    let hinge = limited(JointKind::Hinge, "hinge", [0.0, 1.0, 0.0], [-1.0, 0.5]);
    let slide = limited(JointKind::Slide, "slide", [0.0, 0.0, 1.0], [-0.2, 0.5]);
    let ball = limited(JointKind::Ball, "ball", [0.0, 0.0, 1.0], [0.0, 0.7]);
    for joint in [hinge, slide, ball] {
        add(&mut b, 0, "", [0.0; 3], vec![joint], hang());
    }
    let angle = |sim: &Sim| {
        Quat::from_slice(&sim.state.qpos[2..])
            .to_rotation_vector()
            .norm()
    };
    let mut held = sim(&b);
    run(&mut held, 5.0);
    for (what, value, limit) in [
        ("hinge", held.state.qpos[0], 0.5),
        ("slide", -held.state.qpos[1], 0.2),
        ("ball", angle(&held), 0.7),
    ] {
        assert!(
            value > limit && value < limit + 0.02,
            "{what} at {value}, limit {limit}"
        );
    }
    let options = RigidOptions::new().enable_joint_limit(false);
    let mut open = Sim::with_options(scenes::model(&b), options).expect("valid");
    run(&mut open, 0.4);
    assert!(open.state.qpos[1] < -0.5, "without limits it falls");
}

#[test]
fn dry_friction_holds_a_pendulum_and_brakes_a_wheel() {
    let mut b = world();
    let arm = GeomSpec {
        pos: Vec3::new(0.3, 0.0, 0.0),
        ..scenes::ghost(sphere(0.05))
    };
    let stiff = JointSpec {
        frictionloss: 1.2 * 0.3 * G,
        ..joint(JointKind::Hinge, "stiff", [0.0, 1.0, 0.0])
    };
    add(&mut b, 0, "arm", [0.0; 3], vec![stiff], vec![arm]);
    let wheel = JointSpec {
        frictionloss: 0.02,
        armature: 0.01,
        ..joint(JointKind::Hinge, "wheel", [0.0, 0.0, 1.0])
    };
    add(
        &mut b,
        0,
        "wheel",
        [0.0; 3],
        vec![wheel],
        vec![scenes::ghost(sphere(0.05))],
    );
    let mut sim = sim(&b);
    sim.state.qvel[1] = 2.0;
    let inertia = 0.4 * 0.0025 + 0.01;
    run(&mut sim, 0.5);
    assert!(
        (sim.state.qvel[1] - (2.0 - 0.5 * 0.02 / inertia)).abs() < 1e-9,
        "η / I a second"
    );
    run(&mut sim, 1.5);
    assert!(sim.state.qvel[1].abs() < 1e-9, "then it stands");
    // Below the loss dry friction is a damper that lets (1 − d) / (b d) of the free acceleration through as a speed.
    let creep = sim.state.qvel[0].abs();
    assert!(
        creep > 1e-4 && creep < 0.05,
        "the arm creeps at {creep} rad/s"
    );
}

#[test]
fn options_switch_constraints_off_and_soften_them() {
    let height = |options: RigidOptions| {
        let mut sim =
            Sim::with_options(scenes::model(&box_on_slope(0.0, 1.0)), options).expect("valid");
        run(&mut sim, 3.0);
        sim.state.qpos[2]
    };
    assert!(height(RigidOptions::new()) > 0.099);
    assert!(height(RigidOptions::new().disable_constraint(true)) < -1.0);
    let soft = 0.1 - height(RigidOptions::new().constraint_timeconst(0.1));
    let predicted = rest_penetration(4.0, 1.0, SOLIMP, 0.1);
    assert!(
        (soft / predicted - 1.0).abs() < 1e-6,
        "{soft} m instead of {predicted} m"
    );
}
