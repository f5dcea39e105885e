//! In which directions pairs of geoms were apart when a step last looked at them.
//!
//! Most pairs that are near each other are apart step after step. What is kept here shows that at once ([`clench_collide::collide_again`])
//! and changes no result: so it is no part of the state, may be another environment's, and two pairs may contend for one place.

use clench_collide::SeparatingAxis;
use clench_math::Real;

/// Pairs that share a bucket: of more, one gives way.
const WAYS: usize = 4;
/// Places for each pair that is near.
const PLACES_PER_PAIR: usize = 4;

/// A table of buckets without chains.
#[derive(Clone, Debug, Default)]
pub(super) struct SeparatingAxes<T> {
    buckets: Vec<[Entry<T>; WAYS]>,
}

/// A pair of geoms and its direction.
type Entry<T> = ([u32; 2], SeparatingAxis<T>);

impl<T: Real> SeparatingAxes<T> {
    /// Makes room for a number of pairs. Where that is more than ever before, all axes are forgotten.
    pub(super) fn reserve(&mut self, pairs: usize) {
        let wanted = (pairs * PLACES_PER_PAIR).div_ceil(WAYS).next_power_of_two();
        if self.buckets.len() < wanted {
            let none = ([u32::MAX; 2], SeparatingAxis::default());
            self.buckets.clear();
            self.buckets.resize(wanted, [none; WAYS]);
        }
    }

    /// The place of a pair's direction.
    #[inline(always)]
    pub(super) fn place(&mut self, geoms: [u32; 2]) -> usize {
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

    /// The direction at a place.
    #[inline(always)]
    pub(super) fn at(&mut self, place: usize) -> &mut SeparatingAxis<T> {
        &mut self.buckets[place / WAYS][place % WAYS].1
    }
}
