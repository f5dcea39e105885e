//! Records of structure: what each element is and what it belongs to. No number that a user might randomize.

use crate::builder::Origin;
use clench_collide::{Hull, ShapeKind, TriangleMesh, convex_hull};
use clench_math::{Quat, Vec3};
use std::ops::Range;
use std::sync::OnceLock;

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
    /// Position coordinates of the joint.
    pub fn nq(self) -> usize {
        match self {
            JointKind::Free => 7,
            JointKind::Ball => 4,
            JointKind::Slide | JointKind::Hinge => 1,
        }
    }
    /// Degrees of freedom of the joint.
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
    /// Index among mocap bodies.
    pub mocap: Option<usize>,
    /// Last dof of the nearest ancestor-or-self that has any: the end of the chain that moves this body.
    pub last_dof: Option<usize>,
    /// The inertial frame coincides with the body frame.
    pub simple_inertia: bool,
    /// Where it was written.
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
    /// Its range is a limit.
    pub limited: bool,
    /// Its total actuator force is limited.
    pub actfrclimited: bool,
    /// Gravity compensation counts as actuation.
    pub actgravcomp: bool,
    /// Group.
    pub group: i32,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// A degree of freedom.
#[derive(Clone, Debug)]
pub struct Dof {
    /// Body that it moves.
    pub body: usize,
    /// Joint that it belongs to.
    pub joint: usize,
    /// The dof before it on the way to the root.
    pub parent: Option<usize>,
    /// Whether any of its environments may have dry friction here (frictionloss > 0 in the model).
    pub frictionloss: bool,
}

/// A shape on a body.
#[derive(Clone, Debug)]
pub struct Geom {
    /// Name, possibly empty.
    pub name: String,
    /// Shape.
    pub kind: ShapeKind,
    /// Its mesh, for `ShapeKind::Mesh`.
    pub mesh: Option<usize>,
    /// Its height field, for `ShapeKind::HeightField`.
    pub height_field: Option<usize>,
    /// Body that carries it.
    pub body: usize,
    /// Contact type bits.
    pub contype: u32,
    /// Contact affinity bits.
    pub conaffinity: u32,
    /// Dimensions of the contact.
    pub condim: u32,
    /// Whose parameters win.
    pub priority: i32,
    /// Group.
    pub group: i32,
    /// Whether it can be seen: rays pass through what cannot.
    pub visible: bool,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// A mesh about its centre of mass, along its principal axes.
///
/// Its numbers are structure: they are the same in every environment.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Name.
    pub name: String,
    /// Its centre of mass where its author put it (scaled, about the reference pose), m.
    pub pos: Vec3<f64>,
    /// Its principal axes there.
    pub quat: Quat<f64>,
    /// Vertices, m.
    pub vertices: Vec<Vec3<f64>>,
    /// Triangles, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// What collides; `None` where no geom with this mesh does.
    pub hull: Option<Hull>,
    /// What queries need of it, made when they first do.
    pub(crate) on_demand: OnDemand,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// What of a mesh only queries need.
#[derive(Clone, Debug, Default)]
pub(crate) struct OnDemand {
    triangles: OnceLock<TriangleMesh>,
    hull: OnceLock<Option<Hull>>,
}

impl Mesh {
    /// Its triangles, for rays. The first call takes some 0.4 µs a triangle (0.1 s for 200,000).
    pub fn triangles(&self) -> &TriangleMesh {
        self.on_demand.triangles.get_or_init(|| {
            // Whoever writes numbers that are not finite into a model gets meshes that no ray hits.
            let mesh = TriangleMesh::new(self.vertices.clone(), self.faces.clone());
            mesh.unwrap_or_default()
        })
    }

    /// Its hull, whether it collides or not. `None` where it is flat.
    pub fn any_hull(&self) -> Option<&Hull> {
        let make = || {
            let surface = convex_hull(&self.vertices, None).ok()?;
            Some(Hull::new(&surface, &self.vertices))
        };
        let spare = || self.on_demand.hull.get_or_init(make).as_ref();
        self.hull.as_ref().or_else(spare)
    }
}

/// Terrain; its numbers are structure, as those of a [`Mesh`].
#[derive(Clone, Debug)]
pub struct HeightField {
    /// Name.
    pub name: String,
    /// Heights and size.
    pub shape: clench_collide::HeightField,
}

/// A named frame on a body, with a volume in which sensors feel.
#[derive(Clone, Debug)]
pub struct Site {
    /// Name, possibly empty.
    pub name: String,
    /// Body that carries it.
    pub body: usize,
    /// Shape of its volume.
    pub kind: ShapeKind,
}

/// A fixed tendon: Σ coef · joint position.
#[derive(Clone, Debug)]
pub struct Tendon {
    /// Name, possibly empty.
    pub name: String,
    /// Joint of each term; coefficients are `params.wrap_coef` over the same range.
    pub joints: Vec<usize>,
    /// Where the coefficients start in `params.wrap_coef`.
    pub coefs: Range<usize>,
    /// Its range is a limit.
    pub limited: bool,
    /// Its total actuator force is limited.
    pub actfrclimited: bool,
    /// It may have dry friction.
    pub frictionloss: bool,
}

/// What an actuator pulls on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transmission {
    /// A joint, axes in the child frame.
    Joint(usize),
    /// A joint, axes in the parent frame.
    JointInParent(usize),
    /// A fixed tendon.
    Tendon(usize),
}

/// How a control becomes an activation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DynamicsKind {
    /// No activation: the control acts directly.
    #[default]
    None,
    /// ȧ = control.
    Integrator,
    /// ȧ = (control − a) / timeconst.
    Filter,
    /// As `Filter`, integrated exactly.
    FilterExact,
}

/// Gain of an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GainKind {
    /// `gainprm[0]`.
    #[default]
    Fixed,
    /// `gainprm[0] + gainprm[1] · length + gainprm[2] · velocity`.
    Affine,
}

/// Bias of an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BiasKind {
    /// None.
    #[default]
    None,
    /// `biasprm[0] + biasprm[1] · length + biasprm[2] · velocity`.
    Affine,
}

/// An actuator.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// Name, possibly empty.
    pub name: String,
    /// What it pulls on.
    pub transmission: Transmission,
    /// Its dynamics.
    pub dynamics: DynamicsKind,
    /// Index of its activation.
    pub act: Option<usize>,
    /// Its gain.
    pub gain: GainKind,
    /// Its bias.
    pub bias: BiasKind,
    /// Its control is clamped.
    pub ctrllimited: bool,
    /// Its force is clamped.
    pub forcelimited: bool,
    /// Its activation is clamped.
    pub actlimited: bool,
    /// The activation as of the end of the step acts.
    pub actearly: bool,
    /// Switched off by its group.
    pub disabled: bool,
    /// Group.
    pub group: i32,
}

/// What an equality constraint holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EqualityTarget {
    /// Points of two bodies coincide; anchors are `params.eq_anchor1`, `eq_anchor2`.
    Connect {
        /// First body.
        body1: usize,
        /// Second body.
        body2: usize,
    },
    /// Frames of two bodies coincide; poses are `params.eq_anchor1`, `eq_anchor2`,
    /// `eq_quat1`, `eq_quat2`, `eq_torquescale`.
    Weld {
        /// First body.
        body1: usize,
        /// Second body.
        body2: usize,
    },
    /// A joint follows another by `params.eq_polycoef`.
    Joint {
        /// The joint that follows.
        joint1: usize,
        /// The joint that leads.
        joint2: Option<usize>,
    },
    /// A tendon follows another by `params.eq_polycoef`.
    Tendon {
        /// The tendon that follows.
        tendon1: usize,
        /// The tendon that leads.
        tendon2: Option<usize>,
    },
}

/// An equality constraint.
#[derive(Clone, Debug)]
pub struct Equality {
    /// Name, possibly empty.
    pub name: String,
    /// What it holds.
    pub target: EqualityTarget,
    /// On in the initial state.
    pub active0: bool,
}

/// A geom pair that always collides; its parameters are in `params.pair_*`.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Name, possibly empty.
    pub name: String,
    /// The geoms, the one of smaller [`ShapeKind`] first.
    pub geoms: [usize; 2],
    /// Dimensions of the contact.
    pub condim: u32,
}

/// A stored state.
#[derive(Clone, Debug)]
pub struct Keyframe {
    /// Name, possibly empty.
    pub name: String,
    /// s.
    pub time: f64,
    /// (nq).
    pub qpos: Vec<f64>,
    /// (nv).
    pub qvel: Vec<f64>,
    /// (na).
    pub act: Vec<f64>,
    /// (nu).
    pub ctrl: Vec<f64>,
    /// (3 nmocap).
    pub mocap_pos: Vec<f64>,
    /// (4 nmocap).
    pub mocap_quat: Vec<f64>,
}

/// How velocity and position advance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Semi-implicit Euler, joint damping implicit.
    #[default]
    Euler,
    /// Euler, implicit in the derivatives of damping and actuation with respect to velocity.
    ImplicitFast,
    /// Fourth-order Runge–Kutta.
    Rk4,
}

/// Feature switches, all on by default (MuJoCo's disable flags, said positively).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flags {
    /// Any constraint at all.
    pub constraint: bool,
    /// Equality constraints.
    pub equality: bool,
    /// Dry friction.
    pub frictionloss: bool,
    /// Joint and tendon limits.
    pub limit: bool,
    /// Contacts.
    pub contact: bool,
    /// Springs.
    pub spring: bool,
    /// Dampers.
    pub damper: bool,
    /// Gravity.
    pub gravity: bool,
    /// Clamping of controls to their range.
    pub clampctrl: bool,
    /// Warm start of the solver.
    pub warmstart: bool,
    /// No contacts between a body and its parent.
    pub filterparent: bool,
    /// Actuation.
    pub actuation: bool,
    /// `solref` time constants at least twice the time step.
    pub refsafe: bool,
    /// Islands.
    pub island: bool,
    /// Euler integrates joint damping implicitly.
    pub eulerdamp: bool,
    /// Sensors.
    pub sensor: bool,
    /// Several contacts of a pair whose contacts MuJoCo finds by its general algorithm (see `clench_collide::multiccd_matters`);
    /// without it the deepest alone.
    pub multiccd: bool,
}

impl Default for Flags {
    fn default() -> Self {
        Flags {
            constraint: true,
            equality: true,
            frictionloss: true,
            limit: true,
            contact: true,
            spring: true,
            damper: true,
            gravity: true,
            clampctrl: true,
            warmstart: true,
            filterparent: true,
            actuation: true,
            refsafe: true,
            island: true,
            eulerdamp: true,
            sensor: true,
            multiccd: true,
        }
    }
}
