//! The stick references of a state: a list of pairs of geoms, separate for each lane.

use super::pairs::{RelativePose, StickPair, Stiction};
use crate::model::Model;
use crate::sleep::Sleep;
use crate::state::kind::{Kind, Reference, StickReference};
use clench_math::{Mask, Real, Scalar};

/// Returns the number that identifies a geom; 0 is none.
fn tag<S: Scalar>(geom: usize) -> S {
    S::new((geom + 1) as f64)
}

/// Returns the tags of a reference in one lane.
fn tags<T: Real>(reference: &StickReference<T>, lane: usize) -> [T::Scalar; 2] {
    [reference.first.lane(lane), reference.second.lane(lane)]
}

/// Copies one lane of a reference.
fn copy_lane<T: Real>(from: &StickReference<T>, to: &mut StickReference<T>, lane: usize) {
    Reference::set_cells::<T>(to, lane, Reference::cells::<T>(from, lane));
}

impl<T: Real> StickPair<T> {
    /// Reads the reference from the list, in the lanes where the pair touches and has one. The search in a lane begins
    /// at its `cursor`, after the last pair: the list has the order of the pairs.
    #[inline(never)]
    pub(super) fn read_reference(&mut self, list: &[StickReference<T>], cursors: &mut [usize]) {
        let wanted = self.geoms.map(tag::<T::Scalar>);
        let mut own = self.stored();
        for lane in (0..T::LANES).filter(|&lane| self.active.lane(lane)) {
            let cursor = cursors[lane];
            let is_used = |&i: &usize| tags(&list[i], lane)[0] != T::Scalar::ZERO;
            let mut indices = (cursor..list.len()).take_while(is_used).chain(0..cursor);
            if let Some(found) = indices.find(|&i| tags(&list[i], lane) == wanted) {
                copy_lane(&list[found], &mut own, lane);
                cursors[lane] = found + 1;
            }
        }
        self.reference = RelativePose {
            position: own.position,
            rotation: own.rotation,
        };
    }

    /// Returns the reference as it is stored.
    fn stored(&self) -> StickReference<T> {
        let [first, second] = self.geoms.map(|geom| T::splat(tag(geom)));
        StickReference {
            first,
            second,
            position: self.reference.position,
            rotation: self.reference.rotation,
        }
    }
}

impl<T: Real> Stiction<T> {
    /// Replaces the list by the references of the pairs that carry a load, and of those that sleep. Returns the lanes
    /// in which the list is too short.
    pub(super) fn store(
        &self,
        model: &Model,
        sleep: &Sleep<T>,
        list: &mut [StickReference<T>],
    ) -> T::Mask {
        let mut overflow = T::Mask::splat(false);
        let empty = Reference::zero::<T>();
        for lane in 0..T::LANES {
            let mut used = move_sleeping_to_front(model, sleep, list, lane);
            for pair in self.pairs.iter().filter(|pair| pair.active.lane(lane)) {
                match list.get_mut(used) {
                    Some(slot) => copy_lane(&pair.stored(), slot, lane),
                    None => overflow.set_lane(lane, true),
                }
                used += 1;
            }
            let rest = list.iter_mut().skip(used);
            for slot in rest.take_while(|slot| tags(slot, lane)[0] != T::Scalar::ZERO) {
                copy_lane(&empty, slot, lane);
            }
        }
        overflow
    }
}

/// Moves the references of pairs that sleep in a lane to the front. Returns their number.
fn move_sleeping_to_front<T: Real>(
    model: &Model,
    sleep: &Sleep<T>,
    list: &mut [StickReference<T>],
    lane: usize,
) -> usize {
    if !model.may_sleep() {
        return 0;
    }
    // Users may write any number.
    let geom = |tag: T::Scalar| model.geoms.get((tag.to_f64() as usize).wrapping_sub(1));
    let mut kept = 0;
    for slot in 0..list.len() {
        let reference = list[slot];
        let [first, second] = tags(&reference, lane);
        if first == T::Scalar::ZERO {
            break;
        }
        let (Some(first), Some(second)) = (geom(first), geom(second)) else {
            continue;
        };
        if !sleep.is_either_awake([first.body, second.body]).lane(lane) {
            copy_lane(&reference, &mut list[kept], lane);
            kept += 1;
        }
    }
    kept
}
