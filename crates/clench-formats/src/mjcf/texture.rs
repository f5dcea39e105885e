//! `<texture>`: files or a pattern. As in MuJoCo, a pattern takes precedence over a file, and a file over six of them.

use super::files::{Content, Files};
use crate::document::Element;
use crate::error::LoadError;
use crate::image::Image;
use crate::spending::Spending;
use clench_dynamics::model::{
    Pattern, Pixels, Texture, TextureKind, TextureMark, TexturePattern, TexturePicture,
};
use std::sync::Arc;

/// The file attributes of the sides of a cube, in order.
const SIDES: [&str; 6] = [
    "fileright",
    "fileleft",
    "fileup",
    "filedown",
    "filefront",
    "fileback",
];

/// The letters of these sides in a layout.
const LETTERS: [char; 6] = ['R', 'L', 'U', 'D', 'F', 'B'];

/// The maximum number of squares in an image with several sides.
const MAX_SQUARES: usize = 12;

/// The memory of a pixel of a file, bytes: itself, and its decoded form.
const PIXEL: u64 = 8;

/// Reads a texture; none if its file is KTX, which only some of MuJoCo's renderers can draw.
pub(super) fn read(
    element: &Element,
    files: &Files,
    spending: &mut Spending,
) -> Result<Option<Texture>, LoadError> {
    let kinds = [
        ("2d", TextureKind::Plane),
        ("cube", TextureKind::Cube),
        ("skybox", TextureKind::Sky),
    ];
    let kind = element
        .keyword("type", &kinds)?
        .unwrap_or(TextureKind::Cube);
    let mut name = element.string("name");
    let picture = match pattern(element, kind, spending)? {
        Some(pattern) => TexturePicture::Computed(pattern),
        None => match files.texture(element, "file", spending)? {
            Some(file) => {
                if name.is_empty() {
                    name.clone_from(&file.stem);
                }
                if media_type(element, &file)? == "image/ktx" {
                    return Ok(None);
                }
                let picture = read_picture(file, element, spending)?;
                TexturePicture::Pixels(Arc::new(match kind {
                    TextureKind::Plane => picture,
                    TextureKind::Cube | TextureKind::Sky => unfolded(element, picture, spending)?,
                }))
            }
            None if kind == TextureKind::Plane => {
                return Err(element.incomplete("a 2d texture needs a builtin or a file"));
            }
            None => TexturePicture::Pixels(Arc::new(six_files(element, files, spending)?)),
        },
    };
    // As in MuJoCo, a sky needs no name, since no material refers to it.
    if name.is_empty() && kind != TextureKind::Sky {
        return Err(element.incomplete("a texture needs a name or a file"));
    }
    Ok(Some(Texture {
        name,
        kind,
        picture,
    }))
}

/// Returns the media type of a texture file, from the element or the file name.
fn media_type(element: &Element, file: &Content) -> Result<&'static str, LoadError> {
    let extension = file.extension.to_ascii_lowercase();
    let written = element
        .text("content_type")
        .filter(|written| !written.is_empty());
    let said = written.unwrap_or(match &*extension {
        "png" => "image/png",
        "ktx" => "image/ktx",
        _ => "",
    });
    let known = ["image/png", "image/ktx"];
    known
        .into_iter()
        .find(|&known| known == said)
        .ok_or_else(|| {
            element.error("the file of a texture is PNG, and its name or content_type says so")
        })
}

/// Returns the pattern that `builtin` names, if any.
fn pattern(
    element: &Element,
    kind: TextureKind,
    spending: &mut Spending,
) -> Result<Option<Pattern>, LoadError> {
    let patterns = [
        ("none", None),
        ("gradient", Some(TexturePattern::Gradient)),
        ("checker", Some(TexturePattern::Checker)),
        ("flat", Some(TexturePattern::Flat)),
    ];
    let Some(pattern) = element.keyword("builtin", &patterns)?.flatten() else {
        return Ok(None);
    };
    let mut random = 0.01;
    element.set_number("random", &mut random)?;
    let marks = [
        ("none", TextureMark::None),
        ("edge", TextureMark::Edge),
        ("cross", TextureMark::Cross),
        ("random", TextureMark::Random(random)),
    ];
    let side = |name: &str| match element.integer(name)? {
        Some(pixels @ 1..) => Ok(pixels as usize),
        _ => Err(element.incomplete(format!("a computed texture needs a positive {name}"))),
    };
    let width = side("width")?;
    let (height, sides) = match kind {
        TextureKind::Plane => (side("height")?, 1),
        TextureKind::Cube | TextureKind::Sky => (width, SIDES.len()),
    };
    let bytes = (3 * sides as u64).saturating_mul((width as u64).saturating_mul(height as u64));
    (spending.bytes(bytes)).map_err(|excess| element.error(excess))?;
    Ok(Some(Pattern {
        pattern,
        rgb1: element.numbers("rgb1")?.unwrap_or([0.8; 3]),
        rgb2: element.numbers("rgb2")?.unwrap_or([0.5; 3]),
        mark: element
            .keyword("mark", &marks)?
            .unwrap_or(TextureMark::None),
        markrgb: element.numbers("markrgb")?.unwrap_or([0.0; 3]),
        size: [width, height],
    }))
}

/// Returns the colours of an image, also of grey ones, flipped as specified.
fn read_picture(
    mut file: Content,
    element: &Element,
    spending: &mut Spending,
) -> Result<Pixels, LoadError> {
    let image = file.parse(element, |bytes| Image::read(&bytes, PIXEL, spending))?;
    let (mut across, mut down) = (false, false);
    element.set_boolean("hflip", &mut across)?;
    element.set_boolean("vflip", &mut down)?;
    let color = |pixel: &[u8]| match *pixel {
        [r, g, b, ..] => [r, g, b],
        [grey, ..] => [grey; 3],
        [] => [0; 3],
    };
    let mut rows: Vec<Vec<[u8; 3]>> = image.rows().map(|row| row.map(color).collect()).collect();
    if across {
        rows.iter_mut().for_each(|row| row.reverse());
    }
    if down {
        rows.reverse();
    }
    Ok(Pixels {
        width: image.width,
        height: image.height,
        rgb: rows.concat().into_flattened(),
    })
}

/// Assembles the sides of a cube from squares of an image; a square image is on all sides.
fn unfolded(
    element: &Element,
    picture: Pixels,
    spending: &mut Spending,
) -> Result<Pixels, LoadError> {
    let [rows, columns] = match element.integers("gridsize")?[..] {
        [] => [1; 2],
        [rows, columns] if rows > 0 && columns > 0 => [rows as usize, columns as usize],
        _ => return Err(element.error("gridsize needs two positive numbers")),
    };
    let squares = rows.saturating_mul(columns);
    if squares > MAX_SQUARES {
        return Err(element.error(format!(
            "gridsize cannot have more than {MAX_SQUARES} squares"
        )));
    }
    let width = picture.width / columns;
    if [width * columns, width * rows] != [picture.width, picture.height] {
        return Err(element.error(format!(
            "a picture of {} x {} pixels is not made of {columns} x {rows} squares",
            picture.width, picture.height
        )));
    }
    if squares == 1 {
        return Ok(picture);
    }
    let layout = element.text("gridlayout").unwrap_or("............");
    if element.text("gridlayout").is_some() && layout.chars().count() != squares {
        return Err(element.error(format!("gridlayout needs {squares} letters")));
    }
    let mut sides = [const { None }; 6];
    for (square, letter) in layout.chars().take(squares).enumerate() {
        let side = LETTERS.iter().position(|&known| known == letter);
        match side {
            Some(side) => sides[side] = Some(crop(&picture, width, square, columns)),
            None if letter == '.' => {}
            None => return Err(element.error("gridlayout has letters other than .RLUDFB")),
        }
    }
    cube(element, width, &sides, spending)
}

/// Returns a square of an image with `columns` squares in a row.
fn crop(picture: &Pixels, width: usize, square: usize, columns: usize) -> Vec<u8> {
    let (row, column) = (square / columns, square % columns);
    let lines = picture.rgb.chunks_exact(3 * picture.width);
    lines
        .skip(row * width)
        .take(width)
        .flat_map(|line| &line[3 * column * width..3 * (column + 1) * width])
        .copied()
        .collect()
}

/// Assembles a cube from one file per side.
fn six_files(
    element: &Element,
    files: &Files,
    spending: &mut Spending,
) -> Result<Pixels, LoadError> {
    let mut found = None;
    let mut sides = [const { None }; 6];
    for (side, name) in sides.iter_mut().zip(SIDES) {
        let Some(file) = files.texture(element, name, spending)? else {
            continue;
        };
        if media_type(element, &file)? != "image/png" {
            return Err(element.error(format!("{name} is not a PNG image")));
        }
        let picture = read_picture(file, element, spending)?;
        let width = *found.get_or_insert(picture.width);
        if [picture.width, picture.height] != [width; 2] {
            return Err(element.error(format!(
                "the sides of a cube are squares of one size, but {name} has {} x {} pixels",
                picture.width, picture.height
            )));
        }
        *side = Some(picture.rgb);
    }
    match found {
        Some(width) => cube(element, width, &sides, spending),
        None => {
            Err(element.incomplete("a cube texture needs a builtin, a file, or files of its sides"))
        }
    }
}

/// Stacks the sides vertically; uses `rgb1` for missing ones.
fn cube(
    element: &Element,
    width: usize,
    sides: &[Option<Vec<u8>>; 6],
    spending: &mut Spending,
) -> Result<Pixels, LoadError> {
    let bytes =
        (3 * SIDES.len() as u64).saturating_mul((width as u64).saturating_mul(width as u64));
    (spending.bytes(bytes)).map_err(|excess| element.error(excess))?;
    let rgb1: [f64; 3] = element.numbers("rgb1")?.unwrap_or([0.8; 3]);
    let plain = rgb1.map(|part| (255.0 * part) as u8).repeat(width * width);
    Ok(Pixels {
        width,
        height: SIDES.len() * width,
        rgb: (sides.iter())
            .flat_map(|side| side.as_ref().unwrap_or(&plain))
            .copied()
            .collect(),
    })
}
