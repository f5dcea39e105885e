//! Meshes and height fields as originally given; derived quantities are computed again when the file is loaded.

use super::names::SaveError;
use super::xml::Xml;
use clench_builder::{MeshInertia, MeshSpec};
use clench_dynamics::Model;
use clench_dynamics::model::HeightField;
use clench_math::Vec3;

pub(super) fn write(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for mesh in &model.meshes {
        write_mesh(&mesh.spec, xml);
    }
    for field in &model.height_fields {
        write_height_field(field, xml);
    }
    Ok(())
}

fn write_mesh(spec: &MeshSpec, xml: &mut Xml) {
    let MeshSpec {
        name,
        vertices,
        faces,
        refpos,
        refquat,
        scale,
        inertia,
        max_hull_vertices,
        // Purely visual data are not saved.
        tangents,
        texcoords: _,
        face_texcoords: _,
        // A model has only meshes that could be read.
        unreadable: _,
        origin: _,
    } = spec;
    let vertices: Vec<[f64; 3]> = vertices.iter().copied().map(Vec3::to_array).collect();
    let inertia = match inertia {
        MeshInertia::Convex => "convex",
        MeshInertia::Exact => "exact",
        MeshInertia::Legacy => "legacy",
        MeshInertia::Shell => "shell",
    };
    let mut tag = xml
        .tag("mesh")
        .text("name", name)
        .text("inertia", inertia)
        .numbers_unless("refpos", &refpos.to_array(), &[0.0; 3])
        .numbers_unless("refquat", &refquat.to_array(), &[1.0, 0.0, 0.0, 0.0])
        .numbers_unless("scale", &scale.to_array(), &[1.0; 3]);
    if let Some(bound) = max_hull_vertices {
        tag = tag.integer("maxhullvert", *bound as i64);
    }
    tag = tag.singles("vertex", vertices.as_flattened().iter().copied());
    if !tangents.is_empty() {
        // Only the tangents are read back; the normal may be any vector.
        let frames = tangents
            .iter()
            .flat_map(|[a, b]| [a.cross(*b), *a, *b].map(Vec3::to_array));
        tag = tag.singles("normal", frames.flatten());
    }
    if !faces.is_empty() {
        tag = tag.integers("face", faces.as_flattened().iter().map(|&v| v.into()));
    }
    tag.end();
}

/// Writes rows from the positive end of y, as MJCF requires.
fn write_height_field(field: &HeightField, xml: &mut Xml) {
    let HeightField {
        name,
        shape,
        heights,
    } = field;
    let rows = heights.chunks_exact(shape.columns()).rev().flatten();
    xml.tag("hfield")
        .text("name", name)
        .integer("nrow", shape.rows() as i64)
        .integer("ncol", shape.columns() as i64)
        .numbers("size", &shape.size())
        .singles("elevation", rows.copied())
        .end();
}
