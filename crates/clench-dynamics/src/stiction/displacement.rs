//! The displacement of contacts from the stick reference of their pair.
//!
//! Let X be the pose of the second body in the frame of the first, X⁰ its stick reference, and p a contact point. The
//! point of the second body that is now at p was at X⁰ X⁻¹ p, so in the frame of the first body
//!
//! ```text
//! slides:  φ_i = t_i · (p − X⁰ X⁻¹ p)        spin, rolls:  φ = n · θ, t_i · θ,   exp(θ) = R R⁰ᵀ
//! ```

use super::pairs::{RelativePose, StickPair, Stiction};
use crate::contact::Contact;
use crate::model::Model;
use crate::stages::Positions;
use crate::state::State;
use clench_math::{Real, Vec3, kernel};

impl<T: Real> Stiction<T> {
    /// Finds the pairs of geoms that touch, reads their references from the state, and computes the displacements of
    /// all contacts. A pair without a reference sticks from now on.
    #[kernel]
    pub(crate) fn find(
        &mut self,
        model: &Model,
        state: &State<T>,
        pos: &Positions<T>,
        contacts: &[Contact<T>],
    ) {
        self.find_pairs(model, contacts);
        self.displacements.resize(contacts.len(), [T::ZERO; 5]);
        self.cursors.clear();
        self.cursors.resize(T::LANES, 0);
        for pair in &mut self.pairs {
            let present = present_pose(pos, pair.bodies);
            pair.reference = present;
            pair.read_reference(&state.stick_references, &mut self.cursors);
            pair.displace(pos, &present, contacts, &mut self.displacements);
        }
    }

    /// Finds the pairs of geoms that touch with friction.
    fn find_pairs(&mut self, model: &Model, contacts: &[Contact<T>]) {
        for (i, contact) in contacts.iter().enumerate() {
            if contact.dim == 1 {
                continue;
            }
            match self.pairs.last_mut() {
                Some(pair) if pair.geoms == contact.geoms => {
                    pair.contacts[1] = i + 1;
                    pair.active |= contact.active;
                }
                _ => self.pairs.push(StickPair {
                    geoms: contact.geoms,
                    bodies: contact.geoms.map(|geom| model.geoms[geom].body),
                    contacts: [i, i + 1],
                    active: contact.active,
                    reference: RelativePose::IDENTITY,
                    rotation: Vec3::ZERO,
                }),
            }
        }
    }
}

/// Returns the present pose of the second body in the frame of the first.
#[inline(always)]
pub(super) fn present_pose<T: Real>(pos: &Positions<T>, bodies: [usize; 2]) -> RelativePose<T> {
    let [first, second] = bodies;
    let between = pos.xpos[second] - pos.xpos[first];
    RelativePose {
        position: pos.xmat[first].transpose_mul(between),
        rotation: pos.xquat[first].conjugate() * pos.xquat[second],
    }
}

impl<T: Real> StickPair<T> {
    /// Computes the rotation since the reference and the displacements of the pair's contacts.
    #[inline(always)]
    fn displace(
        &mut self,
        pos: &Positions<T>,
        present: &RelativePose<T>,
        contacts: &[Contact<T>],
        displacements: &mut [[T; 5]],
    ) {
        let [first, second] = self.bodies;
        let (frame, reference) = (&pos.xmat[first], &self.reference);
        let since = present.rotation * reference.rotation.conjugate();
        // Twice the sine of half the angle. It is small, because references that roll are replaced.
        self.rotation = since.imaginary() * T::new(2.0).copysign(since.w);
        let rotation = *frame * self.rotation;
        for i in self.contacts() {
            let contact = &contacts[i];
            let local = pos.xmat[second].transpose_mul(contact.pos - pos.xpos[second]);
            let before = reference.position + reference.rotation.rotate(local);
            let slide = contact.pos - pos.xpos[first] - *frame * before;
            let [normal, t1, t2] = contact.frame.rows;
            displacements[i] = [
                t1.dot(slide),
                t2.dot(slide),
                normal.dot(rotation),
                t1.dot(rotation),
                t2.dot(rotation),
            ];
        }
    }
}
