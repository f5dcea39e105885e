//! Height fields: terrain as a grid of heights.

use clench_math::Vec3;

/// A solid: a grid of heights over a rectangle, on a base.
///
/// Heights are fractions of the elevation, between 0 and 1. Rows are ordered along y, columns along x, both from the
/// negative end. The cell between four heights consists of two triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    rows: usize,
    columns: usize,
    heights: Vec<f64>,
    half: [f64; 2],
    elevation: f64,
    base: f64,
}

/// An invalid height field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HeightFieldError {
    /// Fewer than two rows or columns.
    #[error("a height field needs at least two rows and columns, not {0} x {1}")]
    TooFew(usize, usize),
    /// A wrong number of heights.
    #[error("{rows} rows and {columns} columns need {} heights, not {found}", rows.saturating_mul(*columns))]
    WrongCount {
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        columns: usize,
        /// The number of heights.
        found: usize,
    },
    /// A height is NaN or infinite.
    #[error("height {0} is not a finite number")]
    NotFinite(usize),
    /// A size is not positive and finite.
    #[error("size[{0}] must be positive and finite, but is {1}")]
    Size(usize, f64),
}

impl HeightField {
    /// Creates a field from rows of heights in any unit, which are normalized to 0 for the lowest and 1 for the highest
    /// (all 0 if they are equal). `size`, in metres: half lengths along x and y, elevation of the highest over the
    /// lowest, depth of the base below the lowest.
    ///
    /// # Errors
    /// Returns an error if counts do not match, or a height or size is invalid.
    pub fn new(
        rows: usize,
        columns: usize,
        mut heights: Vec<f64>,
        size: [f64; 4],
    ) -> Result<Self, HeightFieldError> {
        if rows < 2 || columns < 2 {
            return Err(HeightFieldError::TooFew(rows, columns));
        }
        if rows.checked_mul(columns) != Some(heights.len()) {
            return Err(HeightFieldError::WrongCount {
                rows,
                columns,
                found: heights.len(),
            });
        }
        if let Some(bad) = heights.iter().position(|height| !height.is_finite()) {
            return Err(HeightFieldError::NotFinite(bad));
        }
        let positive = |s: f64| s > 0.0 && s.is_finite();
        if let Some(bad) = size.iter().position(|&s| !positive(s)) {
            return Err(HeightFieldError::Size(bad, size[bad]));
        }
        normalize(&mut heights);
        let [x, y, elevation, base] = size;
        Ok(HeightField {
            rows,
            columns,
            heights,
            half: [x, y],
            elevation,
            base,
        })
    }

    /// Returns the number of rows, along y.
    pub fn rows(&self) -> usize {
        self.rows
    }
    /// Returns the number of columns, along x.
    pub fn columns(&self) -> usize {
        self.columns
    }
    /// Returns all heights as fractions of the elevation, row by row.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }
    /// Returns half lengths along x and y, elevation, base, m.
    pub fn size(&self) -> [f64; 4] {
        [self.half[0], self.half[1], self.elevation, self.base]
    }
    /// Returns a grid point of the surface, m.
    pub fn point(&self, row: usize, column: usize) -> Vec3<f64> {
        let along = |index: usize, count: usize, half: f64| {
            half * (2.0 * index as f64 / (count - 1) as f64 - 1.0)
        };
        Vec3::new(
            along(column, self.columns, self.half[0]),
            along(row, self.rows, self.half[1]),
            self.elevation * self.heights[row * self.columns + column],
        )
    }
    /// Returns the height of the surface at a point of the rectangle, m; outside, that at the nearest point of its
    /// edge. A cell's diagonal, between its two triangles, runs from its first corner to its last.
    pub fn height_at(&self, x: f64, y: f64) -> f64 {
        let cell = |v: f64, half: f64, count: usize| {
            let along =
                ((v + half) / (2.0 * half) * (count - 1) as f64).clamp(0.0, (count - 1) as f64);
            let first = (along as usize).min(count - 2);
            (first, along - first as f64)
        };
        let (column, u) = cell(x, self.half[0], self.columns);
        let (row, v) = cell(y, self.half[1], self.rows);
        let z = |r: usize, c: usize| self.heights[(row + r) * self.columns + column + c];
        let part = if u >= v {
            z(0, 0) + u * (z(0, 1) - z(0, 0)) + v * (z(1, 1) - z(0, 1))
        } else {
            z(0, 0) + u * (z(1, 1) - z(1, 0)) + v * (z(1, 0) - z(0, 0))
        };
        self.elevation * part
    }
    /// Returns the radius of a sphere about the origin that encloses the field, m (MuJoCo's `geom_rbound`).
    pub fn radius(&self) -> f64 {
        let [x, y] = self.half;
        Vec3::new(x, y, self.elevation.max(self.base)).norm()
    }
}

fn normalize(heights: &mut [f64]) {
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for height in heights {
        *height = match high > low {
            // Halved first to avoid overflow of the differences.
            true => (0.5 * *height - 0.5 * low) / (0.5 * high - 0.5 * low),
            false => 0.0,
        };
    }
}
