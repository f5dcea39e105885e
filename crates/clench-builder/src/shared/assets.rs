//! The meshes and height fields of several models, each distinct one once.

use clench_collide::ShapeKind;
use clench_dynamics::model::{HeightField, Mesh, Model, SensorTarget};
use std::collections::HashMap;
use std::sync::Arc;

/// The distinct meshes and height fields of models.
#[derive(Debug, Default)]
pub(super) struct Assets {
    meshes: Vec<Arc<Mesh>>,
    height_fields: Vec<Arc<HeightField>>,
    /// The meshes with the same numbers of vertices and faces.
    similar: HashMap<[usize; 2], Vec<usize>>,
}

/// Returns true if two meshes differ in nothing that a simulation reads.
fn are_equal(a: &Mesh, b: &Mesh) -> bool {
    a.hull.is_some() == b.hull.is_some()
        && (a.pos, a.quat) == (b.pos, b.quat)
        && a.vertices == b.vertices
        && a.faces == b.faces
        && a.tangents == b.tangents
}

impl Assets {
    /// Adds the meshes and height fields of a model, and lets the model share equal meshes with those before it.
    pub(super) fn share_meshes(&mut self, model: &mut Arc<Model>) {
        for index in 0..model.meshes.len() {
            let mesh = Arc::clone(&model.meshes[index]);
            let similar = self.similar.entry([mesh.vertices.len(), mesh.faces.len()]);
            let similar = similar.or_default();
            let equal = |&&shared: &&usize| {
                let shared = &self.meshes[shared];
                Arc::ptr_eq(shared, &mesh) || are_equal(shared, &mesh)
            };
            let Some(&shared) = similar.iter().find(equal) else {
                similar.push(self.meshes.len());
                self.meshes.push(mesh);
                continue;
            };
            if !Arc::ptr_eq(&self.meshes[shared], &mesh) {
                Arc::make_mut(model).meshes[index] = Arc::clone(&self.meshes[shared]);
            }
        }
        for field in &model.height_fields {
            let shared = &mut self.height_fields;
            if !shared.iter().any(|shared| Arc::ptr_eq(shared, field)) {
                shared.push(Arc::clone(field));
            }
        }
    }

    /// Returns the index of a mesh that is shared.
    fn mesh(&self, mesh: &Arc<Mesh>) -> Option<usize> {
        let similar = (self.similar).get(&[mesh.vertices.len(), mesh.faces.len()])?;
        let is_same = |&&shared: &&usize| Arc::ptr_eq(&self.meshes[shared], mesh);
        similar.iter().find(is_same).copied()
    }

    /// Replaces the indices of meshes of sites and sensors by those among all meshes.
    pub(super) fn rename_meshes(&self, model: &mut Model) {
        for site in &mut model.sites {
            site.mesh = site.mesh.and_then(|mesh| self.mesh(&model.meshes[mesh]));
        }
        for sensor in &mut model.sensors {
            if let SensorTarget::Taxels { mesh, .. } = &mut sensor.target {
                *mesh = self.mesh(&model.meshes[*mesh]).unwrap_or(*mesh);
            }
        }
    }

    /// Returns the mesh or height field of each geom of the layout in a model.
    pub(super) fn of_geoms(
        &self,
        model: &Model,
        geoms: &[usize],
        slots: usize,
    ) -> Vec<Option<u32>> {
        let mut assets = vec![None; slots];
        for (geom, &slot) in model.geoms.iter().zip(geoms) {
            let mesh = geom.mesh.and_then(|mesh| self.mesh(&model.meshes[mesh]));
            let field = geom.height_field.and_then(|field| {
                let field = &model.height_fields[field];
                let mut shared = self.height_fields.iter();
                shared.position(|shared| Arc::ptr_eq(shared, field))
            });
            assets[slot] = mesh.or(field).map(|asset| asset as u32);
        }
        assets
    }

    /// Gives a layout all meshes and height fields, and to each of its geoms that of its owner.
    pub(super) fn give_to(self, layout: &mut Model, owners: &[(usize, usize)]) {
        for (slot, &(owner, _)) in owners.iter().enumerate() {
            let asset = layout.geom_assets[owner][slot].map(|asset| asset as usize);
            let geom = &mut layout.geoms[slot];
            (geom.mesh, geom.height_field) = match geom.kind {
                ShapeKind::HeightField => (None, asset),
                _ => (asset, None),
            };
        }
        (layout.meshes, layout.height_fields) = (self.meshes, self.height_fields);
    }
}
