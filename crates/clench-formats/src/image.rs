//! PNG images.

use crate::spending::Spending;
use std::io::Cursor;

/// The bytes of a palette entry.
const PALETTE_ENTRY: usize = 3;

/// An image with 8 bits per sample.
pub(crate) struct Image {
    /// The number of pixels in a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The number of samples of a pixel: grey, or red, green and blue; an opacity may follow.
    pub samples: usize,
    line: usize,
    bytes: Vec<u8>,
}

impl Image {
    /// Reads a PNG image, of 16-bit samples the upper 8 bits. First counts `cost` bytes per pixel against the budget.
    ///
    /// # Errors
    /// Returns a message if the bytes are invalid.
    pub(crate) fn read(bytes: &[u8], cost: u64, spending: &mut Spending) -> Result<Self, String> {
        let wrong = |error: png::DecodingError| format!("not a valid PNG image: {error}");
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(wrong)?;
        // The decoder assumes that palette entries are complete.
        let palette = reader.info().palette.as_ref().map_or(0, |p| p.len());
        if palette % PALETTE_ENTRY != 0 {
            return Err(format!(
                "not a valid PNG image: a palette of {palette} bytes"
            ));
        }
        let (width, height) = reader.info().size();
        let pixels = u64::from(width).saturating_mul(u64::from(height));
        spending
            .bytes(pixels.saturating_mul(cost))
            .map_err(|excess| format!("an image of {width} x {height} pixels: {excess}"))?;
        let size = reader.output_buffer_size();
        let mut bytes = vec![0; size.ok_or("the PNG image is too large")?];
        let frame = reader.next_frame(&mut bytes).map_err(wrong)?;
        Ok(Image {
            width: frame.width as usize,
            height: frame.height as usize,
            samples: frame.color_type.samples(),
            line: frame.line_size,
            bytes,
        })
    }

    /// Returns the rows of pixels, from the top.
    pub(crate) fn rows(&self) -> impl DoubleEndedIterator<Item = impl Iterator<Item = &[u8]>> {
        let lines = self.bytes.chunks_exact(self.line).take(self.height);
        lines.map(|line| line.chunks_exact(self.samples).take(self.width))
    }
}
