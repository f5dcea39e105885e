//! The limits of the numbers of a state, as its table defines them.

use super::State;
use super::kind::{self, Kind};
use clench_math::{Mask, Real, Scalar};

/// The limit of valid positions, velocities and accelerations (MuJoCo's `mjMAXVAL`).
const MAX_VALUE: f64 = 1e10;

/// The limit of the numbers of a field.
#[derive(Clone, Copy)]
pub(crate) enum Limit {
    /// At most [`MAX_VALUE`].
    Near,
    /// Finite.
    Finite,
}

impl Limit {
    #[inline(always)]
    pub(crate) fn of<T: Real>(self) -> T {
        match self {
            Limit::Near => T::new(MAX_VALUE),
            Limit::Finite => T::splat(T::Scalar::MAX),
        }
    }
}

/// Returns the first number of a lane that is beyond a limit, if any.
pub(crate) fn first_beyond<T: Real>(
    values: &[T],
    lane: usize,
    limit: Limit,
) -> Option<(usize, f64)> {
    let value = |i: usize| values[i].lane(lane);
    let limit = limit.of::<T::Scalar>();
    let index = (0..values.len()).find(|&i| !value(i).abs().le(limit))?;
    Some((index, value(index).to_f64()))
}

/// The minimum number of values for which a vectorized loop is worth a call.
const WORTH_CALL: usize = 32;

/// Returns the lanes in which all numbers are within a limit.
#[inline(always)]
pub(crate) fn within<T: Real>(values: &[T], limit: Limit) -> T::Mask {
    if T::LANES == 1 && values.len() >= WORTH_CALL {
        let values = T::as_scalars(values);
        return T::Mask::splat(T::Scalar::all_within(values, limit.of()));
    }
    let limit = limit.of();
    let mut mask = T::Mask::splat(true);
    for x in values {
        mask &= x.abs().le(limit);
    }
    mask
}

macro_rules! declare_inputs {
    ($($group:ident { $(
        $(#[$doc:meta])* $name:ident $setter:ident: $kind:ident, $size:ident, $limit:ident;
    )* })*) => {
        /// Returns true if some numbers of a field of the state are beyond its limit.
        pub fn beyond_bounds<T: Scalar>(field: &str, values: &[T]) -> bool {
            $($(if field == stringify!($name) {
                return first_beyond(values, 0, Limit::$limit).is_some();
            })*)*
            false
        }

        /// Passes every number of a state except its time to `visit`, for the groups that are wanted: field, its limit,
        /// index of the first number in the field, numbers.
        #[inline(always)]
        pub(crate) fn each_input<T: Real>(
            s: &State<T>,
            wanted: impl Fn(&'static str) -> bool,
            mut visit: impl FnMut(&'static str, Limit, usize, &[T]),
        ) {
            $(if wanted(stringify!($group)) {
                $(kind::$kind::numbers::<T>(
                    &s.$name,
                    #[inline(always)]
                    |start, numbers| visit(stringify!($name), Limit::$limit, start, numbers),
                );)*
            })*
        }
    };
}
crate::state_fields!(declare_inputs);

/// The group of fields that are mostly zero.
pub(crate) const OCCASIONAL: &str = "occasional";

/// Returns true if an occasional input is not zero.
pub fn has_occasional<S: Scalar>(s: &State<S>) -> bool {
    let mut bits = 0;
    each_input(
        s,
        |group| group == OCCASIONAL,
        #[inline(always)]
        |_, _, _, numbers| {
            for x in numbers {
                bits |= x.to_f64().to_bits();
            }
        },
    );
    bits != 0
}

/// Returns true if all occasional inputs satisfy `wanted`, which receives some numbers at a time.
#[inline(always)]
pub(crate) fn are_occasional<T: Real>(s: &State<T>, wanted: impl Fn(&[T]) -> bool) -> bool {
    let mut all = true;
    each_input(
        s,
        |group| group == OCCASIONAL,
        #[inline(always)]
        |_, _, _, numbers| all &= wanted(numbers),
    );
    all
}
