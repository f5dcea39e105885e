//! The separating axes of pairs of geoms in the last step that checked them.
//!
//! Most near pairs stay separated for many steps. A stored axis proves this at once ([`clench_collide::collide_again`])
//! and changes no result. Thus it is not part of the state, may stem from another environment, and two pairs may
//! compete for an entry.

use clench_collide::SeparatingAxis;
use clench_math::Real;

/// The number of pairs in a bucket; a further one evicts another.
const WAYS: usize = 4;
/// The number of entries per near pair.
const ENTRIES_PER_PAIR: usize = 4;

/// A table of buckets without chains.
#[derive(Clone, Debug, Default)]
pub(super) struct SeparatingAxes<T> {
    buckets: Vec<[Entry<T>; WAYS]>,
}

/// A pair of geoms and its axis.
type Entry<T> = ([u32; 2], SeparatingAxis<T>);

impl<T: Real> SeparatingAxes<T> {
    /// Reserves capacity for `pairs`. If the table grows, all axes are cleared.
    pub(super) fn reserve(&mut self, pairs: usize) {
        let wanted = (pairs * ENTRIES_PER_PAIR)
            .div_ceil(WAYS)
            .next_power_of_two();
        if self.buckets.len() < wanted {
            let none = ([u32::MAX; 2], SeparatingAxis::default());
            self.buckets.clear();
            self.buckets.resize(wanted, [none; WAYS]);
        }
    }

    /// Returns the index of a pair's axis.
    #[inline(always)]
    pub(super) fn index(&mut self, geoms: [u32; 2]) -> usize {
        let mixed = geoms[0].wrapping_mul(0x9E37_79B9) ^ geoms[1].wrapping_mul(0x85EB_CA6B);
        let mixed = mixed ^ (mixed >> 15);
        let bucket = mixed as usize & (self.buckets.len() - 1);
        let places = &mut self.buckets[bucket];
        let known = places.iter().position(|(owner, _)| *owner == geoms);
        let way = known.unwrap_or((mixed >> 24) as usize % WAYS);
        let (owner, axis) = &mut places[way];
        if known.is_none() {
            (*owner, *axis) = (geoms, SeparatingAxis::default());
        }
        bucket * WAYS + way
    }

    /// Returns the axis at an index.
    #[inline(always)]
    pub(super) fn at(&mut self, index: usize) -> &mut SeparatingAxis<T> {
        &mut self.buckets[index / WAYS][index % WAYS].1
    }
}
