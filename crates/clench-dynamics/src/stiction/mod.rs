//! Contacts and dry friction that stick (the option `stiction`).
//!
//! Without it, friction rows are dampers: a steady load f slips at the steady velocity R f / b. With it, they are
//! springs too:
//!
//! ```text
//! aref = −b v − k d φ        at rest the displacement φ = R f / (k d) carries the load f
//! ```
//!
//! φ is how far the material points of a contact have moved apart in the tangent plane since they stuck
//! (`displacement`). The relative pose at that time is the *stick reference* of a pair of geoms, one for all its
//! contacts, so that φ does not depend on which points detection returns. Dry friction of a dof or tendon has a
//! displacement of its own (`friction`). After a solve, `return_mapping` drags a reference so far that no contact stores
//! more than it can carry. All of these are state (`references`) and constant within a step, so the problem remains
//! convex.
//!
//! `docs/contact.md` shows the effects, `docs/mathematics.md` derives steady state and stored energy.

mod displacement;
mod friction;
mod references;
mod return_mapping;

pub(crate) use friction::advance_friction;
pub(crate) use return_mapping::drag;

use crate::state::kind::StickReference;
use clench_math::{Quat, Real, Vec3};
use return_mapping::LoadedContact;
use std::ops::Range;

/// The stick references of a step and the displacements from them.
#[derive(Clone, Debug, Default)]
pub struct Stiction<T: Real> {
    /// The pairs of geoms that touch with friction, in the order of the contacts.
    pairs: Vec<StickPair<T>>,
    /// The displacements of each contact along its friction rows: two slides, m; spin and two rolls, rad.
    displacements: Vec<[T; 5]>,
    /// The change of aref per displacement, for each row of the problem, 1/s².
    pub(crate) slopes: Vec<T>,
    /// Scratch: the contacts of a pair that carry a load.
    loaded: Vec<LoadedContact<T>>,
}

impl<T: Real> Stiction<T> {
    /// Removes all pairs and retains their memory.
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
        self.displacements.clear();
        self.slopes.clear();
    }

    /// Returns the displacements of a contact of the workspace along its friction rows: two slides, m; spin and two
    /// rolls, rad. Zero without the option `stiction`.
    #[inline(always)]
    pub fn displacement(&self, contact: usize) -> [T; 5] {
        let found = self.displacements.get(contact);
        found.copied().unwrap_or([T::ZERO; 5])
    }
}

/// A pair of geoms that touch.
#[derive(Clone, Copy, Debug)]
struct StickPair<T: Real> {
    geoms: [usize; 2],
    bodies: [usize; 2],
    /// The first of its contacts, which are consecutive, and the one after the last.
    contacts: [usize; 2],
    /// The lanes in which it touches, and after the solve those in which it carries a load.
    active: T::Mask,
    /// The stick reference.
    reference: RelativePose<T>,
    /// The rotation of the second body relative to the first since the reference, in the frame of the first, rad.
    rotation: Vec3<T>,
}

impl<T: Real> StickPair<T> {
    fn contacts(&self) -> Range<usize> {
        self.contacts[0]..self.contacts[1]
    }
}

/// The pose of a body in the frame of another.
#[derive(Clone, Copy, Debug)]
struct RelativePose<T> {
    position: Vec3<T>,
    rotation: Quat<T>,
}

impl<T: Real> RelativePose<T> {
    const IDENTITY: Self = RelativePose {
        position: Vec3::ZERO,
        rotation: Quat::IDENTITY,
    };

    #[inline(always)]
    fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        RelativePose {
            position: Vec3::select(mask, yes.position, no.position),
            rotation: Quat::select(mask, yes.rotation, no.rotation),
        }
    }
}
