//! Values in atomic cells, so that threads can share the rows that contain them.

#![allow(
    unsafe_code,
    reason = "the standard library's view of numbers as atomics is unstable"
)]

use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering::Relaxed};

/// The element type of rows that threads share.
pub trait Shared: Copy {
    /// The type of the same value if several threads write it.
    type Cell: Sync;
    /// Returns values as cells.
    fn cells(values: &mut [Self]) -> &[Self::Cell];
    /// Returns the value in a cell.
    fn load(cell: &Self::Cell) -> Self;
    /// Stores a value in a cell.
    fn store(cell: &Self::Cell, value: Self);
    /// Returns the bits of the value in a cell.
    fn bits(cell: &Self::Cell) -> u64;
}

macro_rules! shared {
    ($number:ident in $cell:ident, $from:expr, $to:expr) => {
        impl Shared for $number {
            type Cell = $cell;
            fn cells(values: &mut [$number]) -> &[$cell] {
                const { assert!(size_of::<$number>() == size_of::<$cell>()) };
                const { assert!(align_of::<$number>() >= align_of::<$cell>()) };
                let cells: *mut [$number] = values;
                // SAFETY: a cell has the size, the alignment and the bits of its number, any bits are a number, and the
                // borrow of the numbers lasts as long as that of the cells.
                unsafe { &*(cells as *const [$cell]) }
            }
            #[inline(always)]
            fn load(cell: &$cell) -> $number {
                $from(cell.load(Relaxed))
            }
            #[inline(always)]
            fn store(cell: &$cell, value: $number) {
                cell.store($to(value), Relaxed);
            }
            #[inline(always)]
            fn bits(cell: &$cell) -> u64 {
                u64::from(cell.load(Relaxed))
            }
        }
    };
}
shared!(f64 in AtomicU64, f64::from_bits, f64::to_bits);
shared!(f32 in AtomicU32, f32::from_bits, f32::to_bits);
shared!(u8 in AtomicU8, u8::from, u8::from);
shared!(i32 in AtomicU32, u32::cast_signed, i32::cast_unsigned);
