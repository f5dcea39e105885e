//! MSH, MuJoCo's old binary format: four counts (vertices, normals, texture coordinates, faces), then three `f32` per
//! vertex, three per normal, two per texture coordinate, three `i32` per face.

use super::triangles::{Triangles, floats, points};

/// The bytes of the four counts.
const HEADER: u64 = 16;

pub(super) fn read(bytes: &[u8]) -> Result<Triangles, String> {
    let (words, _) = bytes.as_chunks::<4>();
    let [vertices, normals, texcoords, faces] = match words {
        [a, b, c, d, ..] => [*a, *b, *c, *d].map(i32::from_le_bytes),
        _ => return Err("too short for an MSH file".to_owned()),
    };
    let fits = |count: i32| count == 0 || count == vertices;
    if vertices < 4 || faces < 0 || !fits(normals) || !fits(texcoords) {
        return Err(format!(
            "an MSH file cannot have {vertices} vertices, {normals} normals, {texcoords} texture coordinates and {faces} faces"
        ));
    }
    let [vertices, normals, texcoords, faces] =
        [vertices, normals, texcoords, faces].map(|count| count as u64);
    let expected = HEADER + 12 * (vertices + normals + faces) + 8 * texcoords;
    if bytes.len() as u64 != expected {
        return Err(format!(
            "an MSH file of these counts has {expected} bytes, but this one {}",
            bytes.len()
        ));
    }
    // The file has this length, so the offsets fit `usize`.
    let end = (HEADER + 12 * vertices) as usize;
    let start = (expected - 12 * faces) as usize;
    let corners: Vec<i32> = (words[start / 4..].iter().copied())
        .map(i32::from_le_bytes)
        .collect();
    let faces = corners.as_chunks::<3>().0;
    if let Some(bad) = faces.as_flattened().iter().find(|&&corner| corner < 0) {
        return Err(format!(
            "a face refers to vertex {bad}, which does not exist"
        ));
    }
    Ok(Triangles {
        vertices: points(floats(&bytes[HEADER as usize..end])),
        faces: faces.iter().map(|face| face.map(|c| c as u32)).collect(),
        texcoords: {
            let numbers: Vec<f32> = floats(&bytes[start - 8 * texcoords as usize..start]).collect();
            numbers.as_chunks::<2>().0.to_vec()
        },
        face_texcoords: Vec::new(),
        tangents: Vec::new(),
    })
}
