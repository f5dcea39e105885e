//! The constraint Jacobian as an operator: J x, Jᵀ f, and Jᵀ W J added to a Hessian.
//!
//! The solver needs nothing else, so rows need not be stored if another form is cheaper.

use crate::block_index::BlockIndex;
use crate::costs::{Form, MAX_DIM, Weight};
use crate::tree::Tree;
use clench_math::{Real, array, kernel};
use std::ops::Range;

/// The operations on J that the solver needs.
pub(crate) trait Jacobian<T: Real> {
    /// Computes `out = J x`.
    fn mul(&self, x: &[T], out: &mut [T]);
    /// Computes `out += Jᵀ f`.
    fn add_transposed(&self, f: &[T], out: &mut [T]);
    /// Computes `out += |J|ᵀ |f|`, the magnitude of the terms of `Jᵀ f`.
    fn add_transposed_sizes(&self, f: &[T], out: &mut [T]);
    /// Computes `hessian += Jᵀ W J` in a pattern that has an entry for any two dofs of a block, or in the rows that the
    /// pattern contains. `weigh` writes the Hessian block of a constraint. (Inlined, so the caller chooses the
    /// instruction set.)
    fn add_gram(
        &self,
        weigh: impl FnMut(&BlockIndex, &mut Weight<T>) -> Form,
        pattern: &impl Pattern,
        hessian: &mut [T],
    );
}

/// The storage pattern of a symmetric matrix.
pub(crate) trait Pattern {
    /// Returns true if the pattern contains the rows of any of these dofs.
    #[inline(always)]
    fn holds_any(&self, _dofs: &[u32]) -> bool {
        true
    }
    /// Calls `act` for parts of the lower triangle over `dofs` (ascending) that cover the rows contained in the
    /// pattern.
    fn each_part(&self, dofs: &[u32], act: impl FnMut(&Part));
}

/// Entries of some rows, by index in the dofs, in columns that are stored contiguously.
pub(crate) struct Part {
    pub rows: Range<usize>,
    /// The columns. If `triangle` is set, each row ends with its diagonal instead.
    pub columns: Range<usize>,
    pub triangle: bool,
    /// The offset of the first entry, and the stride from one row to the next.
    pub offset: usize,
    pub stride: usize,
}

impl Part {
    /// Returns the columns of a row, and the offset of its first entry.
    #[inline(always)]
    pub(crate) fn row(&self, row: usize) -> (Range<usize>, usize) {
        let end = if self.triangle {
            row + 1
        } else {
            self.columns.end
        };
        let offset = self.offset + (row - self.rows.start) * self.stride;
        (self.columns.start..end, offset)
    }
}

impl Pattern for Tree {
    #[inline(always)]
    fn each_part(&self, dofs: &[u32], mut act: impl FnMut(&Part)) {
        // Runs of dofs that are neighbours in their path, hence in every row that contains them.
        let mut rest = 0..dofs.len();
        while let Some(first) = rest.next() {
            let depth = self.depth(dofs[first] as usize);
            let follows = |&k: &usize| self.depth(dofs[k] as usize) == depth + k - first;
            let end = first + 1 + rest.clone().take_while(follows).count();
            rest.start = end;
            for row in first..dofs.len() {
                act(&Part {
                    rows: row..row + 1,
                    columns: first..end.min(row + 1),
                    triangle: false,
                    offset: self.row_start(dofs[row] as usize) + depth,
                    stride: 0,
                });
            }
        }
    }
}

/// Rows stored block by block, over the dofs on which the block acts.
#[derive(Clone, Debug)]
pub(crate) struct StoredRows<T> {
    pub blocks: Vec<BlockIndex>,
    pub dofs: Vec<u32>,
    pub values: Vec<T>,
}

impl<T> Default for StoredRows<T> {
    fn default() -> Self {
        StoredRows {
            blocks: Vec::new(),
            dofs: Vec::new(),
            values: Vec::new(),
        }
    }
}

impl<T: Real> StoredRows<T> {
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
        self.dofs.clear();
        self.values.clear();
    }

    /// Appends a block of zeros.
    #[inline(always)]
    pub(crate) fn push(&mut self, block: BlockIndex, dofs: &[u32]) {
        self.blocks.push(block);
        self.dofs.extend_from_slice(dofs);
        self.values
            .resize(block.value + block.dim * block.ndof, T::ZERO);
    }

    /// Appends a copy of another problem's block with these `values`, at the given row and active-set entry. Its dofs
    /// may be numbered in another order.
    #[inline(always)]
    pub(crate) fn push_copy<L: Copy>(
        &mut self,
        block: &BlockIndex,
        (row, active_start): (usize, usize),
        dofs: impl Iterator<Item = u32>,
        values: &[L],
        number: impl Fn(L) -> T,
    ) {
        let (dof, value) = (self.dofs.len(), self.values.len());
        self.blocks.push(BlockIndex {
            row,
            active_start,
            dof,
            value,
            ..*block
        });
        self.dofs.extend(dofs);
        let dofs = &mut self.dofs[dof..];
        if dofs.is_sorted() {
            self.values.extend(values.iter().map(|&j| number(j)));
            return;
        }
        // Two trees may have the opposite order here.
        let descends = |pair: &[u32]| pair[0] > pair[1];
        let first = dofs.windows(2).position(descends).map_or(0, |k| k + 1);
        dofs.rotate_left(first);
        let ascend = dofs.is_sorted();
        self.values.resize(value + values.len(), T::ZERO);
        let rows = values.chunks_exact(block.ndof.max(1));
        for (to, row) in self.values[value..]
            .chunks_exact_mut(block.ndof.max(1))
            .zip(rows)
        {
            let (before, after) = row.split_at(first);
            let (start, end) = to.split_at_mut(after.len());
            for (to, from) in [(start, after), (end, before)] {
                for (to, &j) in to.iter_mut().zip(from) {
                    *to = number(j);
                }
            }
        }
        if !ascend {
            self.sort_last();
        }
    }

    /// Sorts the columns of the last block by dof.
    #[inline(always)]
    fn sort_last(&mut self) {
        let Some(b) = self.blocks.last() else { return };
        let dofs = &mut self.dofs[b.dof..];
        let rows = &mut self.values[b.value..];
        for column in 1..b.ndof {
            let index = dofs[..column].partition_point(|&dof| dof < dofs[column]);
            if index < column {
                dofs[index..=column].rotate_right(1);
                for row in rows.chunks_exact_mut(b.ndof) {
                    row[index..=column].rotate_right(1);
                }
            }
        }
    }

    #[inline(always)]
    pub(crate) fn dofs(&self, b: &BlockIndex) -> &[u32] {
        &self.dofs[b.dof..b.dof + b.ndof]
    }

    #[inline(always)]
    pub(crate) fn values(&self, b: &BlockIndex) -> &[T] {
        &self.values[b.value..b.value + b.dim * b.ndof]
    }

    #[inline(always)]
    pub(crate) fn values_mut(&mut self, b: &BlockIndex) -> &mut [T] {
        &mut self.values[b.value..b.value + b.dim * b.ndof]
    }

    /// Returns the rows of a block; their number is known at compile time.
    #[inline(always)]
    fn rows<const DIM: usize>(&self, b: &BlockIndex) -> [&[T]; DIM] {
        let values = self.values(b);
        let mut rows = [&values[..0]; DIM];
        for (i, row) in rows.iter_mut().enumerate() {
            *row = &values[i * b.ndof..(i + 1) * b.ndof];
        }
        rows
    }

    #[inline(always)]
    fn mul_block<const DIM: usize>(&self, b: &BlockIndex, x: &[T], out: &mut [T]) {
        let rows = self.rows::<DIM>(b);
        let mut sums = [T::ZERO; DIM];
        for (k, &dof) in self.dofs(b).iter().enumerate() {
            let x = x[dof as usize];
            for i in 0..DIM {
                sums[i] += rows[i][k] * x;
            }
        }
        out[b.rows()].copy_from_slice(&sums);
    }

    #[inline(always)]
    fn add_transposed_block<const DIM: usize>(&self, b: &BlockIndex, f: &[T], out: &mut [T]) {
        let rows = self.rows::<DIM>(b);
        let f: [T; DIM] = array(|i| f[b.row + i]);
        for (k, &dof) in self.dofs(b).iter().enumerate() {
            let mut sum = rows[0][k] * f[0];
            for i in 1..DIM {
                sum += rows[i][k] * f[i];
            }
            out[dof as usize] += sum;
        }
    }

    #[inline(always)]
    fn add_gram_block<const DIM: usize>(
        &self,
        b: &BlockIndex,
        weight: &Weight<T>,
        form: Form,
        pattern: &impl Pattern,
        hessian: &mut [T],
    ) {
        let rows = self.rows::<DIM>(b);
        pattern.each_part(
            self.dofs(b),
            #[inline(always)]
            |part| {
                for k in part.rows.clone() {
                    let wj = weigh_column::<T, DIM>(weight, form, &array(|i| rows[i][k]));
                    let (columns, offset) = part.row(k);
                    let values = &mut hessian[offset..offset + columns.len()];
                    let rows: [&[T]; DIM] = array(|i| &rows[i][columns.clone()]);
                    add_weighted(&wj, &rows, values);
                }
            },
        );
    }
}

/// Adds to each value the product of its column of `rows` with the column `weights`.
#[inline(always)]
fn add_weighted<T: Real, const DIM: usize>(
    weights: &[T; DIM],
    rows: &[&[T]; DIM],
    values: &mut [T],
) {
    let mut column = 0;
    while column < values.len() {
        // Six columns are those of a free body; they fill registers even in a single environment.
        column += match values.len() - column {
            6.. => add_columns::<T, DIM, 6>(weights, rows, values, column),
            2.. => add_columns::<T, DIM, 2>(weights, rows, values, column),
            _ => add_columns::<T, DIM, 1>(weights, rows, values, column),
        };
    }
}

/// Does the same for N columns; returns N.
#[inline(always)]
fn add_columns<T: Real, const DIM: usize, const N: usize>(
    weights: &[T; DIM],
    rows: &[&[T]; DIM],
    values: &mut [T],
    first: usize,
) -> usize {
    let rows: [&[T]; DIM] = array(|i| &rows[i][first..first + N]);
    let values = &mut values[first..first + N];
    let mut sums: [T; N] = array(|c| weights[0] * rows[0][c]);
    for i in 1..DIM {
        for c in 0..N {
            sums[c] += weights[i] * rows[i][c];
        }
    }
    for c in 0..N {
        values[c] += sums[c];
    }
    N
}

/// Computes W j for one column of a block.
#[inline(always)]
fn weigh_column<T: Real, const DIM: usize>(
    weight: &Weight<T>,
    form: Form,
    j: &[T; DIM],
) -> [T; DIM] {
    match form {
        Form::Zero => [T::ZERO; DIM],
        Form::Diagonal => array(
            #[inline(always)]
            |i| weight[i][i] * j[i],
        ),
        Form::Arrow => {
            let mut first = weight[0][0] * j[0];
            for i in 1..DIM {
                first += weight[0][i] * j[i];
            }
            array(
                #[inline(always)]
                |i| {
                    if i == 0 {
                        first
                    } else {
                        weight[0][i] * j[0] + weight[i][i] * j[i]
                    }
                },
            )
        }
        Form::Full => array(
            #[inline(always)]
            |i| {
                let mut sum = weight[i][0] * j[0];
                for k in 1..DIM {
                    sum += weight[i][k] * j[k];
                }
                sum
            },
        ),
    }
}

/// Evaluates an expression with the constant `$dim` set to a number of rows.
macro_rules! with_dim {
    ($value:expr, $dim:ident => $body:expr) => {
        match $value {
            1 => {
                const $dim: usize = 1;
                $body
            }
            2 => {
                const $dim: usize = 2;
                $body
            }
            3 => {
                const $dim: usize = 3;
                $body
            }
            4 => {
                const $dim: usize = 4;
                $body
            }
            5 => {
                const $dim: usize = 5;
                $body
            }
            _ => {
                const $dim: usize = MAX_DIM;
                $body
            }
        }
    };
}

impl<T: Real> StoredRows<T> {
    /// Computes `out += Jᵀ f` for some of the blocks.
    #[kernel]
    pub(crate) fn add_transposed_of(&self, blocks: &[BlockIndex], f: &[T], out: &mut [T]) {
        for b in blocks {
            with_dim!(b.dim, DIM => self.add_transposed_block::<DIM>(b, f, out));
        }
    }
}

impl<T: Real> Jacobian<T> for StoredRows<T> {
    #[kernel]
    fn mul(&self, x: &[T], out: &mut [T]) {
        for b in &self.blocks {
            with_dim!(b.dim, DIM => self.mul_block::<DIM>(b, x, out));
        }
    }

    #[kernel]
    fn add_transposed(&self, f: &[T], out: &mut [T]) {
        self.add_transposed_of(&self.blocks, f, out);
    }

    #[kernel]
    fn add_transposed_sizes(&self, f: &[T], out: &mut [T]) {
        for b in &self.blocks {
            let dofs = self.dofs(b);
            let rows = self.values(b).chunks_exact(dofs.len().max(1));
            for (row, &f) in rows.zip(&f[b.rows()]) {
                for (&j, &dof) in row.iter().zip(dofs) {
                    out[dof as usize] += (j * f).abs();
                }
            }
        }
    }

    #[inline(always)]
    fn add_gram(
        &self,
        mut weigh: impl FnMut(&BlockIndex, &mut Weight<T>) -> Form,
        pattern: &impl Pattern,
        hessian: &mut [T],
    ) {
        let mut weight = [[T::ZERO; MAX_DIM]; MAX_DIM];
        let held = |b: &&BlockIndex| pattern.holds_any(self.dofs(b));
        for b in self.blocks.iter().filter(held) {
            let form = weigh(b, &mut weight);
            if form != Form::Zero {
                with_dim!(b.dim, DIM => self.add_gram_block::<DIM>(b, &weight, form, pattern, hessian));
            }
        }
    }
}
