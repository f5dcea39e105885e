//! The result of drawing.

/// An image: rows from the top, pixels from the left.
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
