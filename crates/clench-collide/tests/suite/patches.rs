//! The number and positions of a pair's contact points, which keep bodies at rest.

use crate::common::Scene;
use clench_collide::{ContactPoint, Pose, Shape, ShapeKind};
use clench_math::{Mat3, Quat, Vec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

fn shape(kind: ShapeKind, size: [f64; 3]) -> Shape<'static, f64> {
    Shape::new(kind, Vec3::from_f64(size))
}

fn at(position: [f64; 3], rotation: Mat3<f64>) -> Pose<f64> {
    Pose {
        position: Vec3::from_f64(position),
        rotation,
    }
}

fn turned(axis: [f64; 3], angle: f64) -> Mat3<f64> {
    Quat::from_axis_angle(Vec3::from_f64(axis), angle).to_matrix()
}

fn lying() -> Mat3<f64> {
    turned([0.0, 1.0, 0.0], FRAC_PI_2)
}

fn points(
    a: Shape<'static, f64>,
    pose_a: Pose<f64>,
    b: Shape<'static, f64>,
    pose_b: Pose<f64>,
) -> Vec<ContactPoint<f64>> {
    let scene = Scene {
        a,
        pose_a,
        b,
        pose_b,
        margin: 0.0,
    };
    scene.contacts().as_slice().to_vec()
}

fn on_floor(b: Shape<'static, f64>, pose: Pose<f64>) -> Vec<ContactPoint<f64>> {
    points(shape(ShapeKind::Plane, [0.0; 3]), Pose::IDENTITY, b, pose)
}

/// Asserts the points' positions, in any order, and that all are `depth` deep with an upward normal.
fn assert_patch(points: &[ContactPoint<f64>], depth: f64, expected: &[[f64; 3]]) {
    assert_eq!(points.len(), expected.len(), "{points:?}");
    for p in expected {
        let p = Vec3::from_f64(*p);
        assert!(
            points.iter().any(|c| (c.position - p).norm() < 1e-12),
            "no {p:?} in {points:?}"
        );
    }
    for c in points {
        assert!((c.distance + depth).abs() < 1e-12, "{c:?}");
        assert!((c.frame.rows[0].z - 1.0).abs() < 1e-12, "{c:?}");
    }
}

#[test]
fn a_box_stands_on_four_corners() {
    let found = on_floor(
        shape(ShapeKind::Box, [0.1, 0.2, 0.3]),
        at([0.0, 0.0, 0.299], Mat3::IDENTITY),
    );
    let z = -0.0005;
    assert_patch(
        &found,
        0.001,
        &[
            [0.1, 0.2, z],
            [0.1, -0.2, z],
            [-0.1, 0.2, z],
            [-0.1, -0.2, z],
        ],
    );
}

#[test]
fn a_box_on_its_edge_touches_in_two_points() {
    let found = on_floor(
        shape(ShapeKind::Box, [0.1, 0.2, 0.1]),
        at(
            [0.0, 0.0, 0.1 * 2f64.sqrt() - 0.001],
            turned([0.0, 1.0, 0.0], FRAC_PI_4),
        ),
    );
    assert_patch(&found, 0.001, &[[0.0, 0.2, -0.0005], [0.0, -0.2, -0.0005]]);
}

#[test]
fn a_lying_capsule_touches_with_both_ends_and_friction_along_it() {
    let found = on_floor(
        shape(ShapeKind::Capsule, [0.1, 0.3, 0.0]),
        at([0.0, 0.0, 0.099], lying()),
    );
    assert_patch(&found, 0.001, &[[0.3, 0.0, -0.0005], [-0.3, 0.0, -0.0005]]);
    for c in found {
        assert!((c.frame.rows[1].x.abs() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_standing_capsule_has_a_proper_frame() {
    // The axis of a standing capsule gives no tangent.
    for tilt in [0.0, 0.3, FRAC_PI_2] {
        let rotation = turned([0.0, 1.0, 0.0], tilt);
        let pose = |height: f64| Pose {
            position: rotation * Vec3::new(0.0, 0.0, height),
            rotation,
        };
        let capsule = shape(ShapeKind::Capsule, [0.1, 0.3, 0.0]);
        let found = points(
            shape(ShapeKind::Plane, [0.0; 3]),
            pose(0.0),
            capsule,
            pose(0.399),
        );
        assert_eq!(found.len(), 1);
        let [n, t, b] = found[0].frame.rows;
        assert!(
            n.dot(t).abs() < 1e-12
                && (n.cross(t) - b).norm() < 1e-12
                && (b.norm() - 1.0).abs() < 1e-12
        );
    }
}

#[test]
fn a_cylinder_stands_on_three_points_and_lies_on_two() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.3, 0.0]);
    let (x, y, z) = (0.05, 0.1 * 3f64.sqrt() / 2.0, -0.0005);
    let standing = on_floor(cylinder, at([0.0, 0.0, 0.299], Mat3::IDENTITY));
    assert_patch(&standing, 0.001, &[[0.1, 0.0, z], [-x, y, z], [-x, -y, z]]);
    let flat = on_floor(cylinder, at([0.0, 0.0, 0.099], lying()));
    assert_patch(&flat, 0.001, &[[0.3, 0.0, z], [-0.3, 0.0, z]]);
}

#[test]
fn parallel_capsules_touch_at_both_ends_of_their_overlap() {
    let found = points(
        shape(ShapeKind::Capsule, [0.1, 0.3, 0.0]),
        at([0.0, 0.0, 0.0], lying()),
        shape(ShapeKind::Capsule, [0.1, 0.2, 0.0]),
        at([0.25, 0.0, 0.199], lying()),
    );
    assert_patch(&found, 0.001, &[[0.05, 0.0, 0.0995], [0.3, 0.0, 0.0995]]);
}

#[test]
fn crossing_capsules_touch_once() {
    let capsule = shape(ShapeKind::Capsule, [0.1, 0.3, 0.0]);
    let across = turned([1.0, 0.0, 0.0], FRAC_PI_2);
    let found = points(
        capsule,
        at([0.0; 3], lying()),
        capsule,
        at([0.1, 0.1, 0.199], across),
    );
    assert_patch(&found, 0.001, &[[0.1, 0.0, 0.0995]]);
}

/// Returns the contacts of a capsule on a box or cylinder, which is the second shape but the lower one. Flips the
/// normals.
fn lying_on(b: Shape<'static, f64>, top: f64) -> Vec<ContactPoint<f64>> {
    let capsule = shape(ShapeKind::Capsule, [0.1, 0.3, 0.0]);
    let mut found = points(
        capsule,
        at([0.0, 0.0, top + 0.099], lying()),
        b,
        Pose::IDENTITY,
    );
    for c in &mut found {
        c.frame.rows[0] = -c.frame.rows[0];
    }
    found
}

#[test]
fn a_capsule_lies_on_a_box_as_far_as_both_reach() {
    let wide = lying_on(shape(ShapeKind::Box, [0.5, 0.2, 0.1]), 0.1);
    assert_patch(&wide, 0.001, &[[0.3, 0.0, 0.0995], [-0.3, 0.0, 0.0995]]);
    let narrow = lying_on(shape(ShapeKind::Box, [0.15, 0.2, 0.1]), 0.1);
    assert_patch(&narrow, 0.001, &[[0.15, 0.0, 0.0995], [-0.15, 0.0, 0.0995]]);
}

#[test]
fn a_capsule_lies_on_a_cylinder_as_far_as_both_reach() {
    let wide = lying_on(shape(ShapeKind::Cylinder, [0.5, 0.1, 0.0]), 0.1);
    assert_patch(&wide, 0.001, &[[0.3, 0.0, 0.0995], [-0.3, 0.0, 0.0995]]);
    let narrow = lying_on(shape(ShapeKind::Cylinder, [0.15, 0.1, 0.0]), 0.1);
    assert_patch(&narrow, 0.001, &[[0.15, 0.0, 0.0995], [-0.15, 0.0, 0.0995]]);
}

#[test]
fn a_capsule_lies_along_a_cylinder() {
    let found = points(
        shape(ShapeKind::Capsule, [0.1, 0.3, 0.0]),
        at([0.0, 0.0, 0.0], lying()),
        shape(ShapeKind::Cylinder, [0.2, 0.2, 0.0]),
        at([0.05, 0.0, 0.299], lying()),
    );
    assert_patch(&found, 0.001, &[[-0.15, 0.0, 0.0995], [0.25, 0.0, 0.0995]]);
}

#[test]
fn stacked_boxes_touch_in_the_overlap_of_their_faces() {
    let lower = shape(ShapeKind::Box, [0.2, 0.2, 0.1]);
    let upper = shape(ShapeKind::Box, [0.1, 0.2, 0.1]);
    let found = points(
        lower,
        Pose::IDENTITY,
        upper,
        at([0.15, 0.05, 0.199], Mat3::IDENTITY),
    );
    let z = 0.0995;
    assert_patch(
        &found,
        0.001,
        &[
            [0.05, -0.15, z],
            [0.2, -0.15, z],
            [0.2, 0.2, z],
            [0.05, 0.2, z],
        ],
    );
}

#[test]
fn boxes_an_eighth_turn_apart_touch_in_an_octagon() {
    let cube = shape(ShapeKind::Box, [0.1; 3]);
    let turn = turned([0.0, 0.0, 1.0], FRAC_PI_4);
    let found = points(cube, Pose::IDENTITY, cube, at([0.0, 0.0, 0.199], turn));
    let (near, far, z) = (0.1 * (2f64.sqrt() - 1.0), 0.1, 0.0995);
    let mut octagon = Vec::new();
    for (x, y) in [(near, far), (far, near)] {
        octagon.extend([[x, y, z], [-x, y, z], [x, -y, z], [-x, -y, z]]);
    }
    assert_patch(&found, 0.001, &octagon);
}

#[test]
fn crossing_edges_touch_once() {
    let cube = shape(ShapeKind::Box, [0.1; 3]);
    let tip = 0.1 * 2f64.sqrt();
    let found = points(
        cube,
        at([0.0; 3], turned([1.0, 0.0, 0.0], FRAC_PI_4)),
        cube,
        at(
            [0.0, 0.0, 2.0 * tip - 0.001],
            turned([0.0, 1.0, 0.0], FRAC_PI_4),
        ),
    );
    assert_patch(&found, 0.001, &[[0.0, 0.0, tip - 0.0005]]);
}
