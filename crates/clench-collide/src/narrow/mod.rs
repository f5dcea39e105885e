//! Narrow phase: the contact points of one pair of shapes.
//!
//! Every kernel takes two placed shapes, the margin up to which points may be apart, and the output buffer.

mod ball;
mod box_box;
mod box_manifold;
mod box_round;
mod boxes;
mod capsule;
mod constants;
mod convex;
mod cylinder;
mod outline;
mod pair_memory;
mod penetration;
mod per_lane;
mod placed;
mod plane;
mod plane_mesh;
mod polygon;
mod segment;
mod separating_axis;

use crate::contact::Contacts;
use crate::pose::Pose;
use crate::shape::{Shape, ShapeKind};
use clench_math::{Real, kernel};
pub use constants::SHAPE_CONSTANTS;
pub use convex::{CONVEX_CONSTANTS, CONVEX_COUNTS, DepthProof, LaneProofs};
pub use pair_memory::PairMemory;
use placed::Placed;
pub use separating_axis::SeparatingAxis;

/// Lists the supported pairs of shapes: MuJoCo's algorithm for the pair (closed form or general), and the kernel used
/// here. The names are the kernels' arguments: the two shapes, the margin, the memory of the pair, and the output.
macro_rules! pairs {
    ($a:ident, $b:ident, $margin:ident, $memory:ident, $out:ident:
     $(($first:ident, $second:ident) $mujoco:ident => $find:expr,)*) => {
        /// Returns true if [`collide`] supports the pair, in either order.
        pub fn supported(a: ShapeKind, b: ShapeKind) -> bool {
            matches!(
                (a.min(b), a.max(b)),
                $((ShapeKind::$first, ShapeKind::$second))|*
            )
        }

        /// Returns true if MuJoCo uses its general algorithm for a pair, in either order. Its flag `multiccd` selects
        /// several points or only the deepest ([`Contacts::keep_deepest`]). It does not affect a height field's
        /// contacts.
        pub fn multiccd_applies(a: ShapeKind, b: ShapeKind) -> bool {
            match (a.min(b), a.max(b)) {
                $((ShapeKind::$first, ShapeKind::$second) => Algorithm::$mujoco == Algorithm::General,)*
                _ => false,
            }
        }

        /// Computes the same as [`collide`], for a pair that is queried repeatedly. It uses the direction that last
        /// separated these shapes, or any others, and the proofs of their last depths, to save searches. They change no
        /// result.
        #[kernel]
        pub fn collide_again<T: Real>(
            a: &Shape<T>,
            pose_a: &Pose<T>,
            b: &Shape<T>,
            pose_b: &Pose<T>,
            $margin: T,
            $memory: &mut PairMemory<T>,
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

/// A pointer to [`collide_again`].
pub type Collide<T> =
    fn(&Shape<T>, &Pose<T>, &Shape<T>, &Pose<T>, T, &mut PairMemory<T>, &mut Contacts<T>);

#[derive(PartialEq)]
enum Algorithm {
    Closed,
    General,
}

pairs! { a, b, margin, memory, out:
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
    (Sphere, Ellipsoid) Closed => convex::convex(a.any(), b.any(), margin, memory, out),
    (Sphere, Cylinder) Closed => cylinder::sphere_cylinder(a, b, margin, out),
    (Sphere, Box) Closed => box_round::sphere_box(a, b, margin, out),
    (Sphere, Mesh) Closed => convex::convex(a.any(), b.any(), margin, memory, out),
    (Capsule, Capsule) Closed => capsule::capsule_capsule(a, b, margin, out),
    (Capsule, Ellipsoid) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Capsule, Cylinder) General => cylinder::capsule_cylinder(a, b, margin, out),
    (Capsule, Box) Closed => box_round::capsule_box(a, b, margin, out),
    (Capsule, Mesh) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Ellipsoid, Ellipsoid) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Ellipsoid, Cylinder) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Ellipsoid, Box) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Ellipsoid, Mesh) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Cylinder, Cylinder) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Cylinder, Box) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Cylinder, Mesh) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Box, Box) Closed => box_box::box_box(a, b, margin, memory.axis, out),
    (Box, Mesh) General => convex::convex(a.any(), b.any(), margin, memory, out),
    (Mesh, Mesh) General => convex::convex(a.any(), b.any(), margin, memory, out),
}

/// Replaces `out` by the points where shape `a` at `pose_a` and shape `b` at `pose_b` are at most `margin` metres
/// apart.
///
/// The kinds must be in [`ShapeKind`]'s order (`a.kind() <= b.kind()`). A pair out of order or not [`supported`] yields
/// no points; callers must reject such pairs when they build their scene.
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
        &mut PairMemory::of_axis(&mut SeparatingAxis::default()),
        out,
    );
}
