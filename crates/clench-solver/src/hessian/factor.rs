//! Assembly, factorization and solution.
//!
//! With U = D L, row i of the factorization is `U_i = H_i − Σ_{k > i} (U_ki / D_k) U_k`, over the rows k with an entry in
//! column i. A tile of row i stays in registers while the sum runs; every entry sums in the same order whatever the
//! pattern. The last tile of a row reaches past the diagonal: what is computed there is never used.

use super::Pattern;
use super::pattern::TILE;
use crate::jacobian::{Jacobian, StoredRows};
use crate::{Tree, TreeMatrix};
use clench_math::{Real, Scalar};

/// H, then its factor, in place.
#[derive(Clone, Debug)]
pub(crate) struct Hessian<T> {
    pattern: Pattern,
    /// U = D L, row by row.
    values: Vec<T>,
    /// 1 / D.
    inverse: Vec<T>,
    /// The multipliers U_ki / D_k of one row.
    multipliers: Vec<T>,
}

impl<T: Real> Default for Hessian<T> {
    fn default() -> Self {
        Hessian {
            pattern: Pattern::default(),
            values: Vec::new(),
            inverse: Vec::new(),
            multipliers: Vec::new(),
        }
    }
}

impl<T: Real> Hessian<T> {
    /// Fits the pattern to a problem.
    pub fn prepare(&mut self, tree: &Tree, dense: bool, rows: &StoredRows<T>) {
        if self.pattern.prepare(tree, dense, &rows.blocks, &rows.dofs) {
            self.values.clear();
            self.values.resize(self.pattern.len(), T::ZERO);
            self.inverse.clear();
            self.inverse.resize(self.pattern.nv(), T::ZERO);
        }
    }

    /// Row `i` from column 0.
    #[inline(always)]
    pub fn row_mut(&mut self, i: usize) -> &mut [T] {
        &mut self.values[self.pattern.row_start(i)..self.pattern.row_start(i + 1)]
    }

    /// H = M.
    pub fn set(&mut self, tree: &Tree, mass: &TreeMatrix<T>) {
        for i in 0..self.pattern.nv() {
            let row = &mut self.values[self.pattern.row_start(i)..self.pattern.row_start(i + 1)];
            for &tile in self.pattern.tiles(i) {
                row[tile as usize..tile as usize + TILE].fill(T::ZERO);
            }
            for (&c, &m) in tree.row(i).iter().zip(mass.row(tree, i)) {
                row[c as usize] = m;
            }
        }
    }

    /// H = M + Jᵀ W J.
    pub fn assemble(
        &mut self,
        tree: &Tree,
        mass: &TreeMatrix<T>,
        rows: &impl Jacobian<T>,
        weigh: impl FnMut(
            &crate::jacobian::BlockIndex,
            &mut crate::costs::Weight<T>,
        ) -> crate::costs::Form,
    ) {
        self.set(tree, mass);
        rows.add_gram(weigh, self);
    }

    /// Factors in place. A pivot that rounding has consumed is replaced by its rounding error, so that the direction stays
    /// one of descent.
    pub fn factor(&mut self) {
        let Hessian {
            pattern,
            values,
            inverse,
            multipliers,
        } = self;
        let floor = T::splat(T::Scalar::EPSILON);
        for i in (0..pattern.nv()).rev() {
            let below = pattern.below(i);
            multipliers.clear();
            multipliers.extend(below.iter().map(|&k| {
                let k = k as usize;
                values[pattern.row_start(k) + i] * inverse[k]
            }));
            let (head, tail) = values.split_at_mut(pattern.row_start(i + 1));
            let row = &mut head[pattern.row_start(i)..];
            let diagonal = row[i];
            for &tile in pattern.tiles(i) {
                let tile = tile as usize;
                let mut sum: [T; TILE] = std::array::from_fn(|c| row[tile + c]);
                for (&k, &multiplier) in below.iter().zip(&*multipliers) {
                    let start = pattern.row_start(k as usize) - pattern.row_start(i + 1) + tile;
                    let other = &tail[start..start + TILE];
                    for c in 0..TILE {
                        sum[c] -= multiplier * other[c];
                    }
                }
                row[tile..tile + TILE].copy_from_slice(&sum);
            }
            inverse[i] = T::ONE / row[i].max(floor * diagonal);
        }
    }

    /// `x ← H⁻¹ x`.
    pub fn solve(&self, x: &mut [T]) {
        let Hessian {
            pattern,
            values,
            inverse,
            ..
        } = self;
        for k in (0..pattern.nv()).rev() {
            let scaled = x[k] * inverse[k];
            x[k] = scaled;
            let row = &values[pattern.row_start(k)..pattern.row_start(k + 1)];
            for &tile in pattern.tiles(k) {
                let tile = tile as usize;
                let end = k.min(tile + TILE);
                for (x, &u) in x[tile..end].iter_mut().zip(&row[tile..end]) {
                    *x -= scaled * u;
                }
            }
        }
        for k in 0..pattern.nv() {
            let row = &values[pattern.row_start(k)..pattern.row_start(k + 1)];
            let mut sum = T::ZERO;
            for &tile in pattern.tiles(k) {
                let tile = tile as usize;
                let end = k.min(tile + TILE);
                for (&x, &u) in x[tile..end].iter().zip(&row[tile..end]) {
                    sum += x * u;
                }
            }
            x[k] -= sum * inverse[k];
        }
    }
}
