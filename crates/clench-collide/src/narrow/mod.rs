//! Narrow phase: the contact points of one pair of shapes.
//!
//! Every kernel takes the two shapes where they are, how far apart points may be, and where to put them.

mod ball;
mod box_box;
mod box_manifold;
mod box_round;
mod boxes;
mod capsule;
mod convex;
mod cylinder;
mod outline;
mod penetration;
mod per_lane;
mod placed;
mod plane;
mod plane_mesh;
mod polygon;
mod segment;
mod separating_axis;

use crate::{Contacts, Pose, Shape, ShapeKind};
use clench_math::{Real, kernel};
use placed::Placed;
pub use separating_axis::SeparatingAxis;

/// Whether [`collide`] knows the pair, given in either order.
pub fn supported(a: ShapeKind, b: ShapeKind) -> bool {
    use ShapeKind::*;
    matches!(
        (a.min(b), a.max(b)),
        (
            Plane | HeightField,
            Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh
        ) | (Sphere, Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh)
            | (Capsule, Capsule | Ellipsoid | Cylinder | Box | Mesh)
            | (Ellipsoid, Ellipsoid | Cylinder | Box | Mesh)
            | (Cylinder, Cylinder | Box | Mesh)
            | (Box, Box | Mesh)
            | (Mesh, Mesh)
    )
}

/// Whether MuJoCo finds the contacts of a pair, given in either order, by its general algorithm, whose flag `multiccd` decides
/// between several points and the deepest alone ([`Contacts::keep_deepest`]). A height field's contacts do not depend on it.
pub fn multiccd_matters(a: ShapeKind, b: ShapeKind) -> bool {
    use ShapeKind::*;
    !matches!(
        (a.min(b), a.max(b)),
        (Plane | HeightField | Sphere, _) | (Capsule, Capsule | Box) | (Box, Box)
    )
}

/// Replaces `out` by the points where shape `a` at `pose_a` and shape `b` at `pose_b` are at most `margin` metres
/// apart.
///
/// The kinds must come in [`ShapeKind`]'s order (`a.kind <= b.kind`). A pair out of order or not [`supported`] yields
/// no points: callers refuse such pairs when they build their scene.
pub fn collide<T: Real>(
    a: &Shape<T>,
    pose_a: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    collide_again(
        a,
        pose_a,
        b,
        pose_b,
        margin,
        &mut SeparatingAxis::default(),
        out,
    );
}

/// As [`collide`], for a pair that is asked about again and again: with the direction in which its shapes were apart the last time, or
/// that of any other pair. It saves searches and changes no result.
#[kernel]
pub fn collide_again<T: Real>(
    a: &Shape<T>,
    pose_a: &Pose<T>,
    b: &Shape<T>,
    pose_b: &Pose<T>,
    margin: T,
    axis: &mut SeparatingAxis<T>,
    out: &mut Contacts<T>,
) {
    use ShapeKind::*;
    out.clear();
    let kinds = (a.kind, b.kind);
    let a = Placed {
        shape: a,
        pose: pose_a,
    };
    let b = Placed {
        shape: b,
        pose: pose_b,
    };
    match kinds {
        (Plane, Sphere) => plane::plane_sphere(a, b, margin, out),
        (Plane, Capsule) => plane::plane_capsule(a, b, margin, out),
        (Plane, Ellipsoid) => plane::plane_ellipsoid(a, b, margin, out),
        (Plane, Cylinder) => plane::plane_cylinder(a, b, margin, out),
        (Plane, Box) => plane::plane_box(a, b, margin, out),
        (HeightField, Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh) => {
            convex::terrain(a, b, margin, out)
        }
        (Plane, Mesh) => plane_mesh::plane_mesh(a, b, margin, out),
        (Sphere, Sphere) => ball::sphere_sphere(a, b, margin, out),
        (Sphere, Capsule) => ball::sphere_capsule(a, b, margin, out),
        (Sphere, Cylinder) => cylinder::sphere_cylinder(a, b, margin, out),
        (Sphere, Box) => box_round::sphere_box(a, b, margin, out),
        (Capsule, Capsule) => capsule::capsule_capsule(a, b, margin, out),
        (Capsule, Cylinder) => cylinder::capsule_cylinder(a, b, margin, out),
        (Capsule, Box) => box_round::capsule_box(a, b, margin, out),
        (Box, Box) => box_box::box_box(a, b, margin, axis, out),
        (Sphere | Capsule | Ellipsoid, Ellipsoid)
        | (Ellipsoid | Cylinder, Cylinder)
        | (Ellipsoid | Cylinder, Box)
        | (Sphere | Capsule | Ellipsoid | Cylinder | Box | Mesh, Mesh) => {
            convex::convex(a, b, margin, axis, out)
        }
        _ => {}
    }
}
