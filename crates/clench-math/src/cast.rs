//! Conversions between plain rows and lanes.

use crate::Real;

/// Converts constants, each the same in every lane.
#[inline(always)]
pub fn cast<T: Real, const K: usize>(values: [f64; K]) -> [T; K] {
    let mut out = [T::ZERO; K];
    broadcast(&values, &mut out);
    out
}

/// Writes the same row into every lane. Both slices must have the same length.
#[inline(always)]
pub fn broadcast<T: Real>(row: &[f64], out: &mut [T]) {
    assert_eq!(row.len(), out.len(), "row and lanes differ in length");
    for (out, &value) in out.iter_mut().zip(row) {
        *out = T::new(value);
    }
}

/// Writes one environment's row into lane `lane`. Both slices must have the same length.
#[inline(always)]
pub fn write_lane<T: Real>(row: &[T::Scalar], lane: usize, out: &mut [T]) {
    assert_eq!(row.len(), out.len(), "row and lanes differ in length");
    let lanes = T::as_scalars_mut(out).chunks_exact_mut(T::LANES);
    for (lanes, &value) in lanes.zip(row) {
        lanes[lane] = value;
    }
}

/// Reads one environment's row from lane `lane`. Both slices must have the same length.
#[inline(always)]
pub fn read_lane<T: Real>(values: &[T], lane: usize, row: &mut [T::Scalar]) {
    assert_eq!(row.len(), values.len(), "row and lanes differ in length");
    let lanes = T::as_scalars(values).chunks_exact(T::LANES);
    for (row, lanes) in row.iter_mut().zip(lanes) {
        *row = lanes[lane];
    }
}
