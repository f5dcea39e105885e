//! Collision of two shapes, compiled once in this crate and not again in its callers.

use crate::differentiated::collide_differentiated;
use crate::narrow::{Collide, collide_again};
use clench_math::{CompiledKernels, KernelTable, Real};
use std::sync::LazyLock;

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
        if T::IS_DUAL {
            |a, pose_a, b, pose_b, margin, memory, out| {
                let pair = ([a, b], [pose_a, pose_b]);
                collide_differentiated(compiled_collide(), pair, margin, memory.axis, out);
            }
        } else {
            collide_again
        }
    }
}
