//! What was drawn.

/// A picture: rows from the top, pixels from the left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, sRGB.
    pub rgb: Vec<u8>,
    /// Distance of what each pixel shows, along the direction in which the camera looks, m; infinite where it shows nothing.
    pub depth: Vec<f32>,
    /// The geom that each pixel shows, −1 for none.
    pub geoms: Vec<i32>,
}
