//! The user-visible tables of a batch: one row per environment, at a fixed address.

use clench_dynamics::error::SimError;
use std::fmt;
use std::hint::black_box;

/// The alignment of rows in bytes: a cache line, the widest register, and the requirement of other array libraries.
const ALIGNMENT: usize = 64;

/// A table with one row per environment, stored row by row.
///
/// The values start at a multiple of 64 bytes, and their address is fixed for the lifetime of the table.
pub struct Rows<E> {
    /// The values, with spare capacity for an aligned start.
    buffer: Vec<E>,
    start: usize,
    count: usize,
    width: usize,
}

impl<E: Copy> Rows<E> {
    /// Creates `count` rows of `width` times `value`, or returns an error if memory is insufficient.
    pub(crate) fn new(count: usize, width: usize, value: E) -> Result<Self, SimError> {
        let spare = ALIGNMENT / size_of::<E>().max(1);
        let len = count.checked_mul(width);
        let capacity = len.and_then(|len| len.checked_add(spare));
        let mut buffer = Vec::new();
        match capacity.map(|capacity| buffer.try_reserve_exact(capacity)) {
            Some(Ok(())) => {}
            _ => {
                let bytes = width.saturating_mul(size_of::<E>());
                return Err(SimError::OutOfMemory { count, bytes });
            }
        }
        buffer.resize(len.unwrap_or(0) + spare, value);
        Ok(Rows {
            start: buffer.as_ptr().align_offset(ALIGNMENT).min(spare),
            buffer,
            count,
            width,
        })
    }

    /// Does the same, but returns no rows and sets `error` if memory is insufficient, so that a struct of many tables
    /// has one exit.
    #[inline(never)]
    pub(super) fn new_or(
        (count, width): (usize, usize),
        value: E,
        error: &mut Option<SimError>,
    ) -> Self {
        Rows::new(count, width, value).unwrap_or_else(|failed| {
            *error = Some(failed);
            Rows {
                buffer: Vec::new(),
                start: 0,
                count: 0,
                width: 0,
            }
        })
    }

    /// Creates `count` copies of `row`; `filler` may have any value.
    pub(crate) fn repeat(count: usize, row: &[E], filler: E) -> Result<Self, SimError> {
        let mut rows = Rows::new(count, row.len(), filler)?;
        (0..count).for_each(|i| rows.row_mut(i).copy_from_slice(row));
        Ok(rows)
    }
}

impl<E> Rows<E> {
    /// Returns the number of rows.
    pub fn count(&self) -> usize {
        self.count
    }
    /// Returns the number of values per row.
    pub fn width(&self) -> usize {
        self.width
    }
    /// Returns all rows, one after the other.
    pub fn as_slice(&self) -> &[E] {
        &self.buffer[self.start..][..self.count * self.width]
    }
    /// Returns all rows for modification.
    pub fn as_mut_slice(&mut self) -> &mut [E] {
        &mut self.buffer[self.start..][..self.count * self.width]
    }
    /// Returns a pointer to the values, for code that shares them beyond this table's borrows. It stays valid for the
    /// lifetime of the table, even if the table is moved.
    pub fn as_ptr(&self) -> *const E {
        // `start` is within the buffer; no reference to the values is created.
        self.buffer.as_ptr().wrapping_add(self.start)
    }
    /// Returns [`as_ptr`](Self::as_ptr) as a mutable pointer.
    pub fn as_mut_ptr(&mut self) -> *mut E {
        self.buffer.as_mut_ptr().wrapping_add(self.start)
    }
    /// Returns the row of environment `env`.
    ///
    /// # Panics
    /// Panics if the row does not exist.
    pub fn row(&self, env: usize) -> &[E] {
        &self.as_slice()[env * self.width..][..self.width]
    }
    /// Returns the row of environment `env` for modification.
    ///
    /// # Panics
    /// Panics if the row does not exist.
    pub fn row_mut(&mut self, env: usize) -> &mut [E] {
        let width = self.width;
        &mut self.as_mut_slice()[env * width..][..width]
    }
    /// Returns an iterator over the rows.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[E]> {
        (0..self.count).map(|env| self.row(env))
    }
    /// Returns the size of a row in bytes.
    pub(crate) fn row_bytes(&self) -> usize {
        self.width * size_of::<E>()
    }
}

impl<E: fmt::Debug> fmt::Debug for Rows<E> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// Allocates an internal value for each of `count` environments.
pub(super) fn per_env<E>(count: usize, value: impl FnMut() -> E) -> Result<Vec<E>, SimError> {
    let mut values = Vec::new();
    if values.try_reserve_exact(count).is_err() {
        let bytes = size_of::<E>();
        return Err(SimError::OutOfMemory { count, bytes });
    }
    values.resize_with(count, value);
    Ok(values)
}

/// Reserves and releases the memory of `count` rows of `bytes` bytes, before many tables are allocated: a system that
/// grants each of them may still have too little for all, and kills the process when they are written.
pub(super) fn try_reserve(count: usize, bytes: usize) -> Result<(), SimError> {
    let mut probe = Vec::<u8>::new();
    let reserved = (count.checked_mul(bytes)).map(|total| probe.try_reserve_exact(total));
    // Prevents the compiler from removing the unused allocation.
    black_box(&probe);
    match reserved {
        Some(Ok(())) => Ok(()),
        _ => Err(SimError::OutOfMemory { count, bytes }),
    }
}
