//! The method that finds the contacts of two shapes.

use clench_collide::{MAX_POINTS, ShapeKind};

/// The methods that find the contacts of two shapes.
pub(crate) const METHODS: [&str; 10] = [
    "ON_PLANE",
    "SPHERE_SPHERE",
    "SPHERE_CAPSULE",
    "SPHERE_CYLINDER",
    "CAPSULE_CAPSULE",
    "CAPSULE_CYLINDER",
    "SPHERE_BOX",
    "CAPSULE_BOX",
    "BOX_BOX",
    "CONVEX",
];

/// Returns the method for a pair of shapes, as an index into [`METHODS`], and its maximum number of contacts; `None` if
/// it is not supported yet. The order of the shapes is that of [`ShapeKind`].
fn method(kinds: [ShapeKind; 2]) -> Option<(usize, usize)> {
    use ShapeKind::{Box, Capsule, Cylinder, Ellipsoid, HeightField, Mesh, Plane, Sphere};
    Some(match kinds {
        [Plane, Sphere | Ellipsoid] => (0, 1),
        [Plane, Capsule] => (0, 2),
        [Plane, Cylinder | Box] => (0, 4),
        [Plane, Mesh] => (0, 8),
        [Sphere, Sphere] => (1, 1),
        [Sphere, Capsule] => (2, 1),
        [Sphere, Cylinder] => (3, 1),
        [Capsule, Capsule] => (4, 2),
        [Capsule, Cylinder] => (5, 3),
        [Sphere, Box] => (6, 1),
        [Capsule, Box] => (7, 2),
        [Box, Box] => (8, 8),
        [Sphere | Capsule | Ellipsoid, Ellipsoid]
        | [Ellipsoid, Cylinder | Box | Mesh]
        | [Sphere, Mesh] => (9, 1),
        [Capsule, Mesh] => (9, 3),
        [Cylinder, Cylinder | Box | Mesh] | [Box | Mesh, Mesh] => (9, 8),
        [
            HeightField,
            Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh,
        ] => (9, MAX_POINTS),
        _ => return None,
    })
}

/// Returns the method for a pair of shapes, as an index into [`METHODS`].
pub(crate) fn method_of_pair(kinds: [ShapeKind; 2]) -> Option<usize> {
    method(kinds).map(|(method, _)| method)
}

/// Returns true if a pair may need the method for general convex shapes.
pub(crate) fn may_be_general(kinds: [ShapeKind; 2]) -> bool {
    method_of_pair(kinds).is_some_and(|method| method >= 7)
}

/// Returns the maximum number of contacts of a pair of shapes; 0 if it is not supported yet.
pub(crate) fn points_of_pair(kinds: [ShapeKind; 2]) -> usize {
    method(kinds).map_or(0, |(_, most)| most)
}
