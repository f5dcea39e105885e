//! Contact points compared with the truth, found without the library: depths, normals and positions.

use crate::common::{PAIRS, Random, by_support, off_surface};
use clench_collide::ShapeKind;

/// The accuracy of the search for the true distance, m.
const SEARCH: f64 = 1e-6;

#[test]
fn the_deepest_point_is_the_true_distance() {
    let mut random = Random(1);
    for kinds in PAIRS {
        let (mut touching, mut apart) = (0, 0);
        for _ in 0..200 {
            let scene = random.scene(kinds);
            let truth = scene.distance(&mut random);
            match scene.deepest() {
                Some(point) => {
                    touching += 1;
                    let distance = point.distance;
                    let error = (distance - truth).abs();
                    assert!(
                        error < SEARCH,
                        "{kinds:?}: {distance} for {truth} in {scene:?}"
                    );
                }
                None => {
                    apart += 1;
                    assert!(
                        truth > scene.margin - SEARCH,
                        "{kinds:?}: nothing at {truth} in {scene:?}"
                    );
                }
            }
        }
        assert!(
            touching >= 50 && apart > 5,
            "{kinds:?}: {touching} touch, {apart} are apart"
        );
    }
}

#[test]
fn positions_lie_midway_between_the_surfaces() {
    use ShapeKind::*;
    let mut random = Random(3);
    for kinds in PAIRS {
        for _ in 0..400 {
            let scene = random.scene(kinds);
            let Some(c) = scene.deepest() else { continue };
            // Between curved and flat surfaces, a distance within 1e-9 m is found some way off the nearest points.
            // Faces of hulls are flat to a relative 1e-6.
            let exact = match kinds {
                _ if !by_support(kinds) => 1e-9,
                (Sphere | Capsule | Box | Mesh, Mesh) => 1e-6,
                _ => 1e-4,
            };
            let half = c.frame.rows[0] * (0.5 * c.distance);
            let on_a = off_surface(&scene.a, &scene.pose_a, c.position - half);
            let on_b = off_surface(&scene.b, &scene.pose_b, c.position + half);
            assert!(
                on_a < exact,
                "{kinds:?}: {on_a} off the first in {scene:?}, {c:?}"
            );
            assert!(
                on_b < exact,
                "{kinds:?}: {on_b} off the second in {scene:?}, {c:?}"
            );
        }
    }
}

#[test]
fn frames_are_rotations_and_normals_point_to_the_second_shape() {
    let mut random = Random(4);
    for kinds in PAIRS {
        for _ in 0..1000 {
            let scene = random.scene(kinds);
            for c in scene.contacts().as_slice() {
                let [n, t, b] = c.frame.rows;
                for (u, v, dot) in [(n, n, 1.0), (t, t, 1.0), (b, b, 1.0), (n, t, 0.0)] {
                    assert!((u.dot(v) - dot).abs() < 1e-9, "{kinds:?}: {scene:?}");
                }
                assert!((n.cross(t) - b).norm() < 1e-9, "{kinds:?}: {scene:?}");
                // A motion of the second shape along the normal increases the gap by its length.
                let mut moved = scene;
                moved.pose_b.position += n * 1e-3;
                let gain = moved.gap_along(n) - scene.gap_along(n);
                assert!((gain - 1e-3).abs() < 1e-12, "{kinds:?}: {scene:?}");
            }
        }
    }
}
