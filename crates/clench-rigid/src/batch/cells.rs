//! Rows that several threads write at once, each for its own environments.
//!
//! The environments that a thread steps depend on their contacts, so the rows cannot be split beforehand into disjoint
//! slices. Values are therefore written through atomic cells: an ordinary store on all processors, without data races
//! for any grouping. Inputs of a step use them too, as holders of pointers to rows may write meanwhile.

use super::Rows;
use super::shared::Shared;
use clench_dynamics::state::kind::Kind;
use clench_math::{Real, Scalar};

/// The rows of a table, shared by threads during a call.
pub struct Cells<'a, S: Shared> {
    cells: &'a [S::Cell],
    width: usize,
}

impl<'a, S: Shared> Cells<'a, S> {
    pub fn new(rows: &'a mut Rows<S>) -> Self {
        Cells {
            width: rows.width(),
            cells: S::cells(rows.as_mut_slice()),
        }
    }

    fn row(&self, env: usize) -> &[S::Cell] {
        &self.cells[env * self.width..][..self.width]
    }

    /// Returns the value of an environment in a table of width one.
    #[inline(always)]
    pub fn get(&self, env: usize) -> S {
        S::load(&self.row(env)[0])
    }

    /// Sets the value of an environment in a table of width one.
    #[inline(always)]
    pub fn set(&self, env: usize, value: S) {
        S::store(&self.row(env)[0], value);
    }

    /// Replaces the row of an environment.
    #[inline(always)]
    pub fn set_row(&self, env: usize, values: impl IntoIterator<Item = S>) {
        for (cell, value) in self.row(env).iter().zip(values) {
            S::store(cell, value);
        }
    }

    /// Returns all values, row by row.
    pub fn all(&self) -> impl ExactSizeIterator<Item = S> {
        self.cells.iter().map(S::load)
    }

    /// Replaces all rows.
    pub(crate) fn set_all(&self, values: impl Iterator<Item = S>) {
        for (cell, value) in self.cells.iter().zip(values) {
            S::store(cell, value);
        }
    }

    /// Returns true if all bits of an environment's row are zero.
    #[inline(always)]
    pub(crate) fn is_blank(&self, env: usize) -> bool {
        self.row(env)
            .iter()
            .fold(0, |bits, cell| bits | S::bits(cell))
            == 0
    }
}

impl<C: Shared> Cells<'_, C> {
    /// Copies the row of an environment into lane `lane` of `out`.
    #[inline(never)]
    pub fn read<K: Kind<Cell<T::Scalar> = C>, T: Real>(
        &self,
        env: usize,
        lane: usize,
        out: &mut [K::Of<T>],
    ) {
        for (element, cells) in out.iter_mut().zip(self.row(env).chunks_exact(K::WIDTH)) {
            if K::LISTED && is_end::<K, T>(C::load(&cells[0]), element, lane) {
                break;
            }
            K::set_cells(element, lane, cells.iter().map(C::load));
        }
    }

    /// Copies lane `lane` of `elements` into the row of an environment.
    #[inline(never)]
    pub fn write<K: Kind<Cell<T::Scalar> = C>, T: Real>(
        &self,
        env: usize,
        lane: usize,
        elements: &[K::Of<T>],
    ) {
        for (element, cells) in elements.iter().zip(self.row(env).chunks_exact(K::WIDTH)) {
            if K::LISTED && is_end::<K, T>(C::load(&cells[0]), element, lane) {
                break;
            }
            for (to, cell) in cells.iter().zip(K::cells(element, lane)) {
                C::store(to, cell);
            }
        }
    }
}

impl<S: Scalar + Shared> Cells<'_, S> {
    /// Copies lane `lane` of `values` into the row of an environment, starting at index `start`.
    #[inline(always)]
    pub(crate) fn write_part<T: Real<Scalar = S>>(
        &self,
        env: usize,
        start: usize,
        lane: usize,
        values: &[T],
    ) {
        let lanes = T::as_scalars(values).chunks_exact(T::LANES);
        for (lanes, cell) in lanes.zip(&self.row(env)[start..]) {
            S::store(cell, lanes[lane]);
        }
    }
}

/// Returns true if a list ends with the element whose first cell is `first` in a row, and in lane `lane` of `element`.
#[inline(always)]
fn is_end<K: Kind, T: Real>(first: K::Cell<T::Scalar>, element: &K::Of<T>, lane: usize) -> bool {
    let is_zero = |cell| K::number::<T::Scalar>(cell) == T::Scalar::ZERO;
    is_zero(first) && K::cells::<T>(element, lane).next().is_some_and(is_zero)
}
