//! Pairs that are typical of a simulation: pressed or apart a little, on round coordinates, resting face to face.
//! Compares depths and normals with the truth by brute force.

use crate::common::placement::{PLACEMENTS, placed};
use crate::common::{PAIRS, Random, Scene, V, by_support, off_surface};
use clench_collide::{Pose, Shape, ShapeKind};
use clench_math::Mat3;

fn angle(u: V, v: V) -> f64 {
    u.cross(v).norm().atan2(u.dot(v)).to_degrees()
}

/// Checks that 99 of 100 depths are within 1e-6 m of the truth, and 99 of 100 normals within 0.1° if the true one is
/// unique. No depth is off by more than 1e-4 m.
#[test]
fn depths_and_normals_are_true() {
    let mut random = Random(21);
    for kinds in PAIRS {
        let (mut near, mut far_off, mut normals, mut turned) = (0, 0, 0, 0);
        for k in 0..500 {
            let placement = PLACEMENTS[k % 4];
            let scene = placed(&mut random, kinds, placement);
            let optima = scene.optima(&mut random);
            let (truth, normal) = optima[0];
            let Some(c) = scene.deepest() else {
                assert!(
                    truth > scene.margin - 1e-6,
                    "nothing at {truth} in {scene:?}"
                );
                continue;
            };
            near += 1;
            let error = (c.distance - truth).abs();
            far_off += usize::from(error > 1e-6);
            assert!(
                error < 1e-4,
                "{placement:?}: {} for {truth} in {scene:?}",
                c.distance
            );
            // The normal is not unique if another direction has nearly the same gap.
            let rival = |(gap, n): &(f64, V)| truth - gap < 1e-8 && angle(*n, normal) > 0.05;
            if optima.iter().any(rival) {
                continue;
            }
            normals += 1;
            turned += usize::from(angle(c.frame.rows[0], normal) > 0.1);
        }
        assert!(near > 440 && normals > 350, "{kinds:?}: {near}, {normals}");
        assert!(
            far_off * 100 <= near,
            "{kinds:?}: {far_off} of {near} depths off"
        );
        assert!(
            turned * 100 <= normals,
            "{kinds:?}: {turned} of {normals} normals off"
        );
    }
}

/// Excludes capsules: the points of a tilted capsule next to the deepest lie on a ball about its axis, slightly inside.
#[test]
fn every_point_lies_midway_between_the_surfaces() {
    let mut random = Random(22);
    for kinds in PAIRS
        .into_iter()
        .filter(|kinds| kinds.0 != ShapeKind::Capsule && by_support(*kinds))
    {
        let mut points = 0;
        for k in 0..400 {
            let scene = placed(&mut random, kinds, PLACEMENTS[k % 4]);
            let contacts = scene.contacts();
            for c in contacts.as_slice() {
                points += 1;
                assert!(c.distance <= scene.margin);
                let half = c.frame.rows[0] * (0.5 * c.distance);
                let on_a = off_surface(&scene.a, &scene.pose_a, c.position - half);
                let on_b = off_surface(&scene.b, &scene.pose_b, c.position + half);
                assert!(
                    on_a < 1e-6 && on_b < 1e-6,
                    "{on_a}, {on_b}: {c:?} in {scene:?}"
                );
            }
        }
        assert!(points > 300, "{kinds:?}: {points}");
    }
}

/// Nearly coincident vertices of these cylinders once made a sliver, on which the search terminated 6 mm too early.
#[test]
fn a_sliver_does_not_deceive() {
    let pose = |position: [f64; 3], rows: [[f64; 3]; 3]| Pose {
        position: V::from_array(position),
        rotation: Mat3 {
            rows: rows.map(V::from_array),
        },
    };
    let cylinder = |radius, half| Shape::new(ShapeKind::Cylinder, V::new(radius, half, 0.0));
    let scene = Scene {
        a: cylinder(0.4893183589786955, 0.2397221883143682),
        pose_a: pose(
            [0.4715968704184732, -0.996850259215508, 0.30161676085313327],
            [
                [0.7689965286047217, 0.26476132958368126, 0.5818468676129216],
                [
                    -0.28117488751513786,
                    0.9575140922845988,
                    -0.06408935720734268,
                ],
                [
                    -0.5740949587174033,
                    -0.11431623433914403,
                    0.8107692501210075,
                ],
            ],
        ),
        b: cylinder(0.10380336642386795, 0.21702828651452827),
        pose_b: pose(
            [0.13672730787313814, -0.3762281627476035, 0.5751945200421366],
            [
                [
                    0.38868050095769946,
                    0.42420837827794056,
                    -0.8179087479505716,
                ],
                [0.8528859037604307, 0.1702000185813083, 0.4935763252443087],
                [0.3485872965872754, -0.8894263350462038, -0.2956479176051352],
            ],
        ),
        margin: 0.05,
    };
    let found = scene.deepest().expect("within the margin").distance;
    assert!((found - 0.04761838154017693).abs() < 1e-9, "{found}");
}
