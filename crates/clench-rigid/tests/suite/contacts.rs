//! Effects of contacts on bodies: rest positions, slip and forces.

use crate::scenes::{
    G, add, cuboid, free, parts_on_a_mesh, plane, rest_penetration, run, sim, sphere, world,
};
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{DEFAULT_SOLIMP, GeomSpec, MeshSpec, ModelBuilder};
use clench_rigid::contact::Contact;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Sim, readout};

/// Builds a box of 1 kg and 20 cm height on a floor that is tilted by `angle` about y.
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
    Sim::with_options(crate::scenes::model(builder), options).expect("valid")
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
        for solimp in [DEFAULT_SOLIMP, [0.3, 0.9, 0.02, 0.4, 3.0]] {
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
            // It is so flat that it does not rock.
            let flat = &mut builder.bodies[1];
            flat.geoms[0].size.z = 0.01;
            flat.pos = flat.quat.rotate(Vec3::new(0.0, 0.0, 0.01));
            let mut sim = with_cone(&builder, cone);
            run(&mut sim, 1.0);
            sim.state.qvel[0].hypot(sim.state.qvel[2])
        };
        let creep = speed(slope.tan() * 1.05);
        // Soft friction allows some motion.
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
    // Rolling friction decelerates by 5/7 g c / r = 0.7 m/s², so 1 m/s vanishes after 1.43 s.
    assert!(
        end_speed(6).abs() < 0.01,
        "rolling friction does: {}",
        end_speed(6)
    );
}

#[test]
fn options_switch_constraints_off_and_soften_them() {
    let height = |options: RigidOptions| {
        let mut sim = Sim::with_options(crate::scenes::model(&box_on_slope(0.0, 1.0)), options)
            .expect("valid");
        run(&mut sim, 3.0);
        sim.state.qpos[2]
    };
    assert!(height(RigidOptions::new()) > 0.099);
    assert!(height(RigidOptions::new().disable_constraint(true)) < -1.0);
    let soft = 0.1 - height(RigidOptions::new().constraint_timeconst(0.1));
    let predicted = rest_penetration(4.0, 1.0, DEFAULT_SOLIMP, 0.1);
    assert!(
        (soft / predicted - 1.0).abs() < 1e-6,
        "{soft} m instead of {predicted} m"
    );
}

#[test]
fn without_multiccd_a_pair_has_only_its_deepest_contact() {
    let [several, one] = [true, false].map(|multiccd| {
        let mut sim = sim(&parts_on_a_mesh(multiccd));
        // It is tilted, so that one point is the deepest.
        for (k, body) in [0, 7, 14].into_iter().enumerate() {
            let turn = Quat::from_rotation_vector(Vec3::new(6e-4, 8e-4, 0.0) * (1.0 + k as f64));
            sim.state.qpos[body + 3..body + 7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z]);
        }
        sim.forward().expect("finite");
        sim.contacts().to_vec()
    });
    for (geoms, count) in [([1, 0], 4), ([2, 0], 8), ([1, 3], 4)] {
        let same = |c: &&Contact<f64>| c.geoms.iter().all(|g| geoms.contains(g));
        let all: Vec<_> = several.iter().filter(same).collect();
        assert_eq!(all.len(), count, "{geoms:?}");
        let left: Vec<_> = one.iter().filter(same).collect();
        if geoms == [1, 3] {
            assert_eq!(left.len(), count, "two boxes are not concerned");
            continue;
        }
        let [left] = left[..] else {
            panic!("{geoms:?}: {left:?}");
        };
        let deepest = all.iter().map(|c| c.dist).fold(f64::INFINITY, f64::min);
        assert_eq!(left.dist, deepest);
        assert!(
            all.iter()
                .any(|c| c.pos == left.pos && c.frame == left.frame)
        );
    }
}

/// Builds a stack of three equal bodies, each offset by a few millimetres.
fn stack(shape: &GeomSpec, base: GeomSpec) -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new();
    let round = (0..40).map(|k| f64::from(k) * std::f64::consts::TAU / 40.0);
    let cap_corners: Vec<_> = round
        .flat_map(|a| [-0.05, 0.05].map(|z| [0.1 * a.cos(), 0.1 * a.sin(), z]))
        .collect();
    b.meshes.push(MeshSpec::hull("prism", &cap_corners));
    b.bodies[0].geoms.push(base);
    for k in 0..3 {
        let level = f64::from(k);
        let at = [0.004 * level, -0.003 * level, 0.05 + 0.1 * level];
        add(&mut b, 0, &format!("{k}"), at, free(), vec![shape.clone()]);
    }
    b
}

#[test]
fn stacks_of_round_bodies_come_to_rest() {
    let slab = GeomSpec {
        pos: Vec3::new(0.0, 0.0, -0.1),
        ..cuboid([0.5, 0.5, 0.1])
    };
    for shape in [GeomSpec::cylinder(0.1, 0.05), GeomSpec::mesh("prism")] {
        for base in [&slab, &plane()] {
            let mut sim = sim(&stack(&shape, base.clone()));
            run(&mut sim, 3.0);
            let mut before = sim.contacts().to_vec();
            for _ in 0..200 {
                sim.step().expect("finite");
                let fastest = sim
                    .state
                    .qvel
                    .iter()
                    .fold(0.0, |most: f64, v| most.max(v.abs()));
                assert!(
                    fastest < 1e-4,
                    "{:?} on {:?}: {fastest}",
                    shape.kind,
                    base.kind
                );
                let now = sim.contacts().to_vec();
                for c in &now {
                    let same = before.iter().filter(|b| b.geoms == c.geoms);
                    let jump = same
                        .map(|b| (b.pos - c.pos).norm())
                        .fold(f64::INFINITY, f64::min);
                    assert!(jump < 1e-6, "{:?} on {:?}: {jump}", shape.kind, base.kind);
                }
                before = now;
            }
        }
    }
}
