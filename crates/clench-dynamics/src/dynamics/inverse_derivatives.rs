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
//!
//! The product of a row vector λ with the derivatives needs no pairs: one recursion sums λ_j s_j over the dofs j that
//! move a body, another λ_i I s_i over the dofs i below it.

use super::coriolis::{body_rate_columns, drifts};
use super::force_derivatives::ForceDerivatives;
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
    /// The sums of products (nbody).
    sums: Vec<Sums<T>>,
}

/// Sums over dofs, with the factors λ of a product.
#[derive(Clone, Copy, Debug)]
struct Sums<T> {
    /// Σ λ s of the dofs that move a body.
    motion: Motion<T>,
    /// Σ λ I s and Σ λ s · B of the dofs of a body and of all below it.
    momentum: Force<T>,
    along: Vec3<T>,
}

impl<T: Real> Sums<T> {
    const ZERO: Self = Sums {
        motion: Motion::ZERO,
        momentum: Force::ZERO,
        along: Vec3::ZERO,
    };
}

/// An acceleration, and the motion at which it acts.
#[derive(Clone, Copy, Debug)]
pub struct Accelerated<'a, T> {
    /// The acceleration of each dof (nv).
    pub qacc: &'a [T],
    /// The velocities of bodies and dofs; `None` for a system at rest without gravity, in which τ = M a.
    pub moving: Option<(&'a Velocities<T>, &'a [T])>,
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
            sums: vec![Sums::ZERO; model.nbody()],
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
        out: &mut ForceDerivatives<'_, T>,
    ) {
        self.recurse(model, params, pos, at);
        if let Some((vel, qvel)) = at.moving {
            drifts(model, pos, vel, qvel, &mut self.drift);
        }
        let vel = at.moving.map(|(vel, _)| vel);
        match out {
            ForceDerivatives::Product { factors, row } => {
                self.add_product(model, pos, vel, factors, row);
            }
            ForceDerivatives::Matrix { .. } | ForceDerivatives::List(_) => {
                for i in 0..model.nv {
                    self.add_entries(model, pos, vel, i, out);
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

    /// Returns the changes of the force on the bodies below a dof with its position, in a frame that moves with it, and
    /// with its velocity.
    #[inline(always)]
    fn force_changes(
        &self,
        model: &Model,
        pos: &Positions<T>,
        vel: Option<&Velocities<T>>,
        i: usize,
    ) -> [Force<T>; 2] {
        let (axis, b) = (pos.cdof[i], model.dofs[i].body);
        let inertia = pos.crb[b];
        let mut by_position = inertia * self.swing[i];
        let Some(vel) = vel else {
            return [by_position, Force::ZERO];
        };
        let mut by_velocity = inertia * self.drift[i];
        for (c, &rate) in self.rates[b].iter().enumerate() {
            by_position += rate * vel.cdof_dot[i].angular[c];
            by_velocity += rate * axis.angular[c];
        }
        [by_position, by_velocity]
    }

    /// Returns I s of a dof and, in motion, s · B.
    #[inline(always)]
    fn momentum(
        &self,
        model: &Model,
        pos: &Positions<T>,
        moves: bool,
        i: usize,
    ) -> (Force<T>, Vec3<T>) {
        let (axis, b) = (pos.cdof[i], model.dofs[i].body);
        let mut along = Vec3::ZERO;
        if moves {
            for (c, &rate) in self.rates[b].iter().enumerate() {
                along[c] = axis.dot(rate);
            }
        }
        (pos.crb[b] * axis, along)
    }

    /// Adds the entries of dof `i` with itself and the dofs above it.
    #[inline(always)]
    fn add_entries(
        &self,
        model: &Model,
        pos: &Positions<T>,
        vel: Option<&Velocities<T>>,
        i: usize,
        out: &mut ForceDerivatives<'_, T>,
    ) {
        let nv = model.nv;
        let [by_position, by_velocity] = self.force_changes(model, pos, vel, i);
        let (momentum, along) = self.momentum(model, pos, vel.is_some(), i);
        let fixed = by_position + pos.cdof[i].cross_force(self.cfrc[model.dofs[i].body]);
        let together = first_turning(model, i);
        for &j in model.tree.row(i) {
            let j = j as usize;
            let other = pos.cdof[j];
            let turned = if j >= together { by_position } else { fixed };
            out.add(j, i, other.dot(turned));
            if j != i {
                let carried = vel.map_or(T::ZERO, |vel| vel.cdof_dot[j].angular.dot(along));
                out.add(i, j, self.swing[j].dot(momentum) + carried);
            }
            if vel.is_some() {
                out.add(j, nv + i, other.dot(by_velocity));
                if j != i {
                    let by_other = self.drift[j].dot(momentum) + other.angular.dot(along);
                    out.add(i, nv + j, by_other);
                }
            }
        }
    }

    /// Adds the product of the factors with the derivatives.
    #[inline(always)]
    fn add_product(
        &mut self,
        model: &Model,
        pos: &Positions<T>,
        vel: Option<&Velocities<T>>,
        factors: &[T],
        product: &mut [T],
    ) {
        let nv = model.nv;
        for b in 1..model.nbody() {
            let body = &model.bodies[b];
            let mut sums = Sums {
                motion: self.sums[body.parent].motion,
                ..Sums::ZERO
            };
            // The part of the motion that turns together.
            let mut turning = Motion::ZERO;
            for i in body.dofs.clone() {
                let own = pos.cdof[i] * factors[i];
                turning = match first_turning(model, i) < i {
                    true => turning + own,
                    false => own,
                };
                sums.motion += own;
                let [by_position, by_velocity] = self.force_changes(model, pos, vel, i);
                let turned = pos.cdof[i].cross_force(self.cfrc[b]);
                product[i] += sums.motion.dot(by_position + turned) - turning.dot(turned);
                product[nv + i] += sums.motion.dot(by_velocity);
            }
            self.sums[b] = sums;
        }
        for b in (1..model.nbody()).rev() {
            let body = &model.bodies[b];
            let Sums {
                mut momentum,
                mut along,
                ..
            } = self.sums[b];
            for i in body.dofs.clone().rev() {
                product[i] += self.swing[i].dot(momentum);
                if let Some(vel) = vel {
                    product[i] += vel.cdof_dot[i].angular.dot(along);
                    let turned = pos.cdof[i].angular.dot(along);
                    product[nv + i] += self.drift[i].dot(momentum) + turned;
                }
                let (own, own_along) = self.momentum(model, pos, vel.is_some(), i);
                momentum += own * factors[i];
                along += own_along * factors[i];
            }
            if body.parent != 0 {
                let above = &mut self.sums[body.parent];
                above.momentum += momentum;
                above.along += along;
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
