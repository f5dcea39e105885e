//! Collision detection: contact points from shapes and poses. No joints, no bodies.
//!
//! [`collide`] computes the contact points of two shapes, [`distance`] their distance, [`protrusion`] how far one
//! protrudes from the other, and [`ray`] the first hit of a ray. [`near`] and [`BroadPhase`] find the pairs that may
//! touch. Contacts and rays are generic over [`Real`](clench_math::Real): one call serves one environment (`f64`) or
//! several in parallel; each contact point has a mask of its environments. The choice of contact points follows MuJoCo
//! 4.0.
//!
//! ```
//! use clench_collide::{Contacts, Pose, Shape, ShapeKind, collide};
//! use clench_math::Vec3;
//!
//! // A ball of radius 0.1 m pressed 1 mm into the ground.
//! let ground = Shape::new(ShapeKind::Plane, Vec3::ZERO);
//! let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.1, 0.0, 0.0));
//! let above = Pose { position: Vec3::new(0.0, 0.0, 0.099), ..Pose::IDENTITY };
//!
//! let mut contacts = Contacts::<f64>::new();
//! collide(&ground, &Pose::IDENTITY, &ball, &above, 0.0, &mut contacts);
//! let [point] = contacts.as_slice() else { panic!("a ball touches once") };
//! assert!((point.distance + 0.001).abs() < 1e-12);
//! assert_eq!(point.frame.rows[0], Vec3::new(0.0, 0.0, 1.0));
//! ```

#![deny(unreachable_pub)]

mod broad;
mod compiled;
mod contact;
mod differentiated;
mod distance;
mod frame;
mod height_field;
mod hull;
mod narrow;
mod pose;
mod protrusion;
mod ray;
mod shape;

pub use broad::{Bound, BroadPhase, Mobility, allowance, near};
pub use compiled::compiled_collide;
pub use contact::{ContactPoint, Contacts, MAX_POINTS, PATCH_POINTS};
pub use differentiated::{MovingPoint, moving_points};
pub use distance::{Separation, distance};
pub use frame::{frame_along, frame_from_normal};
pub use height_field::{HeightField, HeightFieldError};
pub use hull::{Hull, HullError, HullSurface, convex_hull};
#[doc(hidden)]
pub use narrow::{CONVEX_CONSTANTS, CONVEX_COUNTS, SHAPE_CONSTANTS};
pub use narrow::{
    Collide, DepthProof, LaneProofs, PairMemory, SeparatingAxis, collide, collide_again,
    multiccd_applies, supported,
};
pub use pose::Pose;
pub use protrusion::{Ascent, protrusion, protrusion_of_points};
pub use ray::{Hit, Ray, TriangleMesh, TriangleMeshError, TriangleNode, UnitRay, ray};
pub use shape::{
    Capsule, Cuboid, Cylinder, Ellipsoid, Mesh, Plane, Shape, ShapeKind, Sphere, Terrain,
};
