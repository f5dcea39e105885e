//! Axis-aligned bounding boxes.

use super::{Bound, allowance};
use clench_math::{Real, Scalar, kernel};

/// A shape's box over all environments, with its margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aabb {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Aabb {
    /// The empty box.
    pub(super) const EMPTY: Aabb = Aabb {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    /// Computes a bound's box over all environments.
    #[kernel]
    pub(super) fn new<T: Real>(bound: &Bound<T>, margin: T) -> Self {
        let Aabb { mut low, mut high } = Aabb::EMPTY;
        for lane in 0..T::LANES {
            let number = |x: T| x.lane(lane).to_f64();
            for axis in 0..3 {
                let (center, half) = (bound.center[axis], bound.half[axis]);
                let reach = number(half) + number(margin * allowance());
                low[axis] = low[axis].min(number(center) - reach);
                high[axis] = high[axis].max(number(center) + reach);
            }
        }
        Aabb { low, high }
    }

    /// Returns the longest side.
    pub(super) fn side(&self) -> f64 {
        let side = |axis: usize| self.high[axis] - self.low[axis];
        side(0).max(side(1)).max(side(2))
    }

    pub(super) fn overlaps(&self, other: &Aabb) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    /// Returns the smallest box that encloses both.
    pub(super) fn union(&self, other: &Aabb) -> Aabb {
        Aabb {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis])),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// Returns true if all corners are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.low.iter().chain(&self.high).all(|x| x.is_finite())
    }
}
