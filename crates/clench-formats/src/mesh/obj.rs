//! OBJ files: the lines that define a shape, read as MuJoCo reads them.
//!
//! All vertices of the file contribute to the hull.

use super::Objects;
use super::ears::triangulate;
use super::triangles::Triangles;
use clench_math::Vec3;
use std::str::{self, FromStr};

pub(super) fn read(bytes: &[u8], mut objects: Objects) -> Result<Triangles, String> {
    let mut vertices = Vec::new();
    let mut texcoords = Vec::new();
    let mut polygons = Polygons::default();
    let mut counts = true;
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let number = index + 1;
        let mut words = words(line);
        match words.next() {
            Some(b"v") => vertices.push(vertex(words, number)?),
            Some(b"vt") => texcoords.push(texcoord(words, number)?),
            Some(b"f") if counts => {
                for word in words {
                    let corner = corner(word, [vertices.len(), texcoords.len()], number)?;
                    polygons.corners.push(corner);
                }
                polygons.end(number);
            }
            Some(b"f") => {
                if let Objects::First(omitted_faces) = &mut objects {
                    **omitted_faces += 1;
                }
            }
            Some(b"o" | b"g") if !polygons.ends.is_empty() => {
                counts = matches!(objects, Objects::All);
            }
            _ => {}
        }
    }
    if vertices.is_empty() {
        return Err("not an OBJ file, or one without vertices".to_owned());
    }
    triangles(vertices, texcoords, &polygons)
}

/// Returns the words of a line.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

/// Parses a number.
fn parse<T: FromStr>(word: &[u8]) -> Option<T> {
    str::from_utf8(word).ok()?.parse().ok()
}

/// The faces of the file.
#[derive(Default)]
struct Polygons {
    corners: Vec<Corner>,
    /// The end of each face among the corners, and its line number.
    ends: Vec<(usize, usize)>,
}

impl Polygons {
    /// Ends a face on a line. Faces without area are dropped, as in MuJoCo.
    fn end(&mut self, line: usize) {
        let start = self.ends.last().map_or(0, |&(end, _)| end);
        match self.corners.len() - start {
            0..3 => self.corners.truncate(start),
            _ => self.ends.push((self.corners.len(), line)),
        }
    }

    /// Returns the corners of each face, and its line number.
    fn iter(&self) -> impl Iterator<Item = (&[Corner], usize)> {
        let mut start = 0;
        self.ends.iter().map(move |&(end, line)| {
            let corners = &self.corners[start..end];
            start = end;
            (corners, line)
        })
    }
}

/// A corner of a face: a vertex and an optional texture coordinate.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    texcoord: Option<u32>,
}

/// Returns the triangles of all faces. As in MuJoCo, texture coordinates are used only if all corners have one.
fn triangles(
    vertices: Vec<Vec3<f64>>,
    texcoords: Vec<[f32; 2]>,
    polygons: &Polygons,
) -> Result<Triangles, String> {
    let (mut faces, mut face_texcoords) = (Vec::new(), Vec::new());
    let mut places = Vec::new();
    for (corners, number) in polygons.iter() {
        let missing = |corner: &&Corner| corner.vertex as usize >= vertices.len();
        if let Some(corner) = corners.iter().find(missing) {
            let vertex = u64::from(corner.vertex) + 1;
            return Err(format!("line {number}: there is no vertex {vertex}"));
        }
        places.clear();
        places.extend(corners.iter().map(|c| vertices[c.vertex as usize]));
        for triangle in triangulate(&places) {
            let triangle = triangle.map(|corner| corners[corner]);
            faces.push(triangle.map(|corner| corner.vertex));
            let texcoord = |c: Corner| (c.texcoord).filter(|&at| (at as usize) < texcoords.len());
            if let [Some(a), Some(b), Some(c)] = triangle.map(texcoord) {
                face_texcoords.push([a, b, c]);
            }
        }
    }
    let (texcoords, face_texcoords) = match face_texcoords.len() == faces.len() {
        true => (texcoords, face_texcoords),
        false => Default::default(),
    };
    Ok(Triangles {
        vertices,
        faces,
        texcoords,
        face_texcoords,
        tangents: Vec::new(),
    })
}

/// Parses three coordinates, in single precision as in MuJoCo.
fn vertex<'a>(words: impl Iterator<Item = &'a [u8]>, line: usize) -> Result<Vec3<f64>, String> {
    let mut coordinates = [0.0; 3];
    let mut found = 0;
    for (coordinate, word) in coordinates.iter_mut().zip(words) {
        *coordinate = f64::from(single(word, line)?);
        found += 1;
    }
    match found {
        3 => Ok(Vec3::from_array(coordinates)),
        _ => Err(format!("line {line}: a vertex has three coordinates")),
    }
}

fn single(word: &[u8], line: usize) -> Result<f32, String> {
    let wrong = || {
        let word = String::from_utf8_lossy(word);
        format!("line {line}: \"{word}\" is not a number")
    };
    parse(word).ok_or_else(wrong)
}

/// Parses a texture coordinate, whose second axis points up.
fn texcoord<'a>(
    mut words: impl Iterator<Item = &'a [u8]>,
    line: usize,
) -> Result<[f32; 2], String> {
    let mut number = || words.next().map_or(Ok(0.0), |word| single(word, line));
    Ok([number()?, 1.0 - number()?])
}

/// Parses a corner, such as `7`, `7/1/2` or, counted back from the last, `-1`; `before` counts the preceding vertices
/// and texture coordinates.
fn corner(word: &[u8], before: [usize; 2], line: usize) -> Result<Corner, String> {
    let wrong = || {
        let word = String::from_utf8_lossy(word);
        format!("line {line}: \"{word}\" is not a corner of a face")
    };
    let mut parts = word.split(|&byte| byte == b'/');
    let mut index = |before: usize| {
        let index = match parse::<i64>(parts.next()?)? {
            0 => return None,
            forwards if forwards > 0 => forwards - 1,
            backwards => before as i64 + backwards,
        };
        u32::try_from(index).ok()
    };
    Ok(Corner {
        vertex: index(before[0]).ok_or_else(wrong)?,
        texcoord: index(before[1]),
    })
}
