//! How numbers get from a problem into the problem of an island, and results back: all lanes side by side, or one alone.

use clench_math::Real;

/// From numbers `T` to numbers `F` and back.
pub(crate) trait Transfer<T: Real, F: Real>: Copy {
    /// A number of the whole problem.
    fn take(self, x: T) -> F;
    /// `x` in `lanes`, which hold the lanes that this is for; `absent` in the others.
    fn take_in(self, lanes: T::Mask, x: T, absent: T) -> F;
    /// A result, in the lanes that this is for.
    fn put(self, x: F) -> T;
}

/// All lanes.
#[derive(Clone, Copy)]
pub(crate) struct AllLanes;

impl<T: Real> Transfer<T, T> for AllLanes {
    #[inline(always)]
    fn take(self, x: T) -> T {
        x
    }
    #[inline(always)]
    fn take_in(self, lanes: T::Mask, x: T, absent: T) -> T {
        T::select(lanes, x, absent)
    }
    #[inline(always)]
    fn put(self, x: T) -> T {
        x
    }
}

/// This lane.
#[derive(Clone, Copy)]
pub(crate) struct OneLane(pub usize);

impl<T: Real> Transfer<T, T::Scalar> for OneLane {
    #[inline(always)]
    fn take(self, x: T) -> T::Scalar {
        x.lane(self.0)
    }
    #[inline(always)]
    fn take_in(self, _: T::Mask, x: T, _: T) -> T::Scalar {
        x.lane(self.0)
    }
    #[inline(always)]
    fn put(self, x: T::Scalar) -> T {
        T::splat(x)
    }
}
