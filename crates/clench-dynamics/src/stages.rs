//! The results of the stages before the constraints.

use crate::model::Model;
use clench_math::{Force, Inertia, Mat3, Motion, Quat, Real, Vec3};

/// Returns `count` copies of an element. Not inlined: workspaces have some two hundred such arrays in every number
/// type.
#[inline(never)]
pub fn filled<X: Copy>(element: X, count: usize) -> Vec<X> {
    vec![element; count]
}

/// Poses, and the quantities that depend only on positions.
#[derive(Clone, Debug, Default)]
pub struct Positions<T> {
    /// Body positions (nbody).
    pub xpos: Vec<Vec3<T>>,
    /// Body orientations.
    pub xquat: Vec<Quat<T>>,
    /// Body orientations as matrices.
    pub xmat: Vec<Mat3<T>>,
    /// Centres of mass.
    pub xipos: Vec<Vec3<T>>,
    /// Orientations of inertial frames.
    pub ximat: Vec<Mat3<T>>,
    /// Rotation by each joint (njnt).
    pub(crate) jnt_rotation: Vec<Quat<T>>,
    /// Joint anchors (njnt).
    pub xanchor: Vec<Vec3<T>>,
    /// Joint axes.
    pub xaxis: Vec<Vec3<T>>,
    /// Geom positions (ngeom).
    pub geom_xpos: Vec<Vec3<T>>,
    /// Geom orientations.
    pub geom_xmat: Vec<Mat3<T>>,
    /// Site positions (nsite).
    pub site_xpos: Vec<Vec3<T>>,
    /// Site orientations.
    pub site_xmat: Vec<Mat3<T>>,
    /// Centre of mass of each body and its descendants (nbody). That of a body's `root` is the reference point of all
    /// spatial vectors of its tree.
    pub subtree_com: Vec<Vec3<T>>,
    /// `subtree_com` times the subtree mass (nbody).
    pub(crate) subtree_moment: Vec<Vec3<T>>,
    /// Motion of each dof at unit velocity (nv).
    pub cdof: Vec<Motion<T>>,
    /// Inertia of each body (nbody).
    pub cinert: Vec<Inertia<T>>,
    /// Inertia of each body and its descendants (nbody).
    pub crb: Vec<Inertia<T>>,
    /// Tendon lengths (ntendon).
    pub ten_length: Vec<T>,
    /// ∂length/∂q of all tendons, row after row, in the pattern `Model::tendon_dofs`.
    pub ten_jacobian: Vec<T>,
    /// Actuator lengths (nout).
    pub actuator_length: Vec<T>,
    /// Moment arms ∂length/∂q of all actuators, row after row, in the pattern `Model::actuator_dofs`.
    pub actuator_moment: Vec<T>,
}

impl<T: Real> Positions<T> {
    /// Allocates the arrays of a model, with every pose at the origin.
    pub fn new(model: &Model) -> Self {
        let (nbody, nv, nout) = (model.nbody(), model.nv, model.nout());
        let (nj, ng, ns) = (model.joints.len(), model.geoms.len(), model.sites.len());
        let zeros = |n: usize| filled(T::ZERO, n);
        let points = |n: usize| filled(Vec3::ZERO, n);
        let frames = |n: usize| filled(Mat3::IDENTITY, n);
        Positions {
            xpos: points(nbody),
            xquat: filled(Quat::IDENTITY, nbody),
            xmat: frames(nbody),
            xipos: points(nbody),
            ximat: frames(nbody),
            jnt_rotation: filled(Quat::IDENTITY, nj),
            xanchor: points(nj),
            xaxis: points(nj),
            geom_xpos: points(ng),
            geom_xmat: frames(ng),
            site_xpos: points(ns),
            site_xmat: frames(ns),
            subtree_com: points(nbody),
            subtree_moment: points(nbody),
            cdof: filled(Motion::ZERO, nv),
            cinert: filled(Inertia::ZERO, nbody),
            crb: filled(Inertia::ZERO, nbody),
            ten_length: zeros(model.tendons.len()),
            ten_jacobian: zeros(model.tendon_dofs.len()),
            actuator_length: zeros(nout),
            actuator_moment: zeros(model.actuator_dofs.len()),
        }
    }
}

/// Lengths and gradients of tendons, stored as in [`Positions`].
#[derive(Clone, Copy, Debug)]
pub struct Lengths<'a, T> {
    /// Lengths (ntendon).
    pub length: &'a [T],
    /// The gradients, entry after entry.
    pub jacobian: &'a [T],
}

impl<'a, T: Real> Lengths<'a, T> {
    /// Returns the lengths at a pose.
    pub fn of(pos: &'a Positions<T>) -> Self {
        Lengths {
            length: &pos.ten_length,
            jacobian: &pos.ten_jacobian,
        }
    }
}

/// The quantities that depend on velocities.
#[derive(Clone, Debug, Default)]
pub struct Velocities<T> {
    /// Body velocities (nbody).
    pub cvel: Vec<Motion<T>>,
    /// Rate of change of `cdof` (nv).
    pub cdof_dot: Vec<Motion<T>>,
    /// Tendon velocities (ntendon).
    pub ten_velocity: Vec<T>,
    /// Actuator velocities (nout).
    pub actuator_velocity: Vec<T>,
}

/// Forces along dofs (nv each) and of actuators.
#[derive(Clone, Debug, Default)]
pub struct Forces<T> {
    /// Coriolis, centrifugal and gravity forces: on the left side of the equation of motion.
    pub qfrc_bias: Vec<T>,
    /// Spring forces.
    pub qfrc_spring: Vec<T>,
    /// Damper forces.
    pub qfrc_damper: Vec<T>,
    /// Forces of springs along tendons (ntendon).
    pub ten_spring: Vec<T>,
    /// Accelerations of the lengths of spatial tendons with inertia at zero dof acceleration, J̇ v (ntendon).
    pub ten_bias: Vec<T>,
    /// Gravity compensation.
    pub qfrc_gravcomp: Vec<T>,
    /// Fluid forces.
    pub qfrc_fluid: Vec<T>,
    /// Forces of adhesive contacts.
    pub qfrc_adhesion: Vec<T>,
    /// The sum of the passive forces.
    pub qfrc_passive: Vec<T>,
    /// Actuator forces.
    pub qfrc_actuator: Vec<T>,
    /// The sum of all forces except constraint forces: passive + actuator + applied − bias.
    pub qfrc_smooth: Vec<T>,
    /// Forces of actuators (nout): one each, but three of an orientation servo.
    pub actuator_force: Vec<T>,
    /// Total force of the actuators of each tendon with a force limit, after all limits, without cogging and friction
    /// of motors (ntendon).
    pub ten_actuator_force: Vec<T>,
    /// The effective controls: delayed, and clamped to their ranges (nu).
    pub ctrl: Vec<T>,
    /// Rate of change of each activation (na).
    pub act_dot: Vec<T>,
    /// Scratch of the bias forces: body accelerations (nbody).
    pub cacc: Vec<Motion<T>>,
    /// Scratch of the bias forces: body forces (nbody).
    pub cfrc_body: Vec<Force<T>>,
}
