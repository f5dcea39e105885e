//! Files of heights: PNG images and MuJoCo's binary grids.

use crate::spending::Spending;
use std::io::Cursor;

/// Rows of heights, along y from the negative end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elevation {
    pub rows: usize,
    pub columns: usize,
    pub heights: Vec<f64>,
}

/// What a height takes in all, bytes: it stands in the builder and in the model, and is a pixel before.
pub(crate) const HEIGHT: u64 = 24;

/// Reads an image: white is high. Of a coloured one the red channel counts, of 16 bits the upper 8, as in MuJoCo.
///
/// # Errors
/// What is wrong with the bytes.
pub(crate) fn read_png(bytes: &[u8], spending: &mut Spending) -> Result<Elevation, String> {
    let wrong = |error: png::DecodingError| format!("not a valid PNG image: {error}");
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(wrong)?;
    let (width, height) = reader.info().size();
    let pixels = u64::from(width).saturating_mul(u64::from(height));
    spending
        .bytes(pixels.saturating_mul(HEIGHT))
        .map_err(|excess| format!("an image of {width} x {height} pixels: {excess}"))?;
    let size = reader.output_buffer_size();
    let mut pixels = vec![0; size.ok_or("the PNG image is too large")?];
    let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
    let (rows, columns) = (frame.height as usize, frame.width as usize);
    let lines = pixels.chunks_exact(frame.line_size).take(rows).rev();
    let samples = frame.color_type.samples();
    Ok(Elevation {
        rows,
        columns,
        heights: lines
            .flat_map(|line| line.chunks_exact(samples).take(columns))
            .map(|pixel| f64::from(pixel[0]))
            .collect(),
    })
}

/// Reads a grid: two `i32`, rows and columns, then an `f32` a height.
///
/// # Errors
/// What is wrong with the bytes.
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
