//! Rows that several threads write at once, each its own environments.
//!
//! Which environments a thread steps follows from their contacts, so their rows cannot be dealt out beforehand as disjoint
//! slices. Numbers are therefore written through atomic cells: on all processors an ordinary store, and no race whatever
//! the groups are. What a step only reads goes through them too, since those who hold pointers to rows may write it meanwhile.

use super::Rows;
use super::precision::{Lanewise, Shared};
use clench_math::Real;
use std::array::from_fn;

/// The rows of a table, shared by threads for the time of a call.
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

    /// The number of an environment, where a row has one.
    #[inline(always)]
    pub fn get(&self, env: usize) -> S {
        S::load(&self.row(env)[0])
    }

    /// Sets the number of an environment, where a row has one.
    #[inline(always)]
    pub fn set(&self, env: usize, value: S) {
        S::store(&self.row(env)[0], value);
    }

    /// The numbers of an environment, some at a time.
    #[inline(always)]
    pub fn parts<const N: usize>(&self, env: usize) -> impl Iterator<Item = [S; N]> {
        let parts = self.row(env).chunks_exact(N);
        parts.map(|cells| from_fn(|i| S::load(&cells[i])))
    }

    /// Replaces the row of an environment by as many values.
    #[inline(always)]
    pub fn put(&self, env: usize, values: impl IntoIterator<Item = S>) {
        for (cell, value) in self.row(env).iter().zip(values) {
            S::store(cell, value);
        }
    }

    /// Whether all bits of an environment's row are zero.
    #[inline(always)]
    pub fn is_blank(&self, env: usize) -> bool {
        self.row(env)
            .iter()
            .fold(0, |bits, cell| bits | S::bits(cell))
            == 0
    }
}

impl<S: Lanewise> Cells<'_, S> {
    /// Copies the row of an environment into lane `lane` of `out`, as long as a row.
    #[inline(always)]
    pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, out: &mut [T]) {
        let lanes = T::as_scalars_mut(out).chunks_exact_mut(T::LANES);
        for (lanes, cell) in lanes.zip(self.row(env)) {
            lanes[lane] = S::load(cell);
        }
    }

    /// Copies lane `lane` of `values`, as long as a row, into the row of an environment.
    #[inline(always)]
    pub fn write<T: Real<Scalar = S>>(&self, env: usize, lane: usize, values: &[T]) {
        self.write_part(env, 0, lane, values);
    }

    /// As [`write`](Self::write), into the numbers of the row from `start`.
    #[inline(always)]
    pub fn write_part<T: Real<Scalar = S>>(
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
