//! Passive forces: springs, dampers, gravity compensation, fluid forces, and adhesive contacts.

use crate::contact::Contact;
use crate::dynamics::fluid::fluid_forces;
use crate::dynamics::polynomial::Polynomial;
use crate::dynamics::project::{force_at, project_forces};
use crate::dynamics::reflected::{dof_damper, tendon_damper};
use crate::dynamics::spring::{
    JointElongation, joint_elongation, joint_spring, tendon_elongation, tendon_spring,
};
use crate::dynamics::tendon::add_tendon_force;
use crate::model::{Model, Params};
use crate::part::Part;
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Force, Mask, Real, Vec3, kernel};

/// Computes `qfrc_spring`, `qfrc_damper`, `qfrc_gravcomp`, `qfrc_fluid`, `qfrc_adhesion` and their sum `qfrc_passive`
/// of some parts, which include all dofs of tendons. Gravity compensation of joints with `actgravcomp` belongs to the
/// actuators. As in MuJoCo, disabling springs and dampers disables all passive forces.
#[kernel]
pub fn passive_forces<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    (pos, vel): (&Positions<T>, &Velocities<T>),
    state: &State<T>,
    contacts: &[Contact<T>],
    force: &mut Forces<T>,
) {
    for qfrc in [
        &mut force.qfrc_spring,
        &mut force.qfrc_damper,
        &mut force.qfrc_gravcomp,
        &mut force.qfrc_fluid,
        &mut force.qfrc_adhesion,
        &mut force.qfrc_passive,
    ] {
        for part in parts {
            qfrc[part.dofs.clone()].fill(T::ZERO);
        }
    }
    if !model.flags.spring && !model.flags.damper {
        return;
    }
    if model.flags.spring {
        springs(model, params, parts, pos, state, force);
    }
    if model.flags.damper {
        let qfrc = &mut force.qfrc_damper;
        dampers(model, params, parts, (pos, vel), &state.qvel, qfrc);
    }
    gravity_compensation(model, params, parts, pos, force);
    fluid_forces(model, params, parts, pos, vel, force);
    adhesion(model, parts, pos, contacts, force);
    for part in parts {
        for i in part.dofs.clone() {
            let mut sum = force.qfrc_spring[i] + force.qfrc_damper[i] + force.qfrc_fluid[i];
            sum += force.qfrc_adhesion[i];
            if !model.joints[model.dofs[i].joint].actgravcomp {
                sum += force.qfrc_gravcomp[i];
            }
            force.qfrc_passive[i] = sum;
        }
    }
}

#[inline(always)]
fn springs<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &Positions<T>,
    state: &State<T>,
    force: &mut Forces<T>,
) {
    let qfrc = &mut force.qfrc_spring;
    for j in parts.iter().flat_map(|part| part.joints.clone()) {
        let spring = joint_spring(params, j);
        let qfrc = &mut qfrc[model.joints[j].dof..];
        match joint_elongation(model, params, state, j) {
            None => {}
            Some(JointElongation::Scalar(x)) => qfrc[0] += -x * spring.stiffness(x),
            Some(JointElongation::Rotation(rotation)) => pull_back(&spring, rotation, qfrc),
            Some(JointElongation::Pose(shift, rotation)) => {
                pull_back(&spring, shift, qfrc);
                pull_back(&spring, rotation, &mut qfrc[3..]);
            }
        }
    }
    for t in 0..model.tendons.len() {
        let elongation = tendon_elongation(model, params, &state.plastic, t, pos.ten_length[t]);
        force.ten_spring[t] = -elongation * tendon_spring(params, t).stiffness(elongation);
        add_tendon_force(model, pos, t, force.ten_spring[t], qfrc);
    }
}

/// Adds the force of a spring with the elongation `elongation`.
#[inline(always)]
fn pull_back<T: Real>(spring: &Polynomial<T>, elongation: Vec3<T>, qfrc: &mut [T]) {
    let stiffness = if spring.is_curved().any() {
        spring.stiffness(elongation.norm())
    } else {
        spring.linear
    };
    for (qfrc, x) in qfrc.iter_mut().zip(elongation.to_array()) {
        *qfrc += -x * stiffness;
    }
}

#[inline(always)]
fn dampers<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    (pos, vel): (&Positions<T>, &Velocities<T>),
    qvel: &[T],
    qfrc: &mut [T],
) {
    for part in parts {
        for i in part.dofs.clone() {
            let v = qvel[i];
            qfrc[i] = -v * dof_damper(model, params, i).damping(v);
        }
    }
    for t in 0..model.tendons.len() {
        let velocity = vel.ten_velocity[t];
        let force = -velocity * tendon_damper(model, params, t).damping(velocity);
        add_tendon_force(model, pos, t, force, qfrc);
    }
}

/// Adds the adhesive forces of contacts, which pull the bodies together against the constraint forces.
#[inline(always)]
fn adhesion<T: Real>(
    model: &Model,
    parts: &[Part],
    pos: &Positions<T>,
    contacts: &[Contact<T>],
    force: &mut Forces<T>,
) {
    let adheres = |contact: &Contact<T>| !contact.adhesion.eq(T::ZERO).all();
    if !contacts.iter().any(adheres) {
        return;
    }
    force.cfrc_body.fill(Force::ZERO);
    for contact in contacts {
        let pull = T::select(contact.acts(), contact.adhesion, T::ZERO);
        for (geom, sign) in contact.geoms.into_iter().zip([pull, -pull]) {
            let (b, along) = (model.geoms[geom].body, contact.frame.rows[0] * sign);
            force.cfrc_body[b] += force_at(model, pos, b, contact.pos, along, Vec3::ZERO);
        }
    }
    force.cfrc_body[0] = Force::ZERO;
    let Forces {
        cfrc_body,
        qfrc_adhesion,
        ..
    } = force;
    project_forces(model, parts, pos, cfrc_body, qfrc_adhesion);
}

/// Supports the share `gravcomp` of each body's weight at its centre of mass. As in MuJoCo, negative shares, which add
/// weight, apply only if some body's share is positive.
#[inline(always)]
fn gravity_compensation<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &Positions<T>,
    force: &mut Forces<T>,
) {
    let mut lifted = T::Mask::splat(false);
    for share in &params.body_gravcomp {
        // A share of zero that has a derivative is one that may become positive.
        lifted |= share.ge(T::ZERO) & !share.eq(T::ZERO);
    }
    if !model.flags.gravity || !lifted.any() {
        return;
    }
    for b in parts.iter().flat_map(|part| part.bodies.clone()) {
        let share = T::select(lifted, params.body_gravcomp[b], T::ZERO);
        let lift = params.gravity * -(params.body_mass[b] * share);
        force.cfrc_body[b] = force_at(model, pos, b, pos.xipos[b], lift, Vec3::ZERO);
    }
    force.cfrc_body[0] = Force::ZERO;
    let Forces {
        cfrc_body,
        qfrc_gravcomp,
        ..
    } = force;
    project_forces(model, parts, pos, cfrc_body, qfrc_gravcomp);
}
