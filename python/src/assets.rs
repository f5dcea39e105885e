//! Meshes and height fields under MuJoCo's names: counts, start indices, and the arrays of all of them.

use crate::field::{Field, Numbers, Reader, codes, id};
use clench::Model;
use clench::rigid::model::{HeightField, Mesh};
use std::ops::Range;
use std::sync::Arc;

/// The fields of the assets that geoms refer to.
pub(crate) const ASSETS: &[Reader] = &[
    ("mesh_pos", |m| rows(&m.meshes, |mesh| mesh.pos.to_array())),
    ("mesh_quat", |m| {
        rows(&m.meshes, |mesh| mesh.quat.to_array())
    }),
    ("mesh_vertadr", |m| starts(&m.meshes, vertex_count)),
    ("mesh_vertnum", |m| {
        codes(&m.meshes, |mesh| id(vertex_count(mesh)))
    }),
    ("mesh_faceadr", |m| starts(&m.meshes, face_count)),
    ("mesh_facenum", |m| {
        codes(&m.meshes, |mesh| id(face_count(mesh)))
    }),
    ("mesh_vert", vertices),
    ("mesh_face", faces),
    ("hfield_size", |m| {
        rows(&m.height_fields, |field| field.shape.size())
    }),
    ("hfield_nrow", |m| {
        codes(&m.height_fields, |field| id(field.shape.rows()))
    }),
    ("hfield_ncol", |m| {
        codes(&m.height_fields, |field| id(field.shape.columns()))
    }),
    ("hfield_adr", |m| starts(&m.height_fields, height_count)),
    ("hfield_data", heights),
];

/// Returns the rows of `mesh_vert`, `mesh_face` or `hfield_data` of the mesh or height field with this index.
pub(crate) fn rows_of(model: &Model, field: &str, index: usize) -> Option<Range<usize>> {
    match field {
        "mesh_vert" => Some(span(&model.meshes, vertex_count, index)),
        "mesh_face" => Some(span(&model.meshes, face_count, index)),
        "hfield_data" => Some(span(&model.height_fields, height_count, index)),
        _ => None,
    }
}

fn vertex_count(mesh: &Mesh) -> usize {
    mesh.vertices.len()
}

fn face_count(mesh: &Mesh) -> usize {
    mesh.faces.len()
}

fn height_count(field: &HeightField) -> usize {
    field.shape.heights().len()
}

/// Returns the range of element `index` in an array of all elements, one after the other.
fn span<E>(elements: &[Arc<E>], count: fn(&E) -> usize, index: usize) -> Range<usize> {
    let start = elements[..index].iter().map(|e| count(e)).sum();
    start..start + count(&elements[index])
}

fn starts<E>(elements: &[Arc<E>], count: fn(&E) -> usize) -> Field {
    let indices: Vec<usize> = (0..elements.len()).collect();
    codes(&indices, |&index| id(span(elements, count, index).start))
}

/// Returns a field with N numbers for each element.
fn rows<E, const N: usize>(elements: &[Arc<E>], row: impl Fn(&E) -> [f64; N]) -> Field {
    Field {
        shape: vec![elements.len(), N],
        numbers: Numbers::Real(elements.iter().flat_map(|e| row(e)).collect()),
    }
}

fn vertices(model: &Model) -> Field {
    let all = || model.meshes.iter().flat_map(|mesh| &mesh.vertices);
    Field {
        shape: vec![all().count(), 3],
        numbers: Numbers::Real(all().flat_map(|v| v.to_array()).collect()),
    }
}

/// Returns the faces of all meshes. Vertex indices are counted within each mesh.
fn faces(model: &Model) -> Field {
    let all = || model.meshes.iter().flat_map(|mesh| &mesh.faces);
    let corner = |&corner: &u32| corner.cast_signed();
    Field {
        shape: vec![all().count(), 3],
        numbers: Numbers::Code(all().flatten().map(corner).collect()),
    }
}

fn heights(model: &Model) -> Field {
    let all = model.height_fields.iter().flat_map(|f| f.shape.heights());
    let numbers: Vec<f64> = all.copied().collect();
    Field {
        shape: vec![numbers.len()],
        numbers: Numbers::Real(numbers),
    }
}
