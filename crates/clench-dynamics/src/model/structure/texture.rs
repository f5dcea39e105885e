//! Textures: those of files, and those that are computed from a few numbers by the rules of MuJoCo's compiler.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
use std::sync::Arc;

/// A texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name.
    pub name: String,
    /// The surface that it covers.
    pub kind: TextureKind,
    /// Its picture.
    pub picture: TexturePicture,
}

/// The surface that a texture covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureKind {
    /// A plane, or a mesh by its texture coordinates.
    Plane,
    /// A cube around a geom: six square pictures below each other, as seen from inside: right (x), left, up (y), down,
    /// front (z) and back. A single square picture is on all sides.
    Cube,
    /// A skybox, with z up.
    Sky,
}

/// The picture of a texture.
#[derive(Clone, Debug, PartialEq)]
pub enum TexturePicture {
    /// An image from a file.
    Pixels(Arc<Pixels>),
    /// A pattern.
    Computed(Pattern),
}

/// Rows of pixels from the top, of three bytes each: red, green, blue, as displayed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pixels {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// All pixels (3 × width × height).
    pub rgb: Vec<u8>,
}

/// A picture that is computed from a few numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// The base pattern.
    pub pattern: TexturePattern,
    /// First colour, each part from 0 to 1.
    pub rgb1: [f64; 3],
    /// Second colour.
    pub rgb2: [f64; 3],
    /// The mark drawn over it.
    pub mark: TextureMark,
    /// Colour of the mark.
    pub markrgb: [f64; 3],
    /// Width and height of a plane, or of a side of a cube, pixels.
    pub size: [usize; 2],
}

/// The base pattern of a computed texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexturePattern {
    /// A gradient from the first colour at the edges, or below, to the second in the middle, or above.
    Gradient,
    /// Two by two fields.
    Checker,
    /// The first colour; the second on the lower side of a cube.
    Flat,
}

/// The mark drawn over a computed texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextureMark {
    /// Nothing.
    None,
    /// Its edges.
    Edge,
    /// A cross in the middle.
    Cross,
    /// Random dots: each pixel is one with this probability. They are the same each time, but differ from MuJoCo's.
    Random(f64),
}

impl Texture {
    /// Returns its pixels; those of a pattern are computed on each call.
    pub fn pixels(&self) -> Arc<Pixels> {
        match &self.picture {
            TexturePicture::Pixels(pixels) => Arc::clone(pixels),
            TexturePicture::Computed(pattern) => Arc::new(match self.kind {
                TextureKind::Plane => pattern.side(Side::Plane),
                TextureKind::Cube | TextureKind::Sky => pattern.cube(),
            }),
        }
    }

    /// Returns the mean of its colours, from 0 to 1.
    pub fn mean(&self) -> [f64; 3] {
        let pixels = self.pixels();
        let (rows, _) = pixels.rgb.as_chunks::<3>();
        let count = 255.0 * rows.len().max(1) as f64;
        [0, 1, 2].map(|k| rows.iter().map(|pixel| f64::from(pixel[k])).sum::<f64>() / count)
    }
}

/// A side of a pattern.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Plane,
    /// The right or left side of a cube.
    Beside,
    Up,
    Down,
    /// The front or back.
    Ahead,
}

/// The sides of a cube in their order.
const SIDES: [Side; 6] = [
    Side::Beside,
    Side::Beside,
    Side::Up,
    Side::Down,
    Side::Ahead,
    Side::Ahead,
];

impl Pattern {
    fn cube(&self) -> Pixels {
        let width = self.size[0];
        let square = Pattern {
            size: [width; 2],
            ..self.clone()
        };
        Pixels {
            width,
            height: 6 * width,
            rgb: (SIDES.iter())
                .flat_map(|&side| square.side(side).rgb)
                .collect(),
        }
    }

    fn side(&self, side: Side) -> Pixels {
        let [width, height] = self.size;
        let mut dots = Dots(0);
        let pixel = |row: usize, column: usize| {
            let painted = match self.pattern {
                TexturePattern::Gradient => self.gradient(side, row, column),
                TexturePattern::Checker => self.checker(side, row, column),
                TexturePattern::Flat if side == Side::Down => self.rgb2,
                TexturePattern::Flat => self.rgb1,
            };
            let marked = match self.mark {
                TextureMark::None => false,
                TextureMark::Edge => {
                    row == 0 || column == 0 || row == height - 1 || column == width - 1
                }
                TextureMark::Cross => row == height / 2 || column == width / 2,
                TextureMark::Random(probability) => dots.next() < probability,
            };
            bytes(if marked { self.markrgb } else { painted })
        };
        let mut pixel = pixel;
        let mut rgb = Vec::with_capacity(3 * width * height);
        for row in 0..height {
            (0..width).for_each(|column| rgb.extend(pixel(row, column)));
        }
        Pixels { width, height, rgb }
    }

    /// Returns the colour of a checker field. Opposite fields have the same colour; front and back have them swapped.
    fn checker(&self, side: Side, row: usize, column: usize) -> [f64; 3] {
        let same = (row < self.size[1] / 2) == (column < self.size[0] / 2);
        match same == (side != Side::Ahead) {
            true => self.rgb1,
            false => self.rgb2,
        }
    }

    /// Computes a gradient by the distance from the middle of a plane, or by the elevation above the middle of a cube.
    fn gradient(&self, side: Side, row: usize, column: usize) -> [f64; 3] {
        let along = |k: usize, count: usize| 2.0 * k as f64 / (count as f64 - 1.0) - 1.0;
        let (x, y) = (along(column, self.size[0]), -along(row, self.size[1]));
        let far = (1.0 + x * x + y * y).sqrt();
        let upwards = || 1.0 - (1.0 / far).acos() / FRAC_PI_2;
        match side {
            Side::Plane => blend(self.rgb2, self.rgb1, 2.0 * (x * x + y * y).sqrt() - 1.0),
            Side::Up => blend(self.rgb1, self.rgb2, upwards()),
            Side::Down => blend(self.rgb1, self.rgb2, -upwards()),
            Side::Beside | Side::Ahead => blend(self.rgb1, self.rgb2, (y / far).asin() / FRAC_PI_2),
        }
    }
}

/// Blends two colours: the first at `at` = 1, the second at −1, between them along a sigmoid.
fn blend(first: [f64; 3], second: [f64; 3], at: f64) -> [f64; 3] {
    let share = 0.5 * (1.0 + at / (1.0 + at * at).sqrt() / FRAC_1_SQRT_2);
    // The position is undefined for a single row or column.
    let share = if share.is_nan() {
        0.0
    } else {
        share.clamp(0.0, 1.0)
    };
    [0, 1, 2].map(|k| share * first[k] + (1.0 - share) * second[k])
}

fn bytes(rgb: [f64; 3]) -> [u8; 3] {
    rgb.map(|part| (255.0 * part) as u8)
}

/// Pseudo-random numbers from 0 to 1 (SplitMix64 by Steele, Lea and Flood).
struct Dots(u64);

impl Dots {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
