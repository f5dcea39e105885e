//! The tree: bodies, their joints, and the frames on them.

use crate::model::Origin;
use clench_collide::ShapeKind;
use std::ops::Range;
use std::sync::Arc;

/// Kinds of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Six degrees of freedom: position and unit quaternion.
    Free,
    /// Three rotations: unit quaternion.
    Ball,
    /// Translation along an axis.
    Slide,
    /// Rotation about an axis.
    Hinge,
}

impl JointKind {
    /// Returns the number of position coordinates.
    pub fn nq(self) -> usize {
        match self {
            JointKind::Free => 7,
            JointKind::Ball => 4,
            JointKind::Slide | JointKind::Hinge => 1,
        }
    }
    /// Returns the number of degrees of freedom.
    pub fn nv(self) -> usize {
        match self {
            JointKind::Free => 6,
            JointKind::Ball => 3,
            JointKind::Slide | JointKind::Hinge => 1,
        }
    }
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name, possibly empty.
    pub name: String,
    /// Parent body; the world is its own.
    pub parent: usize,
    /// Top-level ancestor below the world (the world for itself).
    pub root: usize,
    /// The ancestor-or-self that this body is welded to: the nearest with joints, or mocap, or the world.
    pub weld: usize,
    /// Its joints.
    pub joints: Range<usize>,
    /// Its degrees of freedom.
    pub dofs: Range<usize>,
    /// Its geoms.
    pub geoms: Range<usize>,
    /// Its sites.
    pub sites: Range<usize>,
    /// Its cameras.
    pub cameras: Range<usize>,
    /// Index among mocap bodies.
    pub mocap: Option<usize>,
    /// Last dof of the nearest ancestor-or-self that has any: the end of the chain that moves this body.
    pub last_dof: Option<usize>,
    /// True if the inertial frame coincides with the body frame.
    pub simple_inertia: bool,
    /// True if its part of the mass matrix is diagonal in every configuration, and MuJoCo stores only its diagonal (its
    /// `body_simple`).
    pub diagonal_inertia: bool,
    /// True if fluid forces act on its geoms as ellipsoids, and not on the body as a box.
    pub fluid_ellipsoids: bool,
    /// True if its constraints are scaled by the mean over all directions, even if it only slides along coordinate
    /// axes.
    pub never_simple: bool,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// A joint.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Name, possibly empty.
    pub name: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// Body that it moves.
    pub body: usize,
    /// First position coordinate.
    pub qpos: usize,
    /// First degree of freedom.
    pub dof: usize,
    /// The index in [`State::plastic`](crate::State::plastic) of the rest position of its spring; `None` if the spring
    /// does not yield.
    pub plastic: Option<usize>,
    /// True if its range is a limit.
    pub limited: bool,
    /// True if its total actuator force is limited.
    pub actfrclimited: bool,
    /// True if gravity compensation counts as actuation.
    pub actgravcomp: bool,
    /// The actuators that may damp it or add inertia to it, in order.
    pub reflecting: Vec<usize>,
    /// Group.
    pub group: i32,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// A degree of freedom.
#[derive(Clone, Debug)]
pub struct Dof {
    /// Body that it moves.
    pub body: usize,
    /// Joint that it belongs to.
    pub joint: usize,
    /// The dof before it on the path to the root.
    pub parent: Option<usize>,
    /// True if it may have dry friction in any environment (frictionloss > 0 in the model).
    pub frictionloss: bool,
}

/// A named frame on a body, with a volume for sensors.
#[derive(Clone, Debug)]
pub struct Site {
    /// Name, possibly empty.
    pub name: String,
    /// Body that carries it.
    pub body: usize,
    /// Shape of its volume.
    pub kind: ShapeKind,
    /// Group.
    pub group: i32,
    /// The mesh whose convex hull it is, for `ShapeKind::Mesh`.
    pub mesh: Option<usize>,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
}
