//! OBJ files: the lines that define a shape, read as MuJoCo reads them.
//!
//! All vertices of the file contribute to the hull.

use super::Objects;
use super::ears::triangulate;
use super::triangles::Triangles;
use clench_math::Vec3;

pub(super) fn read(bytes: &[u8], objects: Objects) -> Result<Triangles, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut vertices = Vec::new();
    let mut texcoords = Vec::new();
    let mut polygons: Vec<Polygon> = Vec::new();
    let mut counts = true;
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => vertices.push(vertex(words, number)?),
            Some("vt") => texcoords.push(texcoord(words, number)?),
            Some("f") if counts => {
                let corners = words
                    .map(|word| corner(word, [vertices.len(), texcoords.len()], number))
                    .collect::<Result<Vec<Corner>, String>>()?;
                // Faces without area are dropped, as in MuJoCo.
                if corners.len() >= 3 {
                    polygons.push(Polygon { number, corners });
                }
            }
            Some("o" | "g") if !polygons.is_empty() => counts = objects == Objects::All,
            _ => {}
        }
    }
    if vertices.is_empty() {
        return Err("not an OBJ file, or one without vertices".to_owned());
    }
    triangles(vertices, texcoords, &polygons)
}

/// Returns the number of faces in objects and groups after the first.
pub(crate) fn further_faces(bytes: &[u8]) -> usize {
    let text = String::from_utf8_lossy(bytes);
    let tags = text
        .lines()
        .filter_map(|line| line.split_ascii_whitespace().next());
    let further = tags
        .skip_while(|tag| *tag != "f")
        .skip_while(|tag| !matches!(*tag, "o" | "g"));
    further.filter(|tag| *tag == "f").count()
}

/// A face of the file and its line number.
struct Polygon {
    number: usize,
    corners: Vec<Corner>,
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
    polygons: &[Polygon],
) -> Result<Triangles, String> {
    let (mut faces, mut face_texcoords) = (Vec::new(), Vec::new());
    for Polygon { number, corners } in polygons {
        let missing = |corner: &&Corner| corner.vertex as usize >= vertices.len();
        if let Some(corner) = corners.iter().find(missing) {
            let vertex = u64::from(corner.vertex) + 1;
            return Err(format!("line {number}: there is no vertex {vertex}"));
        }
        let places: Vec<_> = corners
            .iter()
            .map(|c| vertices[c.vertex as usize])
            .collect();
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
fn vertex<'a>(words: impl Iterator<Item = &'a str>, line: usize) -> Result<Vec3<f64>, String> {
    let mut coordinates = [0.0; 3];
    let mut found = 0;
    for (coordinate, word) in coordinates.iter_mut().zip(words) {
        let number: f32 = word
            .parse()
            .map_err(|_| format!("line {line}: \"{word}\" is not a number"))?;
        *coordinate = f64::from(number);
        found += 1;
    }
    match found {
        3 => Ok(Vec3::from_array(coordinates)),
        _ => Err(format!("line {line}: a vertex has three coordinates")),
    }
}

/// Parses a texture coordinate, whose second axis points up.
fn texcoord<'a>(mut words: impl Iterator<Item = &'a str>, line: usize) -> Result<[f32; 2], String> {
    let mut number = || match words.next() {
        None => Ok(0.0),
        Some(word) => {
            (word.parse::<f32>()).map_err(|_| format!("line {line}: \"{word}\" is not a number"))
        }
    };
    Ok([number()?, 1.0 - number()?])
}

/// Parses a corner, such as `7`, `7/1/2` or, counted back from the last, `-1`; `before` counts the preceding vertices
/// and texture coordinates.
fn corner(word: &str, before: [usize; 2], line: usize) -> Result<Corner, String> {
    let wrong = || format!("line {line}: \"{word}\" is not a corner of a face");
    let mut parts = word.split('/');
    let mut index = |before: usize| {
        let index = match parts.next().unwrap_or_default() {
            "" => return None,
            part => part.parse::<i64>().ok()?,
        };
        let index = match index {
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
