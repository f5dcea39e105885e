//! The result of drawing.

/// The pictures of a simulation, one after another: rows from the top, pixels from the left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// The number of pixels in a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The red, green and blue of each pixel, sRGB.
    pub rgb: Vec<u8>,
    /// The distance of the surface at each pixel, along the viewing direction, m; infinite for the background.
    pub depth: Vec<f32>,
    /// The geom at each pixel, −1 for none.
    pub geoms: Vec<i32>,
}

/// The memory that pictures are written into, one after another as in an [`Image`]; empty for what is not wanted.
#[derive(Debug, Default)]
pub struct Planes<'a> {
    /// The red, green and blue of each pixel, sRGB.
    pub rgb: &'a mut [u8],
    /// The distance of the surface at each pixel, m.
    pub depth: &'a mut [f32],
    /// The geom at each pixel.
    pub geoms: &'a mut [i32],
}

impl Planes<'_> {
    /// Returns the same memory for a shorter time.
    pub fn reborrow(&mut self) -> Planes<'_> {
        Planes {
            rgb: self.rgb,
            depth: self.depth,
            geoms: self.geoms,
        }
    }
}
