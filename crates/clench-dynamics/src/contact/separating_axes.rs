//! The separating axes of pairs of geoms in the last step that checked them.
//!
//! Most near pairs stay separated for many steps. A stored axis proves this at once ([`clench_collide::collide_again`])
//! and changes no result. Thus it is not part of the state, may stem from another environment, and two pairs may
//! compete for an entry.

use clench_collide::SeparatingAxis;
use clench_math::Real;

/// The number of pairs in a bucket; a further one evicts the one that was checked least recently.
const WAYS: usize = 4;
/// The number of entries per near pair.
const ENTRIES_PER_PAIR: usize = 4;

/// Returns a number that distinguishes most pairs of geoms.
pub(super) fn hash(geoms: [u32; 2]) -> u32 {
    geoms[0].wrapping_mul(0x9E37_79B9) ^ geoms[1].wrapping_mul(0x85EB_CA6B)
}

/// A table of buckets without chains.
#[derive(Clone, Debug, Default)]
pub(super) struct SeparatingAxes<T> {
    buckets: Vec<[Entry<T>; WAYS]>,
    /// The number of the current check of pairs.
    check: u32,
}

/// A pair of geoms and its axis.
#[derive(Clone, Copy, Debug)]
struct Entry<T> {
    geoms: [u32; 2],
    /// The number of the last check that used it.
    used: u32,
    axis: SeparatingAxis<T>,
}

impl<T: Real> SeparatingAxes<T> {
    /// Starts a check of `pairs` and reserves capacity for them. If the table grows, all axes are cleared.
    pub(super) fn begin(&mut self, pairs: usize) {
        self.check = self.check.wrapping_add(1);
        let wanted = (pairs * ENTRIES_PER_PAIR)
            .div_ceil(WAYS)
            .next_power_of_two();
        if self.buckets.len() < wanted {
            let none = Entry {
                geoms: [u32::MAX; 2],
                used: self.check.wrapping_sub(1),
                axis: SeparatingAxis::default(),
            };
            self.buckets.clear();
            self.buckets.resize(wanted, [none; WAYS]);
        }
    }

    /// Returns the index of a pair's axis.
    #[inline(always)]
    pub(super) fn index(&mut self, geoms: [u32; 2]) -> usize {
        let mixed = hash(geoms);
        let bucket = (mixed ^ (mixed >> 15)) as usize & (self.buckets.len() - 1);
        let (entries, check) = (&mut self.buckets[bucket], self.check);
        let found = entries.iter().position(|entry| entry.geoms == geoms);
        let way = found.unwrap_or_else(|| {
            let age = |way: &usize| check.wrapping_sub(entries[*way].used);
            let oldest = (0..WAYS).max_by_key(age).unwrap_or(0);
            entries[oldest].geoms = geoms;
            entries[oldest].axis = SeparatingAxis::default();
            oldest
        });
        entries[way].used = check;
        bucket * WAYS + way
    }

    /// Returns the axis at an index.
    #[inline(always)]
    pub(super) fn at(&mut self, index: usize) -> &mut SeparatingAxis<T> {
        &mut self.buckets[index / WAYS][index % WAYS].axis
    }
}
