//! Height data files: PNG images and MuJoCo's binary grids.

use crate::image::Image;
use crate::spending::Spending;

/// Rows of heights, along y from the negative end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elevation {
    pub rows: usize,
    pub columns: usize,
    pub heights: Vec<f64>,
}

/// The largest height range that counts as flat, as in MuJoCo.
const FLAT: f32 = 1e-14;

impl Elevation {
    /// Normalizes the heights to 0 (lowest) to 1 (highest), in single precision as in MuJoCo's compiler: their last
    /// bits affect ray casts. Heights that are not finite are unchanged, for the model to reject.
    pub(crate) fn in_parts(mut self) -> Self {
        let singles = || self.heights.iter().map(|&height| height as f32);
        let low = singles().fold(f32::INFINITY, f32::min);
        let span = singles().fold(f32::NEG_INFINITY, f32::max) - low;
        if span.is_finite() {
            let part = |height: f32| {
                if span > FLAT {
                    (height - low) / span
                } else {
                    0.0
                }
            };
            self.heights = singles().map(|height| f64::from(part(height))).collect();
        }
        self
    }
}

/// The total memory of a height, bytes: a pixel while reading, then an entry in the builder and in the model.
pub(crate) const HEIGHT: u64 = 24;

/// Reads an image; white is high. Uses the red channel, and the upper 8 of 16 bits, as MuJoCo does.
///
/// # Errors
/// Returns a message if the bytes are invalid.
pub(crate) fn read_png(bytes: &[u8], spending: &mut Spending) -> Result<Elevation, String> {
    let image = Image::read(bytes, HEIGHT, spending)?;
    Ok(Elevation {
        rows: image.height,
        columns: image.width,
        heights: (image.rows().rev().flatten())
            .map(|pixel| f64::from(pixel[0]))
            .collect(),
    })
}

/// Reads a grid: two `i32`, rows and columns, then one `f32` per height.
///
/// # Errors
/// Returns a message if the bytes are invalid.
pub(crate) fn read_grid(bytes: &[u8], spending: &mut Spending) -> Result<Elevation, String> {
    let (words, rest) = bytes.as_chunks::<4>();
    let [rows, columns, heights @ ..] = words else {
        return Err("too short for a height field".to_owned());
    };
    let [rows, columns] = [*rows, *columns].map(i32::from_le_bytes);
    let expected = i64::from(rows) * i64::from(columns);
    if rows < 1 || columns < 1 || expected != heights.len() as i64 || !rest.is_empty() {
        return Err(format!(
            "a height field of {rows} rows and {columns} columns does not fit into {} bytes",
            bytes.len()
        ));
    }
    spending.bytes(HEIGHT * heights.len() as u64)?;
    Ok(Elevation {
        rows: rows as usize,
        columns: columns as usize,
        heights: (heights.iter())
            .map(|&word| f64::from(f32::from_le_bytes(word)))
            .collect(),
    })
}
