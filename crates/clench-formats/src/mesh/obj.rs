//! OBJ: the lines that matter to a shape, read as MuJoCo reads them.
//!
//! All vertices of the file count towards the hull, but only the faces of its first object or group. Quadrilaterals are split along
//! their shorter diagonal, larger polygons by clipping ears.

use super::triangles::Triangles;
use clench_math::Vec3;
use earcut::{Earcut, utils3d::project3d_to_2d};

/// Corners of a face, at most: ears of a polygon that crosses itself take a time that grows with the square of them.
const MAX_CORNERS: usize = 1000;

pub(super) fn read(bytes: &[u8]) -> Result<Triangles, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut vertices = Vec::new();
    let mut polygons: Vec<(usize, Vec<u32>)> = Vec::new();
    let mut first_object = true;
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => vertices.push(vertex(words, number)?),
            Some("f") if first_object => {
                let corners = words
                    .map(|word| corner(word, vertices.len(), number))
                    .collect::<Result<Vec<u32>, String>>()?;
                if corners.len() > MAX_CORNERS {
                    return Err(format!(
                        "line {number}: a face has more than {MAX_CORNERS} corners"
                    ));
                }
                // What has no area is dropped, as in MuJoCo.
                if corners.len() >= 3 {
                    polygons.push((number, corners));
                }
            }
            Some("o" | "g") if !polygons.is_empty() => first_object = false,
            _ => {}
        }
    }
    if vertices.is_empty() {
        return Err("not an OBJ file, or one without vertices".to_owned());
    }
    let mut faces = Vec::new();
    for (number, corners) in polygons {
        if let Some(missing) = corners.iter().find(|&&c| c as usize >= vertices.len()) {
            let vertex = u64::from(*missing) + 1;
            return Err(format!("line {number}: there is no vertex {vertex}"));
        }
        split(&corners, &vertices, &mut faces);
    }
    Ok(Triangles { vertices, faces })
}

/// Three coordinates, kept with the 24 bits that MuJoCo keeps.
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

/// The vertex of a corner, such as `7`, `7/1/2` or, counted back from the last, `-1`.
fn corner(word: &str, vertices: usize, line: usize) -> Result<u32, String> {
    let (index, _) = word.split_once('/').unwrap_or((word, ""));
    let wrong = || format!("line {line}: \"{word}\" is no corner of a face");
    let index = match index.parse::<i64>().map_err(|_| wrong())? {
        0 => return Err(wrong()),
        forwards if forwards > 0 => forwards - 1,
        backwards => vertices as i64 + backwards,
    };
    u32::try_from(index).map_err(|_| wrong())
}

/// Triangles of a polygon.
fn split(corners: &[u32], vertices: &[Vec3<f64>], faces: &mut Vec<[u32; 3]>) {
    let at = |c: u32| vertices[c as usize];
    match *corners {
        [a, b, c] => faces.push([a, b, c]),
        [a, b, c, d] => match (at(c) - at(a)).norm_squared() < (at(d) - at(b)).norm_squared() {
            true => faces.extend([[a, b, c], [a, c, d]]),
            false => faces.extend([[a, b, d], [b, c, d]]),
        },
        _ => {
            let points: Vec<[f64; 3]> = corners.iter().map(|&c| at(c).to_array()).collect();
            let (mut flat, mut found) = (Vec::new(), Vec::<u32>::new());
            // A polygon without area has no plane, and adds nothing.
            if project3d_to_2d(&points, points.len(), &mut flat) {
                Earcut::new().earcut(flat, &[], &mut found);
            }
            let ears = found.as_chunks::<3>().0.iter();
            faces.extend(ears.map(|ear| ear.map(|corner| corners[corner as usize])));
        }
    }
}
