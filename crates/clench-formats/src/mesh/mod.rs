//! Meshes: triangles from STL, OBJ, MSH, Collada and glTF files, and built-in meshes.
//!
//! A reader takes the bytes of a file and reports errors in them; its caller adds the file name. Counts are checked
//! against the file's length before allocation.

mod affine;
pub(crate) mod builtin;
mod collada;
mod ears;
mod gltf;
mod lattice;
mod msh;
mod obj;
mod stl;
mod triangles;

use crate::spending::Spending;
use clench_math::Vec3;
use std::path::Path;
pub(crate) use triangles::Triangles;

/// Returns the total memory of a mesh, bytes: in the builder, in the model, as a hull, and in a tree for rays.
fn bytes(vertices: usize, faces: usize) -> u64 {
    (vertices as u64).saturating_mul(200) + (faces as u64).saturating_mul(150)
}

/// Returns the total memory of a mesh read from a file, bytes, including its texture coordinates in the builder and the
/// model.
pub(crate) fn cost(mesh: &Triangles) -> u64 {
    let seen = 24 * mesh.texcoords.len() + 36 * mesh.face_texcoords.len();
    bytes(mesh.vertices.len(), mesh.faces.len()) + seen as u64
}

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Stl,
    Obj,
    Msh,
    Collada,
    Gltf,
}

impl Format {
    /// Returns the format of a file name extension, ignoring case.
    pub(crate) fn from_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "stl" => Some(Format::Stl),
            "obj" => Some(Format::Obj),
            "msh" => Some(Format::Msh),
            "dae" => Some(Format::Collada),
            "gltf" | "glb" => Some(Format::Gltf),
            _ => None,
        }
    }
    /// Returns the format of a media type, MJCF's `content_type`.
    pub(crate) fn from_media_type(media_type: &str) -> Option<Self> {
        match media_type {
            "model/stl" => Some(Format::Stl),
            "model/obj" => Some(Format::Obj),
            "model/vnd.mujoco.msh" => Some(Format::Msh),
            "model/vnd.collada+xml" => Some(Format::Collada),
            "model/gltf+json" | "model/gltf-binary" => Some(Format::Gltf),
            _ => None,
        }
    }
}

/// The objects and groups of an OBJ file that are read.
#[derive(Debug)]
pub(crate) enum Objects<'a> {
    /// The first with faces, as in MuJoCo. The reader counts the faces of all others.
    First(&'a mut usize),
    All,
}

/// The folder of a mesh file, with the files that it refers to.
pub(crate) struct MeshFolder<'a> {
    pub directory: &'a Path,
    pub spending: &'a mut Spending,
}

impl MeshFolder<'_> {
    /// Reads a file that a mesh file refers to.
    ///
    /// # Errors
    /// Returns an error if it is missing or too long.
    fn read(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let path = self.directory.join(name);
        let read = self.spending.read(&path);
        read.map_err(|error| format!("cannot read \"{}\": {error}", path.display()))
    }
}

/// Reads a mesh.
///
/// # Errors
/// Returns a message if the bytes, or a file that they refer to, are invalid.
pub(crate) fn read(
    bytes: Vec<u8>,
    format: Format,
    objects: Objects,
    mesh_folder: &mut MeshFolder,
) -> Result<Triangles, String> {
    if bytes.is_empty() {
        return Err("the file is empty".to_owned());
    }
    let found = match format {
        Format::Stl => stl::read(&bytes),
        Format::Obj => obj::read(&bytes, objects),
        Format::Msh => msh::read(&bytes),
        Format::Collada => collada::read(&bytes),
        Format::Gltf => gltf::read(&bytes, mesh_folder),
    }?;
    check(&found)?;
    Ok(found)
}

fn check(found: &Triangles) -> Result<(), String> {
    let finite = |v: &Vec3<f64>| v.to_array().iter().all(|x| x.is_finite());
    if let Some(bad) = found.vertices.iter().position(|v| !finite(v)) {
        return Err(format!("a coordinate of vertex {bad} is not finite"));
    }
    for (number, face) in found.faces.iter().enumerate() {
        if let Some(vertex) = face.iter().find(|&&v| v as usize >= found.vertices.len()) {
            return Err(format!(
                "face {number} refers to vertex {vertex}, which does not exist"
            ));
        }
    }
    if let Some(bad) = (found.texcoords.as_flattened().iter()).position(|x| !x.is_finite()) {
        return Err(format!("texture coordinate {} is not finite", bad / 2));
    }
    Ok(())
}
