//! The data of stiction in a step: the pairs of geoms that touch, their references and displacements.

use clench_math::{Quat, Real, Vec3};
use std::ops::Range;

/// The stick references of a step and the displacements from them.
#[derive(Clone, Debug, Default)]
pub struct Stiction<T: Real> {
    /// The pairs of geoms that touch with friction, in the order of the contacts.
    pub(super) pairs: Vec<StickPair<T>>,
    /// The displacements of each contact along its friction rows: two slides, m; spin and two rolls, rad.
    pub(super) displacements: Vec<[T; 5]>,
    /// The change of aref per displacement, for each row of the problem, 1/s².
    pub(crate) slopes: Vec<T>,
    /// Scratch: the place in the list of references after that of the last pair, for each lane.
    pub(super) cursors: Vec<usize>,
    /// Scratch: the contacts of a pair that carry a load.
    pub(super) loaded: Vec<LoadedContact<T>>,
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
pub(super) struct StickPair<T: Real> {
    pub(super) geoms: [usize; 2],
    pub(super) bodies: [usize; 2],
    /// The first of its contacts, which are consecutive, and the one after the last.
    pub(super) contacts: [usize; 2],
    /// The lanes in which it touches, and after the solve those in which it carries a load.
    pub(super) active: T::Mask,
    /// The stick reference.
    pub(super) reference: RelativePose<T>,
    /// The rotation of the second body relative to the first since the reference, in the frame of the first, rad.
    pub(super) rotation: Vec3<T>,
}

impl<T: Real> StickPair<T> {
    pub(super) fn contacts(&self) -> Range<usize> {
        self.contacts[0]..self.contacts[1]
    }
}

/// The pose of a body in the frame of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativePose<T> {
    pub(super) position: Vec3<T>,
    pub(super) rotation: Quat<T>,
}

impl<T: Real> RelativePose<T> {
    pub(super) const IDENTITY: Self = RelativePose {
        position: Vec3::ZERO,
        rotation: Quat::IDENTITY,
    };

    #[inline(always)]
    pub(super) fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        RelativePose {
            position: Vec3::select(mask, yes.position, no.position),
            rotation: Quat::select(mask, yes.rotation, no.rotation),
        }
    }
}

/// A contact that carries a load in some lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadedContact<T> {
    /// Its index in the workspace.
    pub(super) index: usize,
    /// The normal force, N; zero in the other lanes.
    pub(super) force: T,
    /// The friction that its spring requires, in units of normal force, N: e of `return_mapping`.
    pub(super) demand: T,
    /// The change of that by its first slide, N/m: κ of `return_mapping`.
    pub(super) stiffness: T,
    pub(super) displacement: [T; 5],
}
