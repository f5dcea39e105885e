//! Jacobians and bias accelerations of every kind of constraint against finite differences of its position.

use crate::scenes::{everything, model, shake};
use clench_collide::frame_from_normal;
use clench_math::{Mat3, Vec3};
use clench_rigid::builder::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use clench_rigid::constraint::ConstraintSource;
use clench_rigid::contact::Contact;
use clench_rigid::dynamics::integrate::integrate_positions;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Sim, readout};
use std::collections::HashSet;

/// The step of finite differences (rad, m). Their error is its square, plus rounding of 1e-16 over it.
const H: f64 = 1e-5;
const TOLERANCE: f64 = 1e-8;

fn shaken(seed: u64) -> Sim {
    let mut sim = crate::scenes::sim(&everything());
    shake(&mut sim, seed);
    sim
}

/// Returns the constraint rows after moving along `velocity` for `time`, without contacts.
fn rows_at(sim: &Sim, velocity: &[f64], time: f64) -> Vec<readout::ConstraintRow> {
    let mut moved = Sim::new(sim.model().clone()).expect("as the original");
    moved.state.copy_from(&sim.state);
    integrate_positions(sim.model(), &mut moved.state.qpos, velocity, time);
    moved.forward_with_contacts(&[]).expect("finite");
    readout::constraint_rows(moved.workspace(), 0)
}

#[test]
fn rows_are_derivatives_of_positions() {
    let mut kinds = HashSet::new();
    for seed in 0..5 {
        let mut sim = shaken(seed);
        sim.forward_with_contacts(&[]).expect("finite");
        let nv = sim.model().nv;
        let rows = readout::constraint_rows(sim.workspace(), 0);
        let jacobian = readout::jacobian(sim.workspace(), 0);
        for dof in 0..nv {
            let mut along = vec![0.0; nv];
            along[dof] = 1.0;
            let (after, before) = (rows_at(&sim, &along, H), rows_at(&sim, &along, -H));
            let same = |list: &[readout::ConstraintRow]| {
                list.len() == rows.len()
                    && list.iter().zip(&rows).all(|(a, b)| a.source == b.source)
            };
            assert!(
                same(&after) && same(&before),
                "a limit came or went: choose another seed"
            );
            for (i, row) in rows.iter().enumerate() {
                let expected = match row.source {
                    ConstraintSource::DofFriction(d) => f64::from(u8::from(d == dof)),
                    ConstraintSource::TendonFriction(_) => continue,
                    _ => (after[i].pos - before[i].pos) / (2.0 * H),
                };
                let found = jacobian[i * nv + dof];
                assert!(
                    (found - expected).abs() < TOLERANCE,
                    "{:?} row {} dof {dof}: {found} instead of {expected}",
                    row.source,
                    row.row
                );
                kinds.insert((row.source.kind(), row.source.index()));
            }
        }
    }
    for (kind, count) in [
        ("equality", 7),
        ("limit_joint", 4),
        ("limit_tendon", 1),
        ("friction_dof", 6),
    ] {
        let found = kinds.iter().filter(|k| k.0 == kind).count();
        assert_eq!(found, count, "sources of kind {kind} that were tested");
    }
}

#[test]
fn tendon_friction_acts_along_the_tendon() {
    let mut sim = shaken(0);
    sim.forward_with_contacts(&[]).expect("finite");
    let nv = sim.model().nv;
    let rows = readout::constraint_rows(sim.workspace(), 0);
    let jacobian = readout::jacobian(sim.workspace(), 0);
    let row_of = |source| {
        rows.iter()
            .position(|r| r.source == source)
            .expect("it exists")
    };
    let friction = row_of(ConstraintSource::TendonFriction(0));
    let limit = row_of(ConstraintSource::TendonLimit(0));
    let along = |row: usize| &jacobian[row * nv..(row + 1) * nv];
    let sign = if rows[limit].pos > 0.0 { 0.0 } else { 1.0 };
    assert!(sign != 0.0, "the limit is violated");
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let (f, l) = (along(friction), along(limit));
    assert!(
        (dot(f, l).powi(2) - dot(f, f) * dot(l, l)).abs() < 1e-15,
        "parallel"
    );
    assert!((dot(f, f) - (0.7f64.powi(2) + 1.3f64.powi(2))).abs() < 1e-15);
}

#[test]
fn connect_and_weld_have_the_right_reference_acceleration() {
    // aref + b v + k d r = −J̇ v, the row's acceleration at constant velocities.
    for seed in 0..5 {
        let mut sim = shaken(seed);
        let v = sim.state.qvel.clone();
        sim.forward_with_contacts(&[]).expect("finite");
        let rows = readout::constraint_rows(sim.workspace(), 0);
        let (after, before) = (rows_at(&sim, &v, H), rows_at(&sim, &v, -H));
        for start in (0..rows.len()).filter(|&i| rows[i].row == 0) {
            let ConstraintSource::Equality(equality @ 0..4) = rows[start].source else {
                continue;
            };
            let dim = if equality < 2 { 3 } else { 6 };
            let length = rows[start..start + dim]
                .iter()
                .map(|r| r.pos * r.pos)
                .sum::<f64>()
                .sqrt();
            let soft = clench_rigid::constraint::Softness::new(
                DEFAULT_SOLREF,
                DEFAULT_SOLIMP,
                length,
                0.0,
            );
            for i in start..start + dim {
                let bias =
                    -soft.damping * rows[i].vel - soft.stiffness * rows[i].pos - rows[i].aref;
                let expected = (after[i].vel - before[i].vel) / (2.0 * H);
                assert!(
                    (bias - expected).abs() < 1e-7,
                    "equality {equality} row {}: {bias} instead of {expected}",
                    rows[i].row
                );
            }
        }
    }
}

/// Returns contacts between bodies of one tree, of two trees, and with the world.
fn given_contacts(sim: &Sim) -> Vec<Contact<f64>> {
    let geom = |name: &str| {
        let body = sim
            .model()
            .bodies
            .iter()
            .position(|b| b.name == name)
            .expect("it exists");
        sim.model().bodies[body].geoms.start
    };
    let normal = Vec3::from_f64([0.48, 0.6, 0.64]);
    [
        ("world", "hand"),
        ("arm", "leg"),
        ("loose", "tip"),
        ("trunk", "hand"),
        ("arm", "tip"),
    ]
    .iter()
    .enumerate()
    .map(|(i, (a, b))| Contact {
        geoms: [geom(a), geom(b)],
        active: true,
        dim: [6, 4, 3, 6, 1][i],
        dist: -0.001,
        pos: Vec3::from_f64([0.1, 0.3 * i as f64, 0.4]),
        frame: frame_from_normal(normal),
        includemargin: 0.0,
        friction: [0.8, 0.7, 0.02, 0.003, 0.004],
        solref: DEFAULT_SOLREF,
        solreffriction: [0.0; 2],
        solimp: DEFAULT_SOLIMP,
        adhesion: 0.0,
        surfacevel: [0.0; 3],
        block: None,
    })
    .collect()
}

/// Returns the displacement and small rotation of a body's material point and frame, in the contact frame.
fn displacement(
    before: &Sim,
    after: &Sim,
    geom: usize,
    point: Vec3<f64>,
    frame: &Mat3<f64>,
) -> [f64; 6] {
    let body = before.model().geoms[geom].body;
    let (old, new) = (&before.workspace().position, &after.workspace().position);
    let local = old.xmat[body].transpose_mul(point - old.xpos[body]);
    let moved = new.xpos[body] + new.xmat[body] * local - point;
    let turned = (new.xquat[body] * old.xquat[body].conjugate()).to_rotation_vector();
    let (a, b) = (*frame * moved, *frame * turned);
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

#[test]
fn contact_rows_are_derivatives_of_relative_displacement() {
    let options = RigidOptions::new().friction_cone(FrictionCone::Elliptic);
    let scene = model(&everything());
    let mut sim = Sim::with_options(scene.clone(), options).expect("valid");
    shake(&mut sim, 3);
    let contacts = given_contacts(&sim);
    sim.forward_with_contacts(&contacts).expect("finite");
    let rows = readout::constraint_rows(sim.workspace(), 0);
    let jacobian = readout::jacobian(sim.workspace(), 0);
    let nv = scene.nv;
    let mut tested = 0;
    for dof in 0..nv {
        let at = |time: f64| {
            let mut moved = Sim::new(scene.clone()).expect("valid");
            moved.state.copy_from(&sim.state);
            let mut along = vec![0.0; nv];
            along[dof] = time;
            integrate_positions(&scene, &mut moved.state.qpos, &along, 1.0);
            moved.forward_with_contacts(&[]).expect("finite");
            moved
        };
        let (after, before) = (at(H), at(-H));
        for (i, row) in rows.iter().enumerate() {
            let ConstraintSource::Contact(c) = row.source else {
                continue;
            };
            let contact = &contacts[c];
            let relative = |moved: &Sim| {
                let [a, b] = contact
                    .geoms
                    .map(|g| displacement(&sim, moved, g, contact.pos, &contact.frame));
                b[row.row] - a[row.row]
            };
            let expected = (relative(&after) - relative(&before)) / (2.0 * H);
            let found = jacobian[i * nv + dof];
            assert!(
                (found - expected).abs() < TOLERANCE,
                "contact {c} row {}: {found} {expected}",
                row.row
            );
            tested += 1;
        }
    }
    assert_eq!(tested, nv * (6 + 4 + 3 + 6 + 1));
}

#[test]
fn pyramid_edges_combine_contact_rows() {
    let scene = model(&everything());
    let solve = |cone| {
        let mut sim = Sim::with_options(scene.clone(), RigidOptions::new().friction_cone(cone))
            .expect("valid");
        shake(&mut sim, 3);
        let contacts = given_contacts(&sim);
        sim.forward_with_contacts(&contacts).expect("finite");
        let rows = readout::constraint_rows(sim.workspace(), 0);
        let first = rows
            .iter()
            .position(|r| r.source == ConstraintSource::Contact(0));
        let first = first.expect("the contact is a constraint");
        (
            rows,
            readout::jacobian(sim.workspace(), 0),
            first,
            contacts[0].friction,
        )
    };
    let (rows, j, first, mu) = solve(FrictionCone::Pyramidal);
    let (elliptic_rows, elliptic, elliptic_first, _) = solve(FrictionCone::Elliptic);
    let nv = scene.nv;
    for edge in 0..10 {
        let (axis, sign) = (1 + edge / 2, if edge % 2 == 0 { 1.0 } else { -1.0 });
        let combine = |normal: f64, other: f64| normal + sign * mu[axis - 1] * other;
        let (n, t) = (elliptic_first, elliptic_first + axis);
        for dof in 0..nv {
            let expected = combine(elliptic[n * nv + dof], elliptic[t * nv + dof]);
            assert!((j[(first + edge) * nv + dof] - expected).abs() < 1e-15);
        }
        let row = &rows[first + edge];
        assert!((row.vel - combine(elliptic_rows[n].vel, elliptic_rows[t].vel)).abs() < 1e-14);
        assert_eq!(row.pos, -0.001);
    }
}
