//! Transfers numbers from a problem into the problem of an island, and results back: in all lanes, or in one.

use clench_math::Real;

/// Converts numbers `T` to numbers `F` and back.
pub(crate) trait Transfer<T: Real, F: Real>: Copy {
    /// Converts a number of the whole problem.
    fn convert(self, x: T) -> F;
    /// Converts `x` in `lanes`, which include the lanes of this transfer, and `absent` in the others.
    fn convert_in(self, lanes: T::Mask, x: T, absent: T) -> F;
    /// Converts a result of the island back. It is valid in the lanes of this transfer.
    fn convert_back(self, x: F) -> T;
}

/// The transfer of all lanes.
#[derive(Clone, Copy)]
pub(crate) struct AllLanes;

impl<T: Real> Transfer<T, T> for AllLanes {
    #[inline(always)]
    fn convert(self, x: T) -> T {
        x
    }
    #[inline(always)]
    fn convert_in(self, lanes: T::Mask, x: T, absent: T) -> T {
        T::select(lanes, x, absent)
    }
    #[inline(always)]
    fn convert_back(self, x: T) -> T {
        x
    }
}

/// The transfer of one lane.
#[derive(Clone, Copy)]
pub(crate) struct OneLane(pub usize);

impl<T: Real> Transfer<T, T::Scalar> for OneLane {
    #[inline(always)]
    fn convert(self, x: T) -> T::Scalar {
        x.lane(self.0)
    }
    #[inline(always)]
    fn convert_in(self, _: T::Mask, x: T, _: T) -> T::Scalar {
        x.lane(self.0)
    }
    #[inline(always)]
    fn convert_back(self, x: T::Scalar) -> T {
        T::splat(x)
    }
}
