//! The velocity derivatives of bias forces: ∂bias/∂v, in the pattern of the mass matrix, not symmetric.
//!
//! A unit increase of the velocity of dof j, with axis s, moves every body b below it. The change of its force I a + v
//! ×* I v is linear in s and in the change of its acceleration (Featherstone 2008, §5.3; arrangement by Echeandia &
//! Wensing 2021):
//!
//! ```text
//! δv = s     δa = ṡ + s × (v_b − u),  u the velocity of the chain just after the joint
//! δf_b = B_b s + I_b (ṡ − s × u)      B_b x = I_b (x × v_b) + x ×* I_b v_b + v_b ×* I_b x
//! ```
//!
//! The part of the derivative of fluid forces that is not symmetric is added to B, since it has the same entries.
//!
//! Summed over the bodies below the later of two dofs i and j, B and I give both entries of the pair.

use crate::dynamics::ellipsoid::{FluidForces, ellipsoid_rates};
use crate::dynamics::fluid::{fluid_acts, symmetric_and_skew};
use crate::model::{JointKind, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Force, Inertia, Motion, Real, kernel};
use clench_solver::TreeLu;

/// Scratch memory of these derivatives; empty for models whose integrator does not use them.
#[derive(Clone, Debug, Default)]
pub struct Coriolis<T> {
    /// The columns of B, of each body and all below it (nbody).
    rates: Vec<[Force<T>; 6]>,
    /// ṡ − s × u of each dof (nv).
    drift: Vec<Motion<T>>,
}

impl<T: Real> Coriolis<T> {
    /// Allocates memory for a model.
    pub fn new(model: &Model) -> Self {
        Coriolis {
            rates: vec![[Force::ZERO; 6]; model.nbody()],
            drift: vec![Motion::ZERO; model.nv],
        }
    }
}

/// Computes `matrix += scale · ∂(bias − fluid)/∂v`, with only the non-symmetric part of the fluid forces.
#[kernel]
pub fn add_bias_derivatives<T: Real>(
    model: &Model,
    params: &Params<T>,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    qvel: &[T],
    scale: T,
    scratch: &mut Coriolis<T>,
    matrix: &mut TreeLu<T>,
) {
    let Coriolis { rates, drift } = scratch;
    sum_rates(model, params, pos, vel, rates);
    drifts(model, pos, vel, qvel, drift);
    for (i, dof) in model.dofs.iter().enumerate() {
        let (axis, rate) = (pos.cdof[i], &rates[dof.body]);
        let momentum = pos.crb[dof.body] * axis;
        // The change of the force below i with dof i, and the force along i for each component of another axis.
        let mut change = pos.crb[dof.body] * drift[i];
        let mut along = [T::ZERO; 6];
        for (c, x) in axis.to_array().into_iter().enumerate() {
            change += rate[c] * x;
            along[c] = axis.dot(rate[c]);
        }
        let (row, column) = matrix.dof_mut(&model.tree, i);
        for (k, &j) in model.tree.row(i).iter().enumerate() {
            let other = pos.cdof[j as usize];
            let mut entry = drift[j as usize].dot(momentum);
            for (c, x) in other.to_array().into_iter().enumerate() {
                entry += along[c] * x;
            }
            row[k] += scale * entry;
            column[k] += scale * other.dot(change);
        }
    }
}

/// Computes B of each body, then of each body and all below it.
#[inline(always)]
fn sum_rates<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    rates: &mut [[Force<T>; 6]],
) {
    for (b, rate) in rates.iter_mut().enumerate() {
        *rate = body_rate(&pos.cinert[b], vel.cvel[b]);
    }
    if fluid_acts(model, params) {
        for b in (1..model.nbody()).filter(|&b| model.bodies[b].fluid_ellipsoids) {
            let all = ellipsoid_rates(model, params, (pos, vel), b, FluidForces::All);
            let [_, skew] = symmetric_and_skew(all);
            for (sum, column) in rates[b].iter_mut().zip(skew) {
                *sum -= column;
            }
        }
    }
    for b in (1..model.nbody()).rev() {
        let (parent, own) = (model.bodies[b].parent, rates[b]);
        if parent != 0 {
            for (sum, column) in rates[parent].iter_mut().zip(own) {
                *sum += column;
            }
        }
    }
}

/// Computes the columns of B of one body.
#[inline(always)]
fn body_rate<T: Real>(inertia: &Inertia<T>, velocity: Motion<T>) -> [Force<T>; 6] {
    body_rate_columns(inertia, velocity)
}

/// Computes the first columns of B of one body.
#[inline(always)]
pub(super) fn body_rate_columns<T: Real, const COUNT: usize>(
    inertia: &Inertia<T>,
    velocity: Motion<T>,
) -> [Force<T>; COUNT] {
    let momentum = *inertia * velocity;
    let mut columns = [Force::ZERO; COUNT];
    for (c, column) in columns.iter_mut().enumerate() {
        let x = Motion::component(c);
        *column = *inertia * x.cross(velocity)
            + x.cross_force(momentum)
            + velocity.cross_force(*inertia * x);
    }
    columns
}

/// Computes ṡ − s × u of each dof. The axes of a ball joint and of a free joint's rotations turn with the whole joint.
#[inline(always)]
pub(super) fn drifts<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    qvel: &[T],
    drift: &mut [Motion<T>],
) {
    for body in model.bodies.iter().skip(1) {
        let mut carried = vel.cvel[body.parent];
        for joint in &model.joints[body.joints.clone()] {
            let (start, end) = (joint.dof, joint.dof + joint.kind.nv());
            let rotations = match joint.kind {
                JointKind::Free => start + 3,
                JointKind::Ball | JointKind::Slide | JointKind::Hinge => start,
            };
            for dofs in [start..rotations, rotations..end] {
                for i in dofs.clone() {
                    carried += pos.cdof[i] * qvel[i];
                }
                for i in dofs {
                    drift[i] = vel.cdof_dot[i] - pos.cdof[i].cross(carried);
                }
            }
        }
    }
}
