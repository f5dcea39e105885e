//! The derivatives of inverse dynamics τ = M a + bias by positions and velocities (Carpentier & Mansard 2018; arranged
//! as by Echeandia & Wensing 2021).
//!
//! Motion along dof j, with axis s, moves all bodies below it as one rigid body. In a frame that moves with them, only
//! the velocity u and the acceleration w of what carries the joint change, by ṡ = u × s and by w × s:
//!
//! ```text
//! by q_j:   δv_b = ṡ    δa_b = w × s − ṡ × u + ṡ × v_b    δf_b = I_b (w × s − ṡ × u) + B_b ṡ
//! by v_j:   δf_b = I_b (ṡ − s × u′) + B_b s               B and u′ as in the module `coriolis`
//! ```
//!
//! Summed over the bodies below the later of two dofs, I and B give both entries of the pair. A dof above j is fixed in
//! the world: it also feels that the force F below j turns, s ×* F. The rotations of one ball or free joint all turn
//! together.

use super::coriolis::{body_rate_columns, drifts};
use crate::model::{JointKind, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Force, Motion, Real, Vec3, kernel};

/// Scratch memory of these derivatives.
#[derive(Clone, Debug)]
pub struct InverseDerivatives<T> {
    /// The columns of B, of each body and all below it, for the components of rotation: those of translation are zero
    /// (nbody).
    rates: Vec<[Force<T>; 3]>,
    /// ṡ − s × u′ of each dof (nv).
    drift: Vec<Motion<T>>,
    /// The acceleration of each body, gravity included (nbody).
    cacc: Vec<Motion<T>>,
    /// The force on each body and all below it (nbody).
    cfrc: Vec<Force<T>>,
    /// w × s − ṡ × u of each dof (nv).
    swing: Vec<Motion<T>>,
}

/// An acceleration, and the motion at which it acts.
#[derive(Clone, Copy, Debug)]
pub struct Accelerated<'a, T> {
    /// The acceleration of each dof (nv).
    pub qacc: &'a [T],
    /// The velocities of bodies and dofs; `None` for a system at rest without gravity, in which τ = M a.
    pub moving: Option<(&'a Velocities<T>, &'a [T])>,
}

/// A matrix to which derivatives are added, one row for each force, one column for each position, then one for each
/// velocity.
#[derive(Debug)]
pub struct Columns<'a, T> {
    /// The numbers, row after row.
    pub values: &'a mut [T],
    /// The distance of two rows.
    pub width: usize,
}

impl<T: Real> Columns<'_, T> {
    /// Adds to an entry.
    #[inline(always)]
    pub fn add(&mut self, row: usize, column: usize, x: T) {
        self.values[row * self.width + column] += x;
    }
}

impl<T: Real> InverseDerivatives<T> {
    /// Allocates memory for a model.
    pub fn new(model: &Model) -> Self {
        InverseDerivatives {
            rates: vec![[Force::ZERO; 3]; model.nbody()],
            drift: vec![Motion::ZERO; model.nv],
            cacc: vec![Motion::ZERO; model.nbody()],
            cfrc: vec![Force::ZERO; model.nbody()],
            swing: vec![Motion::ZERO; model.nv],
        }
    }

    /// Adds ∂τ/∂q and, in motion, ∂τ/∂v, without the inertia of tendons. Armatures do not contribute.
    #[kernel]
    pub fn add(
        &mut self,
        model: &Model,
        params: &Params<T>,
        pos: &Positions<T>,
        at: Accelerated<'_, T>,
        out: &mut Columns<'_, T>,
    ) {
        self.recurse(model, params, pos, at);
        match at.moving {
            Some((vel, qvel)) => {
                drifts(model, pos, vel, qvel, &mut self.drift);
                for i in 0..model.nv {
                    self.add_moving(model, pos, vel, i, out);
                }
            }
            None => {
                for i in 0..model.nv {
                    self.add_resting(model, pos, i, out);
                }
            }
        }
    }

    /// Returns the accelerations of bodies, gravity included, of the last call of [`add`](Self::add) (nbody).
    pub fn accelerations(&self) -> &[Motion<T>] {
        &self.cacc
    }

    /// Returns w × s − ṡ × u, then ṡ − s × u′ of a dof, likewise, in motion.
    pub fn changes(&self, dof: usize) -> [Motion<T>; 2] {
        [self.swing[dof], self.drift[dof]]
    }

    /// Adds the entries of dof `i` with itself and the dofs above it.
    #[inline(always)]
    fn add_moving(
        &self,
        model: &Model,
        pos: &Positions<T>,
        vel: &Velocities<T>,
        i: usize,
        out: &mut Columns<'_, T>,
    ) {
        let (nv, axis, b) = (model.nv, pos.cdof[i], model.dofs[i].body);
        let (inertia, rates) = (pos.crb[b], &self.rates[b]);
        let momentum = inertia * axis;
        // The change of the force below i with its position and velocity, and the force along i for each component of
        // another axis.
        let (mut by_position, mut by_velocity) = (inertia * self.swing[i], inertia * self.drift[i]);
        let mut along = Vec3::ZERO;
        for c in 0..3 {
            by_position += rates[c] * vel.cdof_dot[i].angular[c];
            by_velocity += rates[c] * axis.angular[c];
            along[c] = axis.dot(rates[c]);
        }
        let fixed = by_position + axis.cross_force(self.cfrc[b]);
        let together = first_turning(model, i);
        for &j in model.tree.row(i) {
            let j = j as usize;
            let other = pos.cdof[j];
            let turned = if j >= together { by_position } else { fixed };
            out.add(j, i, other.dot(turned));
            out.add(j, nv + i, other.dot(by_velocity));
            if j != i {
                let by_other = self.swing[j].dot(momentum) + vel.cdof_dot[j].angular.dot(along);
                out.add(i, j, by_other);
                out.add(
                    i,
                    nv + j,
                    self.drift[j].dot(momentum) + other.angular.dot(along),
                );
            }
        }
    }

    /// Does the same without velocities.
    #[inline(always)]
    fn add_resting(&self, model: &Model, pos: &Positions<T>, i: usize, out: &mut Columns<'_, T>) {
        let (axis, b) = (pos.cdof[i], model.dofs[i].body);
        let momentum = pos.crb[b] * axis;
        let change = pos.crb[b] * self.swing[i];
        let fixed = change + axis.cross_force(self.cfrc[b]);
        let together = first_turning(model, i);
        for &j in model.tree.row(i) {
            let j = j as usize;
            let turned = if j >= together { change } else { fixed };
            out.add(j, i, pos.cdof[j].dot(turned));
            if j != i {
                out.add(i, j, self.swing[j].dot(momentum));
            }
        }
    }

    /// Computes accelerations, forces, their rates, and the changes of accelerations.
    #[inline(always)]
    fn recurse(
        &mut self,
        model: &Model,
        params: &Params<T>,
        pos: &Positions<T>,
        at: Accelerated<'_, T>,
    ) {
        let gravity = match at.moving {
            Some(_) if model.flags.gravity => params.gravity,
            _ => Vec3::ZERO,
        };
        self.cacc[0] = Motion::new(Vec3::ZERO, -gravity);
        for b in 1..model.nbody() {
            let body = &model.bodies[b];
            let mut cacc = self.cacc[body.parent];
            let mut cvel = at
                .moving
                .map_or(Motion::ZERO, |(vel, _)| vel.cvel[body.parent]);
            for joint in &model.joints[body.joints.clone()] {
                let (start, end) = (joint.dof, joint.dof + joint.kind.nv());
                let turning = first_turning(model, end - 1);
                for dofs in [start..turning, turning..end] {
                    for i in dofs.clone() {
                        let drift = at.moving.map_or(Motion::ZERO, |(vel, _)| vel.cdof_dot[i]);
                        self.swing[i] = cacc.cross(pos.cdof[i]) - drift.cross(cvel);
                    }
                    for i in dofs {
                        cacc += pos.cdof[i] * at.qacc[i];
                        if let Some((vel, qvel)) = at.moving {
                            cacc += vel.cdof_dot[i] * qvel[i];
                            cvel += pos.cdof[i] * qvel[i];
                        }
                    }
                }
            }
            self.cacc[b] = cacc;
            let mut force = pos.cinert[b] * cacc;
            if let Some((vel, _)) = at.moving {
                let v = vel.cvel[b];
                force += v.cross_force(pos.cinert[b] * v);
                self.rates[b] = body_rate_columns(&pos.cinert[b], v);
            }
            self.cfrc[b] = force;
        }
        for b in (1..model.nbody()).rev() {
            let (parent, force, rates) = (model.bodies[b].parent, self.cfrc[b], self.rates[b]);
            if parent != 0 {
                self.cfrc[parent] += force;
                if at.moving.is_some() {
                    for (sum, rate) in self.rates[parent].iter_mut().zip(rates) {
                        *sum += rate;
                    }
                }
            }
        }
    }
}

/// Returns the first of the dofs of a joint whose axes turn together with that of dof `i`, or `i` itself.
#[inline(always)]
pub fn first_turning(model: &Model, i: usize) -> usize {
    let joint = &model.joints[model.dofs[i].joint];
    match joint.kind {
        JointKind::Ball => joint.dof,
        JointKind::Free if i >= joint.dof + 3 => joint.dof + 3,
        JointKind::Free | JointKind::Slide | JointKind::Hinge => i,
    }
}
