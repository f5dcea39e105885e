//! glTF 2.0 (`.glb`, `.gltf`) files: the triangles of a scene, in metres, with the transforms of the scene's nodes.
//!
//! Coordinates are used as written: like Collada files, robots' meshes are not rotated from y-up to z-up. Materials,
//! lights, cameras, lines and points are skipped. Geometry that is compressed or deformed by a skeleton is an error.

mod buffers;
mod json;
mod scene;

use super::MeshFolder;
use super::affine::{Transform, to_single};
use super::triangles::Triangles;
use buffers::Buffers;
use json::{Primitive, Root};
use scene::Instance;
use std::collections::HashMap;

/// The maximum number of values in a file's text; large scenes have some ten thousand. Each takes some 200 bytes in the
/// parser.
const MAX_MARKS: usize = 2_000_000;
/// The maximum number of primitives, vertices and faces in a scene, counting each instance of a mesh.
const MAX_SIZE: usize = 20_000_000;

/// The first bytes of a binary file.
const MAGIC: &[u8] = b"glTF";

/// Prefixes of extensions that only affect appearance.
const APPEARANCE_ONLY: [&str; 4] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "EXT_texture_",
];

pub(super) fn read(bytes: &[u8], mesh_folder: &mut MeshFolder) -> Result<Triangles, String> {
    let (text, binary) = match bytes.starts_with(MAGIC) {
        true => chunks(bytes)?,
        false => (bytes, None),
    };
    let marks = text.iter().filter(|byte| b"{[,".contains(byte)).count();
    if marks > MAX_MARKS {
        return Err(format!("more than {MAX_MARKS} values in a glTF file"));
    }
    let root: Root =
        serde_json::from_slice(text).map_err(|error| format!("not a glTF file: {error}"))?;
    check(&root)?;
    let buffers = Buffers::new(&root, binary, mesh_folder)?;
    let (mut found, mut size) = (Triangles::default(), 0);
    for Instance { mesh, transform } in scene::instances(&root)? {
        for primitive in &mesh.primitives {
            size += 1;
            if primitive.has_triangles() {
                let places = buffers.positions(position(primitive)?)?;
                let corners = buffers.corners(primitive, places.len())?;
                size += places.len() + corners.len();
                append(&mut found, &corners, &places, &transform)?;
            }
            if size > MAX_SIZE {
                return Err(format!(
                    "more than {MAX_SIZE} primitives, vertices and faces"
                ));
            }
        }
    }
    match found.faces.is_empty() {
        true => Err("the glTF file has no triangles in its scene".to_owned()),
        false => Ok(found),
    }
}

/// Returns the text and the binary chunk of a binary file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let short = || "the file is truncated".to_owned();
    let word = |at: usize| -> Result<usize, String> {
        let word = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        Ok(u32::from_le_bytes(*word.ok_or_else(short)?) as usize)
    };
    if word(4)? != 2 {
        return Err(format!("glTF of version {}, not 2", word(4)?));
    }
    let (mut at, mut text, mut binary) = (12, None, None);
    while at < bytes.len() && text.is_none_or(|_| binary.is_none()) {
        let (length, kind) = (word(at)?, bytes.get(at + 4..at + 8));
        let content = bytes[at..].get(8..).and_then(|rest| rest.get(..length));
        let content = content.ok_or_else(short)?;
        match kind {
            Some(b"JSON") if text.is_none() => text = Some(content),
            Some(b"BIN\0") if binary.is_none() => binary = Some(content),
            _ => {}
        }
        at += 8 + length;
    }
    Ok((text.ok_or_else(short)?, binary))
}

fn check(root: &Root) -> Result<(), String> {
    let version = &root.asset.version;
    if !version.starts_with("2.") {
        return Err(format!("glTF of version {version}, not 2"));
    }
    let acts = |name: &&String| {
        !APPEARANCE_ONLY
            .iter()
            .any(|prefix| name.starts_with(prefix))
    };
    match root.extensions_required.iter().find(acts) {
        Some(name) => Err(format!(
            "needs the extension {name}, which is not supported"
        )),
        None => Ok(()),
    }
}

/// Returns the accessor of the vertices.
fn position(primitive: &Primitive) -> Result<usize, String> {
    let missing = || "a primitive has no positions".to_owned();
    primitive.attributes.position.ok_or_else(missing)
}

/// Adds triangles, transformed to the scene. Omits vertices that no face uses.
fn append(
    found: &mut Triangles,
    corners: &[[usize; 3]],
    vertices: &[clench_math::Vec3<f64>],
    transform: &Transform,
) -> Result<(), String> {
    let mut numbers: HashMap<usize, u32> = HashMap::new();
    for &corner in corners {
        let mut face = [0; 3];
        for (number, vertex) in face.iter_mut().zip(corner) {
            let point = vertices.get(vertex);
            let point = point
                .ok_or_else(|| format!("a face refers to vertex {vertex}, which does not exist"))?;
            *number = *numbers.entry(vertex).or_insert_with(|| {
                found.vertices.push(to_single(transform.point(*point)));
                found.vertices.len() as u32 - 1
            });
        }
        if transform.mirrors() {
            face.reverse();
        }
        found.faces.push(face);
    }
    Ok(())
}
