//! Curved shapes and hulls at rest: the points where faces and edges lie on each other.

use crate::common::{Random, Scene, V, hulls};
use clench_collide::{PATCH_POINTS, Pose, Shape, ShapeKind};
use clench_math::{Mat3, Quat, Vec3};

fn shape(kind: ShapeKind, size: [f64; 3]) -> Shape<'static, f64> {
    Shape::new(kind, Vec3::from_f64(size))
}

/// Returns a shape on another, upright, moved by `offset` and rotated.
fn on_top(
    a: Shape<'static, f64>,
    b: Shape<'static, f64>,
    offset: [f64; 3],
    turn: Mat3<f64>,
) -> Scene {
    Scene {
        a,
        pose_a: Pose::IDENTITY,
        b,
        pose_b: Pose {
            position: Vec3::from_f64(offset),
            rotation: turn,
        },
        margin: 0.0,
    }
}

/// Returns the area spanned by the points in a horizontal plane.
fn area(scene: &Scene) -> f64 {
    let contacts = scene.contacts();
    let points: Vec<V> = contacts.as_slice().iter().map(|c| c.position).collect();
    let middle = points.iter().fold(V::ZERO, |sum, p| sum + *p) * (1.0 / points.len() as f64);
    let mut arms: Vec<V> = points.iter().map(|p| *p - middle).collect();
    arms.sort_by(|p, q| p.y.atan2(p.x).total_cmp(&q.y.atan2(q.x)));
    let next = arms.iter().cycle().skip(1);
    arms.iter()
        .zip(next)
        .map(|(p, q)| p.cross(*q).z / 2.0)
        .sum()
}

#[test]
fn a_standing_cylinder_covers_its_cap() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let cap = std::f64::consts::PI * 0.01;
    // An octagon in a circle has 0.9003 of its area; one that contains the deepest point of the circle, slightly less.
    for (tilt, share) in [(0.0, 0.9), (1e-7, 0.9), (1e-4, 0.87), (1e-3, 0.87)] {
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), tilt).to_matrix();
        let wide = shape(ShapeKind::Box, [0.3, 0.4, 0.1]);
        let mut scene = on_top(cylinder, wide, [0.05, 0.02, 0.299], Mat3::IDENTITY);
        scene.pose_a.rotation = turn;
        assert!(area(&scene) > share * cap, "{tilt}");
        let narrow = shape(ShapeKind::Box, [0.05, 0.06, 0.1]);
        let mut scene = on_top(cylinder, narrow, [0.0, 0.0, 0.299], Mat3::IDENTITY);
        scene.pose_a.rotation = turn;
        assert!((area(&scene) - 0.1 * 0.12).abs() < 1e-4, "{tilt}");
        let stacked = on_top(cylinder, cylinder, [0.0, 0.0, 0.399], turn);
        assert!(
            area(&stacked) > 0.85 * cap,
            "{tilt}: {} {:?}",
            area(&stacked),
            stacked
                .contacts()
                .as_slice()
                .iter()
                .map(|c| (c.position.to_array(), c.distance))
                .collect::<Vec<_>>()
        );
    }
}

#[test]
fn points_of_a_tilted_cap_have_the_depth_of_the_tilt() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let ground = shape(ShapeKind::Box, [0.5, 0.5, 0.1]);
    let tilt = 1e-3;
    let mut scene = on_top(cylinder, ground, [0.0, 0.0, -0.2995], Mat3::IDENTITY);
    scene.pose_a.rotation = Quat::from_axis_angle(Vec3::new(0.0, 1.0, 0.0), tilt).to_matrix();
    let contacts = scene.contacts();
    assert_eq!(contacts.as_slice().len(), 8);
    for c in contacts.as_slice() {
        let bottom = -0.2 / tilt.cos() + c.position.x * -tilt.tan();
        assert!((c.distance - (bottom + 0.1995)).abs() < 1e-6, "{c:?}");
    }
}

#[test]
fn cylinders_side_by_side_touch_along_their_overlap() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let scene = on_top(cylinder, cylinder, [0.199, 0.0, 0.1], Mat3::IDENTITY);
    let contacts = scene.contacts();
    let [p, q] = contacts.as_slice() else {
        panic!("{contacts:?}");
    };
    for (c, z) in [(p, -0.1), (q, 0.2)] {
        assert!(
            (c.position - Vec3::new(0.0995, 0.0, z)).norm() < 1e-9,
            "{c:?}"
        );
        assert!((c.distance + 0.001).abs() < 1e-9);
    }
}

#[test]
fn a_lying_cylinder_touches_a_box_with_both_ends() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let ground = shape(ShapeKind::Box, [0.15, 0.5, 0.1]);
    let mut scene = on_top(cylinder, ground, [0.0, 0.0, -0.199], Mat3::IDENTITY);
    let lying = Quat::from_axis_angle(Vec3::new(0.0, 1.0, 0.0), std::f64::consts::FRAC_PI_2);
    scene.pose_a.rotation = lying.to_matrix();
    let contacts = scene.contacts();
    assert_eq!(contacts.as_slice().len(), 2);
    let sum = contacts
        .as_slice()
        .iter()
        .fold(0.0, |sum, c| sum + c.position.x);
    assert!(sum.abs() < 1e-9);
    for c in contacts.as_slice() {
        assert!((c.position.x.abs() - 0.15).abs() < 1e-9, "{c:?}");
        assert!((c.distance + 0.001).abs() < 1e-9);
    }
}

/// Returns the hull of some points.
fn hull(points: &[V]) -> Shape<'static, f64> {
    Shape::mesh(hulls::hull_of(points))
}

const TILTS: [f64; 4] = [0.0, 1e-7, 1e-4, 1e-3];

#[test]
fn a_hull_of_a_box_lies_as_the_box_does() {
    let (low, high) = (Vec3::new(0.2, 0.3, 0.1), Vec3::new(0.1, 0.2, 0.15));
    let boxes = [low, high].map(|size| Shape::new(ShapeKind::Box, size));
    let meshes = [low, high].map(|size| hull(&hulls::corners(size)));
    for tilt in TILTS {
        // The box is rotated by 0.5 rad and moved over an edge, so the contact is a pentagon.
        let yaw = Quat::from_axis_angle(Vec3::new(0.0, 0.0, 1.0), 0.5);
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), tilt) * yaw;
        let scene = |a, b| on_top(a, b, [0.15, 0.1, 0.2499 - 0.3 * tilt], turn.to_matrix());
        let expected = area(&scene(boxes[0], boxes[1]));
        assert!(expected > 0.03, "{tilt}");
        for (a, b) in [(boxes[0], meshes[1]), (meshes[0], meshes[1])] {
            let scene = scene(a, b);
            assert!((area(&scene) - expected).abs() < 1e-4 * expected, "{tilt}");
            let normal = scene.deepest().unwrap().frame.rows[0];
            assert!((normal.z - 1.0).abs() < tilt * tilt + 1e-12, "{tilt}");
        }
    }
}

#[test]
fn a_hull_of_a_cylinder_covers_its_cap() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let prism = hull(&hulls::cap_circles(0.1, 0.2, 40));
    let cap = std::f64::consts::PI * 0.01;
    for tilt in TILTS {
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), tilt).to_matrix();
        for below in [
            hull(&hulls::corners(Vec3::new(0.3, 0.4, 0.2))),
            shape(ShapeKind::Box, [0.3, 0.4, 0.2]),
            cylinder,
            prism,
        ] {
            let height = 0.3999 - 0.1 * tilt;
            let scene = on_top(below, prism, [0.0, 0.0, height], turn);
            let share = area(&scene) / cap;
            assert!(share > 0.85, "{share} of {:?} at {tilt}", below.kind());
        }
        let mut scene = on_top(
            cylinder,
            hull(&hulls::corners(Vec3::new(0.3, 0.4, 0.2))),
            [0.0, 0.0, -0.3999 + 0.1 * tilt],
            Mat3::IDENTITY,
        );
        scene.pose_a.rotation = turn;
        assert!(area(&scene) > 0.85 * cap, "{tilt}");
    }
}

#[test]
fn a_hull_rests_on_a_plane_with_all_of_a_face() {
    let floor = shape(ShapeKind::Plane, [0.0; 3]);
    let flat = hull(&hulls::corners(Vec3::new(0.1, 0.2, 0.3)));
    let scene = on_top(floor, flat, [0.0, 0.0, 0.2999], Mat3::IDENTITY);
    let contacts = scene.contacts();
    assert_eq!(contacts.as_slice().len(), 4);
    for c in contacts.as_slice() {
        assert!((c.distance + 1e-4).abs() < 1e-12 && (c.position.z + 5e-5).abs() < 1e-12);
    }
    assert!((area(&scene) - 0.08).abs() < 1e-12);
    // Many corners: a regular octagon of them has 0.9003 of the circle's area.
    let round = hull(&hulls::cap_circles(0.1, 0.2, 64));
    for tilt in TILTS {
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), tilt).to_matrix();
        let scene = on_top(floor, round, [0.0, 0.0, 0.1999 - 0.1 * tilt], turn);
        assert_eq!(scene.contacts().as_slice().len(), PATCH_POINTS);
        assert!(area(&scene) > 0.85 * std::f64::consts::PI * 0.01, "{tilt}");
        let lowest = scene.deepest().unwrap().distance;
        assert!((lowest - scene.gap_along(Vec3::new(0.0, 0.0, 1.0))).abs() < 1e-12);
    }
}

#[test]
fn a_fine_round_hull_rolls_on_its_deepest_vertex() {
    let mut random = Random(31);
    let ball = hull(&hulls::round(&mut random, 1000, Vec3::new(0.1, 0.1, 0.1)));
    let floor = shape(ShapeKind::Plane, [0.0; 3]);
    for _ in 0..100 {
        let scene = on_top(floor, ball, [0.0, 0.0, 0.097], random.rotation());
        let contacts = scene.contacts();
        assert!((3..=PATCH_POINTS).contains(&contacts.as_slice().len()));
        let lowest = scene.deepest().unwrap().distance;
        assert!((lowest - scene.gap_along(Vec3::new(0.0, 0.0, 1.0))).abs() < 1e-12);
        for c in contacts.as_slice() {
            let above = c.position.z - c.distance * 0.5;
            assert!(c.distance <= 0.0 && above.abs() < 1e-12, "{c:?}");
        }
    }
}
