//! Transmissions to contacts, which attract a body to the objects that it touches.
//!
//! All contacts of the body, including those within the gap that carry no force yet, share the force equally. Along a
//! contact's normal n, from its first body to the second, the bodies separate with n · (v₂ − v₁): the moment arms are
//! minus its mean over the contacts, and zero without contacts. Gears have no effect. As in MuJoCo, a contact within
//! one rigid body, possible for an explicit pair, has no share unless it is within the gap.

use crate::contact::Contact;
use crate::dynamics::chains::{BodyPoint, Chains, Side};
use crate::model::{Model, Transmission};
use crate::stages::Positions;
use clench_math::{Mask, Real, kernel};

/// Computes the moment arms of all actuators on detected contacts.
#[kernel]
pub fn adhesion<T: Real>(model: &Model, contacts: &[Contact<T>], pos: &mut Positions<T>) {
    let mut moments = std::mem::take(&mut pos.actuator_moment);
    for actuator in &model.actuators {
        if let Transmission::Body(body) = actuator.transmission {
            let row = &mut moments[model.actuator_dofs.range(actuator.outputs.start)];
            body_arms(model, contacts, pos, body, row);
        }
    }
    pos.actuator_moment = moments;
}

/// Computes the moment arms, over all dofs of the model, of an actuator on the contacts of `body`.
#[inline(always)]
fn body_arms<T: Real>(
    model: &Model,
    contacts: &[Contact<T>],
    pos: &Positions<T>,
    body: usize,
    row: &mut [T],
) {
    row.fill(T::ZERO);
    let mut count = T::ZERO;
    for contact in contacts {
        let bodies = contact.geoms.map(|geom| model.geoms[geom].body);
        if !bodies.contains(&body) {
            continue;
        }
        let chains = Chains::new(model, bodies).without_common();
        let nothing_moves = chains.parts().iter().all(|(part, _)| part.is_empty());
        let shares = contact.active & !(contact.acts() & T::Mask::splat(nothing_moves));
        let share = T::select(shares, T::ONE, T::ZERO);
        count += share;
        let normal = contact.frame.rows[0] * share;
        for (part, side) in chains.parts() {
            let (body, along) = match side {
                Side::Second => (bodies[1], -normal),
                Side::First | Side::Both => (bodies[0], normal),
            };
            let offset = BodyPoint::new(model, pos, body, contact.pos).offset;
            for &dof in part {
                let dof = dof as usize;
                row[dof] += along.dot(pos.cdof[dof].velocity_at(offset));
            }
        }
    }
    let touched = count.gt(T::ZERO);
    let mean = T::ONE / T::select(touched, count, T::ONE);
    row.iter_mut().for_each(|arm| *arm *= mean);
}
