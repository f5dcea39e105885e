//! Cylinders that overlap boxes, cylinders and hulls of few faces, with depths in closed form: no direction has a
//! larger gap than the one found, and every kind of direction is found in some poses.

use crate::common::{
    Random, Scene, V,
    hulls::{hull_of, round},
    mesh_hull,
};
use clench_collide::{Pose, Shape, ShapeKind};
use clench_math::{Mat3, Quat};
use std::collections::BTreeMap;

/// The kind of a contact, determined from an exact normal: which axes of a cylinder and a box, or of two cylinders, it
/// is parallel or perpendicular to, or the number of hull vertices furthest along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Touch {
    Face,
    Cap,
    EdgeOnSide,
    CornerOnSide,
    EdgeOnRim,
    SideOnSide,
    RimOnSide,
    RimOnRim,
}

fn touch(scene: &Scene, n: V) -> Option<Touch> {
    let own = scene.pose_a.axis().dot(n).abs();
    let cosines = scene.pose_b.rotation.transpose_mul(n).to_array();
    let (one, zero) = (|x: f64| (1.0 - x.abs()) < 1e-12, |x: f64| x.abs() < 1e-12);
    if let Some(hull) = mesh_hull(&scene.b) {
        let d = -scene.pose_b.rotation.transpose_mul(n);
        let along = || hull.vertices().iter().map(|v| v.dot(d));
        let most = along().fold(f64::NEG_INFINITY, f64::max);
        let near = |x: &f64| *x > most - 1e-12 * hull.radius();
        return Some(match (along().filter(near).count(), own) {
            (3.., _) => Touch::Face,
            (_, z) if one(z) => Touch::Cap,
            (2, z) if zero(z) => Touch::EdgeOnSide,
            (_, z) if zero(z) => Touch::CornerOnSide,
            (2, _) => Touch::EdgeOnRim,
            _ => return None,
        });
    }
    if scene.b.kind() == ShapeKind::Cylinder {
        return Some(match (own, cosines[2]) {
            (z, u) if one(z) || one(u) => Touch::Cap,
            (z, u) if zero(z) && zero(u) => Touch::SideOnSide,
            (z, u) if zero(z) || zero(u) => Touch::RimOnSide,
            _ => Touch::RimOnRim,
        });
    }
    if cosines.into_iter().any(one) {
        return Some(Touch::Face);
    }
    match (one(own), zero(own), cosines.into_iter().any(zero)) {
        (true, ..) => Some(Touch::Cap),
        (_, true, true) => Some(Touch::EdgeOnSide),
        (_, true, false) => Some(Touch::CornerOnSide),
        (_, false, true) => Some(Touch::EdgeOnRim),
        (_, false, false) => None,
    }
}

/// The distribution of a scene's sizes.
#[derive(Clone, Copy, Debug)]
enum Sizes {
    /// 5 to 50 cm.
    Usual,
    /// 1 mm to 1 m, each independent.
    Uneven,
    /// As `Uneven`, but some are zero.
    Flat,
}

/// The rotations of the bodies.
#[derive(Clone, Copy, Debug)]
enum Turns {
    Any,
    /// By right angles.
    Right,
    /// By right angles, up to an error of 1e-12 to 0.1 rad.
    NearlyRight,
}

/// Returns a ball of few faces or the ground below a triangle, arbitrarily flat and acute.
fn solid(random: &mut Random, size: V) -> Shape<'static, f64> {
    let mut points = match (random.unit() * 3.0) as usize {
        0 => round(random, 4, size),
        1 => {
            let count = 5 + (random.unit() * 25.0) as usize;
            round(random, count, size)
        }
        _ => {
            let top: [V; 3] = [0; 3].map(|_| random.direction().scale_by(size));
            let below = |p: V| V::new(p.x, p.y, -2.0 * size.z);
            [top, top.map(below)].concat()
        }
    };
    let middle = points.iter().fold(V::ZERO, |sum, p| sum + *p) * (1.0 / points.len() as f64);
    points.iter_mut().for_each(|p| *p -= middle);
    Shape::mesh(hull_of(&points))
}

fn scene(random: &mut Random, kind: ShapeKind, sizes: Sizes, turns: Turns) -> Scene {
    let mut shape = |kind| {
        let mut length = || match sizes {
            Sizes::Usual => random.range(0.05, 0.5),
            // Flat points have no hull.
            Sizes::Flat if kind != ShapeKind::Mesh && random.unit() < 0.2 => 0.0,
            _ => 10f64.powf(random.range(-3.0, 0.0)),
        };
        let size = V::new(length(), length(), length());
        match kind {
            ShapeKind::Mesh => solid(random, size),
            _ => Shape::new(kind, size),
        }
    };
    let (a, b) = (shape(ShapeKind::Cylinder), shape(kind));
    let rotation_a = random.quarter_turns();
    let rotation_b = match turns {
        Turns::Any => random.rotation(),
        Turns::Right => random.quarter_turns(),
        Turns::NearlyRight => {
            let tilt = random.direction() * 10f64.powf(random.range(-12.0, -1.0));
            Quat::from_rotation_vector(tilt).to_matrix() * random.quarter_turns()
        }
    };
    let pose = |rotation: Mat3<f64>, position| Pose { position, rotation };
    let mut scene = Scene {
        a,
        pose_a: pose(rotation_a, V::ZERO),
        b,
        pose_b: pose(rotation_b, V::ZERO),
        margin: 0.0,
    };
    // Concentric, deep or shallow: a fraction of the separating distance along some direction.
    let any = random.direction();
    let direction = match (random.unit() * 6.0) as usize {
        0 => rotation_a.column(2),
        1 => rotation_b.column(0),
        2 | 3 => {
            (any - rotation_a.column(2) * any.dot(rotation_a.column(2)))
                .normalize()
                .0
        }
        _ => any,
    };
    let share = match (random.unit() * 8.0) as usize {
        0 => 0.0,
        1..=5 => 1.0 - 10f64.powf(random.range(-6.0, -1.0)),
        _ => random.unit(),
    };
    scene.pose_b.position = direction * (-scene.gap_along(direction) * share);
    scene
}

/// Tries poses of a cylinder and another shape. Returns the number of contacts of each kind.
fn no_direction_has_a_larger_gap(kind: ShapeKind, seed: u64) -> BTreeMap<Touch, usize> {
    let mut random = Random(seed);
    let mut touches = BTreeMap::new();
    for sizes in [Sizes::Usual, Sizes::Uneven, Sizes::Flat] {
        for (turns, poses) in [
            (Turns::Any, 1000),
            (Turns::Right, 100),
            (Turns::NearlyRight, 200),
        ] {
            for _ in 0..poses {
                let scene = scene(&mut random, kind, sizes, turns);
                let (truth, normal) = scene.optima(&mut random)[0];
                let size = scene.a.bounding_radius() + scene.b.bounding_radius();
                let Some(c) = scene.deepest() else {
                    assert!(truth >= -2e-9 * size, "nothing at {truth} in {scene:?}");
                    continue;
                };
                let n = c.frame.rows[0];
                let gap = scene.gap_along(n);
                assert!(
                    gap >= truth - 2e-9 * size,
                    "{gap} along {n:?}, but {truth} along {normal:?} in {scene:?}"
                );
                let error = (c.distance - gap).abs();
                assert!(error <= 1e-6 * size, "{error} off in {scene:?}");
                if let Some(touch) = touch(&scene, n) {
                    *touches.entry(touch).or_insert(0) += 1;
                }
            }
        }
    }
    touches
}

#[test]
fn a_cylinder_in_a_box() {
    let touches = no_direction_has_a_larger_gap(ShapeKind::Box, 31);
    let often = touches.values().all(|count| *count > 50);
    assert!(touches.len() == 5 && often, "{touches:?}");
}

#[test]
fn a_cylinder_in_a_cylinder() {
    let touches = no_direction_has_a_larger_gap(ShapeKind::Cylinder, 32);
    let often = touches.values().all(|count| *count > 10);
    assert!(touches.len() == 4 && often, "{touches:?}");
}

#[test]
fn a_cylinder_in_a_hull() {
    let touches = no_direction_has_a_larger_gap(ShapeKind::Mesh, 33);
    let often = touches.values().all(|count| *count > 50);
    assert!(touches.len() == 5 && often, "{touches:?}");
}

/// Except in directions across two cap circles, these overlap by less than a micrometre in all directions, and the
/// search for a common point also finds an overlap.
#[test]
fn cylinders_apart_by_a_micrometre_do_not_touch() {
    let pose = |position, rows: [[f64; 3]; 3]| Pose {
        position: V::from_array(position),
        rotation: Mat3 {
            rows: rows.map(V::from_array),
        },
    };
    let cylinder = |radius, half| Shape::new(ShapeKind::Cylinder, V::new(radius, half, 0.0));
    let scene = Scene {
        a: cylinder(0.2383805466375288, 0.0024906566132974887),
        pose_a: pose(
            [0.0; 3],
            [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        ),
        b: cylinder(0.2844832290641202, 0.21939622610709786),
        pose_b: pose(
            [-0.49054095363572203, 0.0, 0.3413382560541415],
            [
                [
                    -0.5019293079390668,
                    -0.11463775660966324,
                    0.8572777581340332,
                ],
                [
                    -0.7100657361392111,
                    -0.5113139482302858,
                    -0.48411227696293535,
                ],
                [
                    0.49383562061974695,
                    -0.8517137025460264,
                    0.17524311313843022,
                ],
            ],
        ),
        margin: 0.0,
    };
    assert!(scene.deepest().is_none(), "{:?}", scene.deepest());
}

/// Coaxial cylinders have, up to rounding, the same gap in every direction across their axis.
#[test]
fn the_normal_of_coaxial_cylinders_does_not_turn_with_rounding() {
    let cylinder = |radius, half| Shape::new(ShapeKind::Cylinder, V::new(radius, half, 0.0));
    let mut random = Random(34);
    for _ in 0..100 {
        let any = random.direction();
        let noise = V::new(any.x, any.y, 0.0) * 1e-17;
        let tilt = Quat::from_rotation_vector(random.direction() * 1e-16);
        let scene = Scene {
            a: cylinder(0.01, 0.2),
            pose_a: Pose::IDENTITY,
            b: cylinder(0.02, 0.1),
            pose_b: Pose {
                position: V::new(0.0, 0.0, 0.05) + noise,
                rotation: tilt.to_matrix(),
            },
            margin: 0.0,
        };
        let deepest = scene.deepest().expect("one is around the other");
        assert_eq!(deepest.frame.rows[0], V::new(1.0, 0.0, 0.0), "{scene:?}");
        assert!((deepest.distance + 0.03).abs() < 1e-15, "{deepest:?}");
    }
}
