//! STL, binary or text. Corners with the same bits are one vertex.

use super::triangles::{Triangles, points};
use std::io::Cursor;

/// What a binary file begins with: 80 bytes of any content, then the number of triangles.
const HEADER: usize = 84;
/// A triangle: normal, three corners, two bytes of any content.
const TRIANGLE: usize = 50;

pub(super) fn read(mut bytes: Vec<u8>) -> Result<Triangles, String> {
    if is_binary(&bytes)? {
        // Many a binary file begins with "solid", as text files do: only its length tells.
        bytes[..80].fill(0);
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes))
        .map_err(|error| format!("not a valid STL file: {error}"))?;
    if mesh.faces.is_empty() {
        return Err("the STL file has no triangles".to_owned());
    }
    Ok(Triangles {
        vertices: points(mesh.vertices.iter().flat_map(|vertex| vertex.0)),
        faces: (mesh.faces.iter())
            .map(|face| face.vertices.map(|v| v as u32))
            .collect(),
        ..Triangles::default()
    })
}

/// Whether the bytes are a binary file.
///
/// # Errors
/// Bytes that are neither text nor as long as the number of triangles that they claim says.
fn is_binary(bytes: &[u8]) -> Result<bool, String> {
    let count = match bytes.get(80..HEADER) {
        Some(&[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as usize,
        _ => 0,
    };
    let expected = HEADER + TRIANGLE * count;
    if bytes.len() >= HEADER && bytes.len() == expected {
        return Ok(true);
    }
    if bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0) {
        return Ok(false);
    }
    Err(match bytes.len() < HEADER {
        true => "not an STL file: too short for a binary one, and not text".to_owned(),
        false => format!(
            "a binary STL file of {count} triangles has {expected} bytes, but this one {}",
            bytes.len()
        ),
    })
}
