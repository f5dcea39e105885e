//! What users see of a batch: plain rows, one an environment, that never move.

use clench_dynamics::error::SimError;
use std::fmt;
use std::hint::black_box;

/// Bytes to which rows are aligned: a cache line, the widest register, and what other array libraries ask for.
const ALIGNMENT: usize = 64;

/// A table with a row for each environment, row after row in memory.
///
/// The numbers begin at a multiple of 64 bytes, and stay where they are as long as the table lives.
pub struct Rows<E> {
    /// With room to begin at an aligned address.
    buffer: Vec<E>,
    start: usize,
    count: usize,
    width: usize,
}

impl<E: Copy> Rows<E> {
    /// `count` rows of `width` times `value`.
    ///
    /// # Errors
    /// More memory than there is.
    pub(crate) fn new(count: usize, width: usize, value: E) -> Result<Self, SimError> {
        let spare = ALIGNMENT / size_of::<E>().max(1);
        let len = count.checked_mul(width);
        let room = len.and_then(|len| len.checked_add(spare));
        let mut buffer = Vec::new();
        match room.map(|room| buffer.try_reserve_exact(room)) {
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

    /// `count` rows that are each a copy of `row`; `filler` may be anything.
    ///
    /// # Errors
    /// More memory than there is.
    pub(crate) fn repeat(count: usize, row: &[E], filler: E) -> Result<Self, SimError> {
        let mut rows = Rows::new(count, row.len(), filler)?;
        (0..count).for_each(|i| rows.row_mut(i).copy_from_slice(row));
        Ok(rows)
    }
}

impl<E> Rows<E> {
    /// How many rows there are.
    pub fn count(&self) -> usize {
        self.count
    }
    /// How many numbers a row has.
    pub fn width(&self) -> usize {
        self.width
    }
    /// All rows, one after the other.
    pub fn as_slice(&self) -> &[E] {
        &self.buffer[self.start..][..self.count * self.width]
    }
    /// All rows, to be written.
    pub fn as_mut_slice(&mut self) -> &mut [E] {
        &mut self.buffer[self.start..][..self.count * self.width]
    }
    /// Where the numbers begin, for code that shares them beyond this table's borrows. The pointer stays valid, and the numbers
    /// stay there, as long as the table lives, wherever it is moved.
    pub fn as_ptr(&self) -> *const E {
        // `start` is within the buffer; no reference to the numbers is made on the way.
        self.buffer.as_ptr().wrapping_add(self.start)
    }
    /// As [`as_ptr`](Self::as_ptr), to be written.
    pub fn as_mut_ptr(&mut self) -> *mut E {
        self.buffer.as_mut_ptr().wrapping_add(self.start)
    }
    /// The row of environment `env`.
    ///
    /// # Panics
    /// If there is no such row, as slices do.
    pub fn row(&self, env: usize) -> &[E] {
        &self.as_slice()[env * self.width..][..self.width]
    }
    /// The row of environment `env`, to be written.
    ///
    /// # Panics
    /// If there is no such row, as slices do.
    pub fn row_mut(&mut self, env: usize) -> &mut [E] {
        let width = self.width;
        &mut self.as_mut_slice()[env * width..][..width]
    }
    /// The rows in turn.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[E]> {
        (0..self.count).map(|env| self.row(env))
    }
    /// Bytes that a row takes.
    pub(crate) fn row_bytes(&self) -> usize {
        self.width * size_of::<E>()
    }
}

impl<E: fmt::Debug> fmt::Debug for Rows<E> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// A number for each of `count` environments that users do not see.
///
/// # Errors
/// More memory than there is.
pub(super) fn per_env<E>(count: usize, value: impl FnMut() -> E) -> Result<Vec<E>, SimError> {
    let mut values = Vec::new();
    if values.try_reserve_exact(count).is_err() {
        let bytes = size_of::<E>();
        return Err(SimError::OutOfMemory { count, bytes });
    }
    values.resize_with(count, value);
    Ok(values)
}

/// Asks for the memory of `count` rows of `bytes` bytes, and gives it back at once. Before many tables are made: a system that
/// grants each of them may still have too little for all, and ends the process when they are written.
///
/// # Errors
/// More memory than there is.
pub(super) fn try_reserve(count: usize, bytes: usize) -> Result<(), SimError> {
    let mut room = Vec::<u8>::new();
    let reserved = (count.checked_mul(bytes)).map(|total| room.try_reserve_exact(total));
    // Without this the compiler would see that the memory is not used, and not ask for it.
    black_box(&room);
    match reserved {
        Some(Ok(())) => Ok(()),
        _ => Err(SimError::OutOfMemory { count, bytes }),
    }
}
