//! The results of the last search for the contacts of a pair, which may save the next one.

use super::convex::LaneProofs;
use super::separating_axis::SeparatingAxis;

/// The separating direction and the proofs of depth of two shapes. None changes a contact.
#[derive(Debug)]
pub struct PairMemory<'a, T> {
    /// The direction that last separated two shapes.
    pub axis: &'a mut SeparatingAxis<T>,
    /// The proof of the last depth in each lane.
    pub proofs: LaneProofs<'a>,
}

impl<'a, T> PairMemory<'a, T> {
    /// Creates a memory without proofs.
    pub fn of_axis(axis: &'a mut SeparatingAxis<T>) -> Self {
        let proofs = LaneProofs::default();
        PairMemory { axis, proofs }
    }
}
