//! The protrusion of a shape from another; `parity/test_enclosed.py` compares the numbers with MuJoCo's.

use clench_collide::{Ascent, Pose, Shape, ShapeKind, protrusion};
use clench_math::{Quat, Vec3};

/// Returns the protrusion of a rotated ellipsoid from a box.
fn out(search: Ascent) -> f64 {
    let egg = Shape::new(ShapeKind::Ellipsoid, Vec3::new(0.1, 0.2, 0.3));
    let pose = Pose {
        position: Vec3::new(0.35, 0.1, -0.2),
        rotation: Quat::from_f64([0.9, 0.1, -0.3, 0.2])
            .normalize()
            .to_matrix(),
    };
    let outer = Shape::new(ShapeKind::Box, Vec3::new(0.4, 0.5, 0.6));
    protrusion(&egg, &pose, &outer, &Pose::IDENTITY, search).expect("both are bounded")
}

#[test]
fn an_unbounded_search_ends_at_a_maximum() {
    let unbounded = Ascent {
        iterations: usize::MAX,
        tolerance: 0.0,
    };
    let usual = Ascent {
        iterations: 300,
        tolerance: 1e-9,
    };
    assert!(out(unbounded) >= out(usual));
    assert!((out(unbounded) - out(usual)).abs() < 1e-6);
}
