//! Solutions for the columns of a matrix, stored row by row. Loops run over the numbers of a row, so they fill
//! registers.

use super::{Tree, TreeFactor};
use clench_math::Real;

impl<T: Real> TreeFactor<T> {
    /// Computes `X ← A⁻¹ X` for X of nv rows of `width` numbers.
    pub fn solve_columns(&self, tree: &Tree, x: &mut [T], width: usize) {
        T::vectorize_rows(
            #[inline(always)]
            || {
                let multipliers = |i: usize| {
                    let lower = &self.lower[tree.row_start(i)..][..tree.depth(i)];
                    tree.row(i).iter().zip(lower)
                };
                for i in (0..tree.nv()).rev() {
                    let (above, own) = x[..(i + 1) * width].split_at_mut(i * width);
                    for (&j, &multiplier) in multipliers(i) {
                        subtract(&mut above[j as usize * width..][..width], own, multiplier);
                    }
                }
                for i in 0..tree.nv() {
                    let (above, own) = x[..(i + 1) * width].split_at_mut(i * width);
                    let inverse = self.inverse[i];
                    own.iter_mut().for_each(|x| *x *= inverse);
                    for (&j, &multiplier) in multipliers(i) {
                        subtract(own, &above[j as usize * width..][..width], multiplier);
                    }
                }
            },
        );
    }
}

/// Computes `x −= factor · y`.
#[inline(always)]
fn subtract<T: Real>(x: &mut [T], y: &[T], factor: T) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x -= factor * y;
    }
}
