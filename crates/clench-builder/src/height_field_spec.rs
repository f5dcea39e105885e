//! Descriptions of height fields.

use super::Origin;

/// A height field: terrain that geoms refer to by name.
#[derive(Clone, Debug, Default)]
pub struct HeightFieldSpec {
    /// Name.
    pub name: String,
    /// Rows, along y, at least two.
    pub rows: usize,
    /// Columns, along x, at least two.
    pub columns: usize,
    /// Heights in any unit, row after row from the negative end; the lowest maps to 0, the highest to the elevation.
    pub heights: Vec<f64>,
    /// Half lengths along x and y, elevation, depth of the base below the lowest height, m.
    pub size: [f64; 4],
    /// The source location, if it came from a file.
    pub origin: Option<Origin>,
}
