//! The method that finds the contacts of two shapes.

use crate::codes::codes;
use clench_collide::{MAX_POINTS, ShapeKind};

codes! {
    /// The methods that find the contacts of two shapes.
    enum Method {
        /// A plane, and any shape.
        OnPlane = "ON_PLANE",
        SphereSphere = "SPHERE_SPHERE",
        SphereCapsule = "SPHERE_CAPSULE",
        SphereCylinder = "SPHERE_CYLINDER",
        CapsuleCapsule = "CAPSULE_CAPSULE",
        CapsuleCylinder = "CAPSULE_CYLINDER",
        SphereBox = "SPHERE_BOX",
        CapsuleBox = "CAPSULE_BOX",
        BoxBox = "BOX_BOX",
        /// Any two convex shapes, or terrain and a convex shape.
        Convex = "CONVEX",
    }
}

/// Returns the method for a pair of shapes and its maximum number of contacts; `None` if they have no contacts. The
/// order of the shapes is that of [`ShapeKind`].
fn method(kinds: [ShapeKind; 2]) -> Option<(Method, usize)> {
    use ShapeKind::{Box, Capsule, Cylinder, Ellipsoid, HeightField, Mesh, Plane, Sphere};
    Some(match kinds {
        [Plane, Sphere | Ellipsoid] => (Method::OnPlane, 1),
        [Plane, Capsule] => (Method::OnPlane, 2),
        [Plane, Cylinder | Box] => (Method::OnPlane, 4),
        [Plane, Mesh] => (Method::OnPlane, 8),
        [Sphere, Sphere] => (Method::SphereSphere, 1),
        [Sphere, Capsule] => (Method::SphereCapsule, 1),
        [Sphere, Cylinder] => (Method::SphereCylinder, 1),
        [Capsule, Capsule] => (Method::CapsuleCapsule, 2),
        [Capsule, Cylinder] => (Method::CapsuleCylinder, 3),
        [Sphere, Box] => (Method::SphereBox, 1),
        [Capsule, Box] => (Method::CapsuleBox, 2),
        [Box, Box] => (Method::BoxBox, 8),
        [Sphere | Capsule | Ellipsoid, Ellipsoid]
        | [Ellipsoid, Cylinder | Box | Mesh]
        | [Sphere, Mesh] => (Method::Convex, 1),
        [Capsule, Mesh] => (Method::Convex, 3),
        [Cylinder, Cylinder | Box | Mesh] | [Box | Mesh, Mesh] => (Method::Convex, 8),
        [
            HeightField,
            Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh,
        ] => (Method::Convex, MAX_POINTS),
        // Planes and height fields do not collide with each other.
        [Plane | HeightField, Plane | HeightField] => return None,
        // In the wrong order.
        [
            Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh,
            Plane | HeightField,
        ]
        | [Capsule | Ellipsoid | Cylinder | Box | Mesh, Sphere]
        | [Ellipsoid | Cylinder | Box | Mesh, Capsule]
        | [Cylinder | Box | Mesh, Ellipsoid]
        | [Box | Mesh, Cylinder]
        | [Mesh, Box] => return None,
    })
}

/// Returns the method for a pair of shapes; `None` if they have no contacts.
pub(crate) fn method_of_pair(kinds: [ShapeKind; 2]) -> Option<Method> {
    method(kinds).map(|(method, _)| method)
}

/// Returns true if a pair may need the method for general convex shapes.
pub(crate) fn may_be_general(kinds: [ShapeKind; 2]) -> bool {
    method_of_pair(kinds).is_some_and(|method| match method {
        Method::CapsuleBox | Method::BoxBox | Method::Convex => true,
        Method::OnPlane
        | Method::SphereSphere
        | Method::SphereCapsule
        | Method::SphereCylinder
        | Method::CapsuleCapsule
        | Method::CapsuleCylinder
        | Method::SphereBox => false,
    })
}

/// Returns the maximum number of contacts of a pair of shapes; 0 if they have none.
pub(crate) fn points_of_pair(kinds: [ShapeKind; 2]) -> usize {
    method(kinds).map_or(0, |(_, max)| max)
}
