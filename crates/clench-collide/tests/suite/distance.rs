//! Distances compared with a search over directions, in both orders, near and far.

use crate::common::{BOUNDED, PAIRS, Random, V, off_surface};
use clench_collide::{HeightField, Hull, Pose, Shape, ShapeKind, convex_hull, distance, supported};
use clench_math::{Mat3, Vec3};

/// The accuracy of the search for the true distance, m.
const SEARCH: f64 = 1e-6;

#[test]
fn the_distance_is_true_and_its_points_lie_on_the_surfaces() {
    let mut random = Random(31);
    for kinds in PAIRS {
        let (mut apart, mut deep) = (0, 0);
        for _ in 0..150 {
            let scene = random.scene(kinds);
            let truth = scene.distance(&mut random);
            let found = distance(
                &scene.a,
                &scene.pose_a,
                &scene.b,
                &scene.pose_b,
                f64::INFINITY,
            );
            let found = found.expect("a distance");
            let error = (found.distance - truth).abs();
            assert!(
                error < SEARCH,
                "{kinds:?}: {} for {truth} in {scene:?}",
                found.distance
            );
            apart += usize::from(truth > 0.0);
            deep += usize::from(truth < -1e-3);

            let [p, q] = found.points;
            assert!((q - p - found.normal * found.distance).norm() < 1e-12);
            let off = [
                off_surface(&scene.a, &scene.pose_a, p),
                off_surface(&scene.b, &scene.pose_b, q),
            ];
            assert!(
                off[0] < 1e-6 && off[1] < 1e-6,
                "{kinds:?}: {off:?} in {scene:?}, {found:?}"
            );

            let back = distance(
                &scene.b,
                &scene.pose_b,
                &scene.a,
                &scene.pose_a,
                f64::INFINITY,
            )
            .unwrap();
            assert!((back.distance - found.distance).abs() < 1e-9);
            if kinds.0 != kinds.1 {
                assert_eq!((back.normal, back.points), (-found.normal, [q, p]));
            }
            let limited = |limit| distance(&scene.a, &scene.pose_a, &scene.b, &scene.pose_b, limit);
            assert!(
                limited(found.distance - 1e-6).is_none(),
                "{kinds:?} {scene:?}"
            );
            let near = limited(found.distance + 1e-6);
            let near =
                near.unwrap_or_else(|| panic!("not within its distance: {scene:?} {found:?}"));
            assert!((near.distance - found.distance).abs() < 1e-8);
        }
        assert!(apart > 5 && deep > 30, "{kinds:?}: {apart}, {deep}");
    }
}

#[test]
fn hulls_have_distances() {
    let mut random = Random(32);
    let corners: Vec<V> = (0..8)
        .map(|i| {
            let side = |axis: usize| if i >> axis & 1 == 1 { 0.3 } else { -0.3 };
            Vec3::new(side(0), side(1), side(2))
        })
        .collect();
    let hull = Hull::new(&convex_hull(&corners, None).unwrap(), &corners);
    let cube = Shape::new(ShapeKind::Box, Vec3::new(0.3, 0.3, 0.3));
    for kind in BOUNDED.into_iter().filter(|kind| *kind != ShapeKind::Mesh) {
        for _ in 0..50 {
            let scene = random.scene((kind, ShapeKind::Box));
            let of = |shape: &Shape<f64>| {
                distance(shape, &scene.pose_b, &scene.a, &scene.pose_a, 9.0).unwrap()
            };
            let (mesh, same) = (of(&Shape::mesh(&hull)), of(&cube));
            assert!((mesh.distance - same.distance).abs() < 1e-7, "{kind:?}");
        }
    }
}

#[test]
fn height_fields_have_distances_from_afar() {
    let heights = (0..2500).map(|k| f64::from(k % 7 * (k % 11)));
    let field = HeightField::new(50, 50, heights.collect(), [5.0, 5.0, 0.5, 0.2]).unwrap();
    let ground = Shape::height_field(&field);
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.01, 0.0, 0.0));
    let mut random = Random(33);
    for height in [1e-3, 0.3, 5.0, 100.0] {
        for _ in 0..5 {
            let center = Vec3::new(
                random.range(-4.0, 4.0),
                random.range(-4.0, 4.0),
                0.51 + height,
            );
            let pose = Pose {
                position: center,
                rotation: Mat3::IDENTITY,
            };
            let found = distance(&ball, &pose, &ground, &Pose::IDENTITY, f64::INFINITY)
                .expect("a distance");
            // The grid points of the field bound the distance from above, its highest level from below.
            let nearest_corner = (0..2500)
                .map(|k| (field.point(k / 50, k % 50) - center).norm() - 0.01)
                .fold(f64::INFINITY, f64::min);
            assert!(found.distance <= nearest_corner + 1e-9 && found.distance >= height - 1e-9);
            let on = found.points[1];
            let cell = |x: f64| (((x / 5.0 + 1.0) * 24.5).floor() as usize).min(48);
            let (row, column) = (cell(on.y), cell(on.x));
            let heights =
                [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(r, c)| field.point(row + r, column + c).z);
            assert!(on.z <= heights.into_iter().fold(0.0, f64::max) + 1e-9);
            assert!(((found.points[0] - center).norm() - 0.01).abs() < 1e-9);
        }
    }
}

#[test]
fn some_pairs_and_some_numbers_have_no_distance() {
    use ShapeKind::*;
    let unit = Vec3::new(1.0, 1.0, 1.0);
    let of = |a: ShapeKind, b: ShapeKind, position| {
        let pose = Pose {
            position,
            rotation: Mat3::IDENTITY,
        };
        distance(
            &Shape::new(a, unit),
            &Pose::IDENTITY,
            &Shape::new(b, unit),
            &pose,
            f64::INFINITY,
        )
    };
    assert!(!supported(Plane, Plane) && of(Plane, Plane, V::ZERO).is_none());
    assert!(
        of(Plane, HeightField, V::ZERO).is_none()
            && of(HeightField, HeightField, V::ZERO).is_none()
    );
    // Without their assets, height fields have no distance.
    assert!(of(HeightField, Sphere, V::ZERO).is_none());
    for x in [f64::NAN, f64::INFINITY] {
        for b in [Sphere, Capsule, Ellipsoid, Cylinder, Box] {
            for a in [Plane, Sphere, Capsule, Ellipsoid, Cylinder, Box] {
                let (a, b) = (a.min(b), a.max(b));
                let found = of(a, b, Vec3::new(x, 0.0, x));
                assert!(
                    found.is_none_or(|f| f.distance.is_finite()),
                    "{a:?} {b:?} {found:?}"
                );
            }
        }
    }
}
