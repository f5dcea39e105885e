//! The destination of derivatives of generalized forces by positions, velocities and other numbers.

use clench_math::Real;

/// Derivatives of the force along each dof, a row for each: by each position, each velocity, then other numbers, a
/// column for each.
#[derive(Debug)]
pub enum ForceDerivatives<'a, T> {
    /// A dense matrix.
    Matrix {
        /// The numbers, row after row.
        values: &'a mut [T],
        /// The distance from one row to the next.
        width: usize,
    },
    /// The product of a row vector with the matrix.
    Product {
        /// The vector (nv).
        factors: &'a [T],
        /// The product.
        row: &'a mut [T],
    },
    /// Summands of entries: row, column and number.
    List(&'a mut Vec<(usize, usize, T)>),
}

impl<T: Real> ForceDerivatives<'_, T> {
    /// Adds to an entry.
    #[inline(always)]
    pub fn add(&mut self, row: usize, column: usize, x: T) {
        match self {
            ForceDerivatives::Matrix { values, width } => values[row * *width + column] += x,
            ForceDerivatives::Product {
                factors,
                row: product,
            } => product[column] += factors[row] * x,
            ForceDerivatives::List(entries) => entries.push((row, column, x)),
        }
    }
}
