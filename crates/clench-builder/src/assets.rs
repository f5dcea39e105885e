//! Height fields, as their author gives them.

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
    /// Heights in any unit, row after row from the negative end; the lowest counts as 0, the highest as the elevation.
    pub heights: Vec<f64>,
    /// Half lengths along x and y, elevation, depth of the base below the lowest height, m.
    pub size: [f64; 4],
    /// The place in the file, if it came from one.
    pub origin: Option<Origin>,
}
