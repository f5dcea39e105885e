//! The meshes of models that exist, and of the last one that was built: a model with an equal mesh shares it.

use super::meshes::process;
use super::{BuildError, MeshSpec};
use clench_dynamics::model::Mesh;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

static PROCESSED: Mutex<ProcessedMeshes> = Mutex::new(ProcessedMeshes {
    existing: BTreeMap::new(),
    last: Vec::new(),
});

struct ProcessedMeshes {
    /// The meshes that exist, by name. Those that were dropped since the last model are still listed.
    existing: BTreeMap<String, Vec<Weak<Mesh>>>,
    /// The meshes of the last model. They stay, for users who edit a description and build it again.
    last: Vec<Arc<Mesh>>,
}

/// Returns a mesh for use in a model: an equal one that exists, or a new one. `keeps_hull` requests its convex hull.
///
/// # Errors
/// Returns the errors of [`process`].
pub(super) fn find_or_process(spec: &MeshSpec, keeps_hull: bool) -> Result<Arc<Mesh>, BuildError> {
    let namesakes: Vec<_> = with_processed(|processed| {
        let namesakes = processed.existing.get(&spec.name).into_iter().flatten();
        namesakes.filter_map(Weak::upgrade).collect()
    });
    let is_equal =
        |mesh: &Arc<Mesh>| mesh.hull.is_some() == keeps_hull && are_equal(&mesh.spec, spec);
    if let Some(mesh) = namesakes.into_iter().find(is_equal) {
        return Ok(mesh);
    }
    let mesh = Arc::new(process(spec, keeps_hull)?);
    with_processed(|ProcessedMeshes { existing, .. }| {
        let namesakes = existing.entry(spec.name.clone()).or_default();
        namesakes.push(Arc::downgrade(&mesh));
    });
    Ok(mesh)
}

/// Stores the meshes of a model as those of the last one, unless it has none.
pub(super) fn keep(meshes: &[Arc<Mesh>]) {
    if meshes.is_empty() {
        return;
    }
    with_processed(|ProcessedMeshes { existing, last }| {
        *last = meshes.to_vec();
        existing.retain(|_, namesakes| {
            namesakes.retain(|mesh| mesh.strong_count() > 0);
            !namesakes.is_empty()
        });
    });
}

fn with_processed<R>(work: impl FnOnce(&mut ProcessedMeshes) -> R) -> R {
    work(&mut PROCESSED.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Returns true if two meshes differ at most in their source location.
fn are_equal(a: &MeshSpec, b: &MeshSpec) -> bool {
    let MeshSpec {
        name,
        vertices,
        faces,
        texcoords,
        face_texcoords,
        tangents,
        refpos,
        refquat,
        scale,
        inertia,
        max_hull_vertices,
        unreadable,
        origin: _,
    } = a;
    (name, refpos, refquat, scale, inertia)
        == (&b.name, &b.refpos, &b.refquat, &b.scale, &b.inertia)
        && (max_hull_vertices, unreadable) == (&b.max_hull_vertices, &b.unreadable)
        && (vertices, faces, tangents) == (&b.vertices, &b.faces, &b.tangents)
        && (texcoords, face_texcoords) == (&b.texcoords, &b.face_texcoords)
}
