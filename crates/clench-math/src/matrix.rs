//! 3 × 3 matrices, stored by rows.

use crate::{Real, Vec3};
use std::ops::Mul;

/// A 3 × 3 matrix. As a rotation it maps local coordinates to the outer frame; its columns are the local axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mat3<T> {
    /// The rows.
    pub rows: [Vec3<T>; 3],
}

impl<T: Real> Mat3<T> {
    /// The zero matrix.
    pub const ZERO: Self = Mat3 {
        rows: [Vec3::ZERO; 3],
    };
    /// The identity.
    pub const IDENTITY: Self = Mat3 {
        rows: [
            Vec3::new(T::ONE, T::ZERO, T::ZERO),
            Vec3::new(T::ZERO, T::ONE, T::ZERO),
            Vec3::new(T::ZERO, T::ZERO, T::ONE),
        ],
    };

    /// Creates a matrix from three rows.
    #[inline(always)]
    pub const fn from_rows(a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) -> Self {
        Mat3 { rows: [a, b, c] }
    }
    /// Creates a matrix from three columns.
    #[inline(always)]
    pub fn from_columns(a: Vec3<T>, b: Vec3<T>, c: Vec3<T>) -> Self {
        Mat3::from_rows(a, b, c).transpose()
    }
    /// Creates a diagonal matrix.
    #[inline(always)]
    pub fn diagonal(d: Vec3<T>) -> Self {
        let o = T::ZERO;
        Mat3::from_rows(
            Vec3::new(d.x, o, o),
            Vec3::new(o, d.y, o),
            Vec3::new(o, o, d.z),
        )
    }
    /// Returns column `j`.
    #[inline(always)]
    pub fn column(&self, j: usize) -> Vec3<T> {
        Vec3::new(self.rows[0][j], self.rows[1][j], self.rows[2][j])
    }
    /// Returns the transpose.
    #[inline(always)]
    pub fn transpose(&self) -> Self {
        Mat3::from_rows(self.column(0), self.column(1), self.column(2))
    }
    /// Computes `selfᵀ v` without forming the transpose.
    #[inline(always)]
    pub fn transpose_mul(&self, v: Vec3<T>) -> Vec3<T> {
        self.rows[0] * v.x + self.rows[1] * v.y + self.rows[2] * v.z
    }
    /// Creates the same constant matrix in every lane, by rows.
    #[inline(always)]
    pub fn from_f64(m: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = m;
        Mat3::from_rows(Vec3::from_f64(a), Vec3::from_f64(b), Vec3::from_f64(c))
    }
    /// Returns the determinant.
    #[inline(always)]
    pub fn determinant(&self) -> T {
        self.rows[0].dot(self.rows[1].cross(self.rows[2]))
    }
    /// Selects entry by entry: `yes` where the mask is true, else `no`.
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (yes.rows, no.rows);
        Mat3::from_rows(
            Vec3::select(mask, a, d),
            Vec3::select(mask, b, e),
            Vec3::select(mask, c, f),
        )
    }
}

impl<T: Real> Mul<Vec3<T>> for Mat3<T> {
    type Output = Vec3<T>;
    #[inline(always)]
    fn mul(self, v: Vec3<T>) -> Vec3<T> {
        Vec3::new(
            self.rows[0].dot(v),
            self.rows[1].dot(v),
            self.rows[2].dot(v),
        )
    }
}
impl<T: Real> Mul for Mat3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let [a, b, c] = self.rows;
        Mat3::from_rows(o.transpose_mul(a), o.transpose_mul(b), o.transpose_mul(c))
    }
}
