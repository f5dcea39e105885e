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

/// The pairs of shapes whose contacts are found: which algorithm MuJoCo takes, a closed form or its general one, and the kernel that finds
/// them here. The names are those by which the kernels know the two shapes, the margin, the direction in which they were apart, and where
/// the points go.
macro_rules! pairs {
    ($a:ident, $b:ident, $margin:ident, $axis:ident, $out:ident:
     $(($first:ident, $second:ident) $mujoco:ident => $find:expr,)*) => {
        /// Whether [`collide`] knows the pair, given in either order.
        pub fn supported(a: ShapeKind, b: ShapeKind) -> bool {
            matches!(
                (a.min(b), a.max(b)),
                $((ShapeKind::$first, ShapeKind::$second))|*
            )
        }

        /// Whether MuJoCo finds the contacts of a pair, given in either order, by its general algorithm, whose flag `multiccd` decides
        /// between several points and the deepest alone ([`Contacts::keep_deepest`]). A height field's contacts do not depend on it.
        pub fn multiccd_matters(a: ShapeKind, b: ShapeKind) -> bool {
            match (a.min(b), a.max(b)) {
                $((ShapeKind::$first, ShapeKind::$second) => Algorithm::$mujoco == Algorithm::General,)*
                _ => false,
            }
        }

        /// As [`collide`], for a pair that is asked about again and again: with the direction in which its shapes were apart the last
        /// time, or that of any other pair. It saves searches and changes no result.
        #[kernel]
        pub fn collide_again<T: Real>(
            a: &Shape<T>,
            pose_a: &Pose<T>,
            b: &Shape<T>,
            pose_b: &Pose<T>,
            $margin: T,
            $axis: &mut SeparatingAxis<T>,
            $out: &mut Contacts<T>,
        ) {
            $out.clear();
            match (*a, *b) {
                $((Shape::$first(a), Shape::$second(b)) => {
                    let $a = Placed { shape: a, pose: pose_a };
                    let $b = Placed { shape: b, pose: pose_b };
                    $find
                })*
                _ => {}
            }
        }
    };
}

#[derive(PartialEq)]
enum Algorithm {
    Closed,
    General,
}

pairs! { a, b, margin, axis, out:
    (Plane, Sphere) Closed => plane::plane_sphere(a, b, margin, out),
    (Plane, Capsule) Closed => plane::plane_capsule(a, b, margin, out),
    (Plane, Ellipsoid) Closed => plane::plane_ellipsoid(a, b, margin, out),
    (Plane, Cylinder) Closed => plane::plane_cylinder(a, b, margin, out),
    (Plane, Box) Closed => plane::plane_box(a, b, margin, out),
    (Plane, Mesh) Closed => plane_mesh::plane_mesh(a, b, margin, out),
    (HeightField, Sphere) Closed => convex::terrain(a, b.any(), margin, out),
    (HeightField, Capsule) Closed => convex::terrain(a, b.any(), margin, out),
    (HeightField, Ellipsoid) Closed => convex::terrain(a, b.any(), margin, out),
    (HeightField, Cylinder) Closed => convex::terrain(a, b.any(), margin, out),
    (HeightField, Box) Closed => convex::terrain(a, b.any(), margin, out),
    (HeightField, Mesh) Closed => convex::terrain(a, b.any(), margin, out),
    (Sphere, Sphere) Closed => ball::sphere_sphere(a, b, margin, out),
    (Sphere, Capsule) Closed => ball::sphere_capsule(a, b, margin, out),
    (Sphere, Ellipsoid) Closed => convex::convex(a.any(), b.any(), margin, axis, out),
    (Sphere, Cylinder) Closed => cylinder::sphere_cylinder(a, b, margin, out),
    (Sphere, Box) Closed => box_round::sphere_box(a, b, margin, out),
    (Sphere, Mesh) Closed => convex::convex(a.any(), b.any(), margin, axis, out),
    (Capsule, Capsule) Closed => capsule::capsule_capsule(a, b, margin, out),
    (Capsule, Ellipsoid) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Capsule, Cylinder) General => cylinder::capsule_cylinder(a, b, margin, out),
    (Capsule, Box) Closed => box_round::capsule_box(a, b, margin, out),
    (Capsule, Mesh) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Ellipsoid, Ellipsoid) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Ellipsoid, Cylinder) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Ellipsoid, Box) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Ellipsoid, Mesh) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Cylinder, Cylinder) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Cylinder, Box) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Cylinder, Mesh) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Box, Box) Closed => box_box::box_box(a, b, margin, axis, out),
    (Box, Mesh) General => convex::convex(a.any(), b.any(), margin, axis, out),
    (Mesh, Mesh) General => convex::convex(a.any(), b.any(), margin, axis, out),
}

/// Replaces `out` by the points where shape `a` at `pose_a` and shape `b` at `pose_b` are at most `margin` metres
/// apart.
///
/// The kinds must come in [`ShapeKind`]'s order (`a.kind() <= b.kind()`). A pair out of order or not [`supported`] yields
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
