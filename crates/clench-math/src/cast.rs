//! Plain `f64` rows, as users see them, in and out of lanes.

use crate::{Real, Scalar};

/// Constants, each the same in every lane.
#[inline(always)]
pub fn cast<T: Real, const K: usize>(values: [f64; K]) -> [T; K] {
    values.map(T::new)
}

/// Writes the same row into every lane; both slices have the same length.
pub fn broadcast<T: Real>(row: &[f64], out: &mut [T]) {
    assert_eq!(row.len(), out.len(), "row and lanes differ in length");
    for (out, &value) in out.iter_mut().zip(row) {
        *out = T::new(value);
    }
}

/// Writes one environment's row into lane `lane`; both slices have the same length.
pub fn write_lane<T: Real>(row: &[f64], lane: usize, out: &mut [T]) {
    assert_eq!(row.len(), out.len(), "row and lanes differ in length");
    for (out, &value) in out.iter_mut().zip(row) {
        out.set_lane(lane, T::Scalar::new(value));
    }
}

/// Reads one environment's row out of lane `lane`; both slices have the same length.
pub fn read_lane<T: Real>(values: &[T], lane: usize, row: &mut [f64]) {
    assert_eq!(row.len(), values.len(), "row and lanes differ in length");
    for (row, value) in row.iter_mut().zip(values) {
        *row = value.lane(lane).to_f64();
    }
}
