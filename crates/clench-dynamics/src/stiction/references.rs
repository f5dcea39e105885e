//! The stick references of a state: a pool of pairs of geoms, separate for each lane.
//!
//! References occupy the first slots. The first number of an empty slot is 0.

use super::{RelativePose, STICK_NUMBERS, StickPair, Stiction};
use crate::model::Model;
use crate::sleep::Sleep;
use clench_math::{Mask, Quat, Real, Scalar, Vec3};

/// The number that identifies a geom; 0 is none.
fn tag<S: Scalar>(geom: usize) -> S {
    S::new((geom + 1) as f64)
}

/// The numbers of a pool in one lane.
struct Slots<P> {
    pool: P,
    lanes: usize,
    lane: usize,
}

impl<S: Scalar> Slots<&mut [S]> {
    fn number(&mut self, slot: usize, number: usize) -> &mut S {
        &mut self.pool[(slot * STICK_NUMBERS + number) * self.lanes + self.lane]
    }
}

impl<T: Real> StickPair<T> {
    /// Reads the reference from the pool, in the lanes where the pair touches and has one.
    #[inline(never)]
    pub(super) fn read_reference(&mut self, pool: &[T]) {
        let slots = pool.len() / STICK_NUMBERS;
        let pool = T::as_scalars(pool);
        let tags = self.geoms.map(tag::<T::Scalar>);
        for lane in (0..T::LANES).filter(|&lane| self.active.lane(lane)) {
            let number = |slot: usize, i: usize| pool[(slot * STICK_NUMBERS + i) * T::LANES + lane];
            for slot in 0..slots {
                let found = [number(slot, 0), number(slot, 1)];
                if found[0] == T::Scalar::ZERO {
                    break;
                }
                if found == tags {
                    self.reference.write(lane, |i| number(slot, 2 + i));
                    break;
                }
            }
        }
    }
}

impl<T: Real> RelativePose<T> {
    pub(super) const IDENTITY: Self = RelativePose {
        position: Vec3::ZERO,
        rotation: Quat::IDENTITY,
    };

    fn parts(&mut self) -> [&mut T; 7] {
        let RelativePose {
            position: p,
            rotation: q,
        } = self;
        [
            &mut p.x, &mut p.y, &mut p.z, &mut q.w, &mut q.x, &mut q.y, &mut q.z,
        ]
    }

    fn write(&mut self, lane: usize, number: impl Fn(usize) -> T::Scalar) {
        for (i, part) in self.parts().into_iter().enumerate() {
            part.set_lane(lane, number(i));
        }
    }
}

impl<T: Real> Stiction<T> {
    /// Replaces the pool by the references of the pairs that carry a load, and of those that sleep. Returns the lanes
    /// in which the pool is too small.
    pub(super) fn store(&mut self, model: &Model, sleep: &Sleep<T>, pool: &mut [T]) -> T::Mask {
        let slots = pool.len() / STICK_NUMBERS;
        let mut overflow = T::Mask::splat(false);
        for lane in 0..T::LANES {
            let mut pool = Slots {
                pool: T::as_scalars_mut(pool),
                lanes: T::LANES,
                lane,
            };
            let mut used = keep_sleeping::<T>(model, sleep, &mut pool, slots);
            for pair in self.pairs.iter_mut() {
                if !pair.active.lane(lane) {
                    continue;
                }
                if used == slots {
                    overflow.set_lane(lane, true);
                    break;
                }
                for (i, geom) in pair.geoms.into_iter().enumerate() {
                    *pool.number(used, i) = tag(geom);
                }
                for (i, part) in pair.reference.parts().into_iter().enumerate() {
                    *pool.number(used, 2 + i) = part.lane(lane);
                }
                used += 1;
            }
            while used < slots && *pool.number(used, 0) != T::Scalar::ZERO {
                for i in 0..STICK_NUMBERS {
                    *pool.number(used, i) = T::Scalar::ZERO;
                }
                used += 1;
            }
        }
        overflow
    }
}

/// Moves the references of pairs that sleep to the first slots. Returns their number.
fn keep_sleeping<T: Real>(
    model: &Model,
    sleep: &Sleep<T>,
    pool: &mut Slots<&mut [T::Scalar]>,
    slots: usize,
) -> usize {
    if !model.may_sleep() {
        return 0;
    }
    let mut kept = 0;
    for slot in 0..slots {
        let tags = [*pool.number(slot, 0), *pool.number(slot, 1)];
        if tags[0] == T::Scalar::ZERO {
            break;
        }
        // Users may write any number.
        let geom = |tag: T::Scalar| model.geoms.get((tag.to_f64() as usize).wrapping_sub(1));
        let (Some(first), Some(second)) = (geom(tags[0]), geom(tags[1])) else {
            continue;
        };
        if sleep
            .is_either_awake([first.body, second.body])
            .lane(pool.lane)
        {
            continue;
        }
        for i in 0..STICK_NUMBERS {
            *pool.number(kept, i) = *pool.number(slot, i);
        }
        kept += 1;
    }
    kept
}
