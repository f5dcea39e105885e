//! `<mesh>`: a mesh from a file, from vertices and faces in the model, or built in.

use super::files::{Files, slashes};
use crate::document::Element;
use crate::error::LoadError;
use crate::mesh::{self, Format, MeshFolder, Objects, Triangles, builtin};
use crate::spending::Spending;
use clench_builder::{MeshInertia, MeshSpec};
use clench_math::{Quat, Vec3};
use std::path::Path;

/// A mesh as written in an element or a default class.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshDraft(MeshSpec);

impl MeshDraft {
    /// Overwrites those attributes of a default class that the element gives.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        let mesh = &mut self.0;
        element.set_vector("scale", &mut mesh.scale)?;
        let kinds = [
            ("convex", MeshInertia::Convex),
            ("exact", MeshInertia::Exact),
            ("legacy", MeshInertia::Legacy),
            ("shell", MeshInertia::Shell),
        ];
        element.set_keyword("inertia", &kinds, &mut mesh.inertia)?;
        if let Some(bound) = element.integer("maxhullvert")? {
            mesh.max_hull_vertices = match bound {
                -1 => None,
                ..4 => return Err(element.error("maxhullvert must be larger than 3, or -1")),
                _ => Some(bound as usize),
            };
        }
        Ok(())
    }

    /// Completes the mesh with attributes that only an element can have. Notes report ignored faces. If the model
    /// `discards` meshes that it does not use, a file that cannot be read may be one of them: it is no error yet.
    pub(super) fn finish(
        mut self,
        element: &Element,
        files: &Files,
        discards: bool,
        notes: &mut Vec<String>,
        spending: &mut Spending,
    ) -> Result<MeshSpec, LoadError> {
        self.read(element)?;
        let mut mesh = self.0;
        mesh.name = element.string("name");
        element.set_vector("refpos", &mut mesh.refpos)?;
        if let Some(quat) = element.numbers("refquat")? {
            if quat == [0.0; 4] {
                return Err(element.error("refquat cannot be zero"));
            }
            mesh.refquat = Quat::from_f64(quat);
        }
        let mut found = match element.text("builtin") {
            Some(builtin) => {
                if builtin == "plate" {
                    mesh.inertia = MeshInertia::Shell; // It has no volume.
                }
                make(element, builtin, spending)?
            }
            None => {
                let read = read_or_written(element, files, &mut mesh.name, notes, spending);
                let found = match read {
                    Err(error) if discards => {
                        mesh.unreadable = Some(error.message);
                        if mesh.name.is_empty() {
                            mesh.name = stem_of_file(element);
                        }
                        Triangles::default()
                    }
                    read => read?,
                };
                let taken = spending.bytes(mesh::cost(&found));
                taken.map_err(|excess| element.error(excess))?;
                found
            }
        };
        let given = read_tangents(element, found.vertices.len())?;
        if !given.is_empty() {
            found.tangents = given;
        }
        if mesh.name.is_empty() {
            return Err(element.incomplete("a mesh needs a name or a file"));
        }
        Ok(MeshSpec {
            vertices: found.vertices,
            faces: found.faces,
            tangents: found.tangents,
            texcoords: found.texcoords,
            face_texcoords: found.face_texcoords,
            origin: Some(element.origin.clone()),
            ..mesh
        })
    }
}

/// Generates the mesh that `builtin` names.
fn make(element: &Element, builtin: &str, spending: &mut Spending) -> Result<Triangles, LoadError> {
    for other in ["file", "vertex"] {
        if element.text(other).is_some() {
            return Err(element.error(format!("{other} and builtin cannot both be given")));
        }
    }
    let parameters = element.list("params")?;
    let parameters = parameters.ok_or_else(|| element.missing("params"))?;
    builtin::make(builtin, &parameters, spending).map_err(|message| element.error(message))
}

/// Reads the mesh from a file, which also provides a missing name, or from the model.
fn read_or_written(
    element: &Element,
    files: &Files,
    name: &mut String,
    notes: &mut Vec<String>,
    spending: &mut Spending,
) -> Result<Triangles, LoadError> {
    let written = Triangles {
        vertices: read_vertices(element)?,
        faces: read_faces(element)?,
        texcoords: read_texcoords(element)?,
        face_texcoords: Vec::new(),
        tangents: Vec::new(),
    };
    let Some(mut file) = files.read(element, spending)? else {
        return Ok(written);
    };
    if name.is_empty() {
        name.clone_from(&file.stem);
    }
    // As in MuJoCo, the name counts if the type is not one of a mesh.
    let of_type = element
        .text("content_type")
        .and_then(Format::from_media_type);
    let format = of_type.or_else(|| Format::from_extension(&file.extension));
    let wrong = || {
        element.error("a mesh file is STL, OBJ, MSH, Collada (.dae) or glTF (.glb, .gltf), and its name says which")
    };
    let format = format.ok_or_else(wrong)?;
    let directory = file.directory();
    let mut mesh_folder = MeshFolder {
        directory: &directory,
        spending,
    };
    let mut omitted = 0;
    let found = file.parse(element, |bytes| {
        mesh::read(
            bytes,
            format,
            Objects::First(&mut omitted),
            &mut mesh_folder,
        )
    })?;
    if omitted > 0 {
        let note = format!(
            "only the first object or group of an OBJ file is read, as in MuJoCo: {omitted} faces of others are omitted"
        );
        notes.push(element.error(note).to_string());
    }
    merge(found, written, element)
}

/// Returns the name of the file that an element names, without folders and extension.
fn stem_of_file(element: &Element) -> String {
    let path = slashes(element.text("file").unwrap_or_default());
    let stem = Path::new(&path).file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Merges a file with data in the model, which may add missing faces and texture coordinates.
fn merge(file: Triangles, written: Triangles, element: &Element) -> Result<Triangles, LoadError> {
    if !written.vertices.is_empty() {
        return Err(element.error("vertex and file cannot both be given"));
    }
    if !file.faces.is_empty() && !written.faces.is_empty() {
        return Err(element.error("the file has faces: face cannot be given too"));
    }
    if !file.texcoords.is_empty() && !written.texcoords.is_empty() {
        let message = "the file has texture coordinates: texcoord cannot be given too";
        return Err(element.error(message));
    }
    let faces = match file.faces.is_empty() {
        true => written.faces,
        false => file.faces,
    };
    let texcoords = match file.texcoords.is_empty() {
        true => written.texcoords,
        false => file.texcoords,
    };
    Ok(Triangles {
        faces,
        texcoords,
        ..file
    })
}

/// Reads tangents, if each vertex has a normal and two of them: nine numbers. Normals alone do not affect motion.
fn read_tangents(element: &Element, vertices: usize) -> Result<Vec<[Vec3<f64>; 2]>, LoadError> {
    let numbers = (element.list_of_singles("normal", usize::MAX)?).unwrap_or_default();
    if numbers.len() != 9 * vertices {
        return Ok(Vec::new());
    }
    let frames = numbers.as_chunks::<9>().0.iter();
    let tangents = frames.map(|&[_, _, _, a, b, c, d, e, f]| [[a, b, c], [d, e, f]]);
    Ok(tangents.map(|pair| pair.map(point)).collect())
}

/// Reads vertices, in single precision as in MuJoCo.
fn read_vertices(element: &Element) -> Result<Vec<Vec3<f64>>, LoadError> {
    let numbers = (element.list_of_singles("vertex", usize::MAX)?).unwrap_or_default();
    let (points, rest) = numbers.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(element.error("vertex needs three numbers per vertex"));
    }
    Ok(points.iter().copied().map(point).collect())
}

fn point(numbers: [f32; 3]) -> Vec3<f64> {
    Vec3::from_array(numbers.map(f64::from))
}

fn read_texcoords(element: &Element) -> Result<Vec<[f32; 2]>, LoadError> {
    let numbers = (element.list_of_singles("texcoord", usize::MAX)?).unwrap_or_default();
    let (places, rest) = numbers.as_chunks::<2>();
    match rest.is_empty() {
        true => Ok(places.to_vec()),
        false => Err(element.error("texcoord needs two numbers per vertex")),
    }
}

fn read_faces(element: &Element) -> Result<Vec<[u32; 3]>, LoadError> {
    let negative = |_| element.error("face cannot have negative numbers");
    let numbers = element.integers("face")?;
    let numbers: Vec<u32> = (numbers.into_iter())
        .map(|number| u32::try_from(number).map_err(negative))
        .collect::<Result<_, _>>()?;
    let (faces, rest) = numbers.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(element.error("face needs three numbers per face"));
    }
    Ok(faces.to_vec())
}
