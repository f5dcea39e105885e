//! Collision of two shapes, compiled once in this crate and not again in its callers.

use crate::{Contacts, Pose, SeparatingAxis, Shape, collide_again};
use clench_math::{CompiledKernels, KernelTable, Real};
use std::sync::LazyLock;

/// A pointer to [`collide_again`].
pub type Collide<T> =
    fn(&Shape<T>, &Pose<T>, &Shape<T>, &Pose<T>, T, &mut SeparatingAxis<T>, &mut Contacts<T>);

/// Returns [`collide_again`] as compiled in this crate, for a number type that
/// [`Scalar::in_lanes`](clench_math::Scalar::in_lanes) passes to tasks.
///
/// # Panics
/// Panics if `T` is another type.
pub fn compiled_collide<T: Real>() -> Collide<T> {
    // Not generic, so that it is compiled here.
    #[inline(never)]
    fn compiled() -> &'static CompiledKernels {
        static COMPILED: LazyLock<CompiledKernels> =
            LazyLock::new(CompiledKernels::new::<CollideTable>);
        &COMPILED
    }
    compiled().table::<CollideTable, T>()
}

struct CollideTable;

impl KernelTable for CollideTable {
    type Of<T: Real> = Collide<T>;
    fn of<T: Real>() -> Collide<T> {
        collide_again
    }
}
