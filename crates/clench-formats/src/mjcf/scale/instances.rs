//! Meshes and height fields in every size that frames ask for.

use super::{FrameId, Frames, located};
use crate::LoadError;
use crate::spending::Spending;
use clench_collide::ShapeKind;
use clench_rigid::builder::{
    GeomMass, GeomSpec, HeightFieldSpec, MeshInertia, MeshSpec, ModelBuilder,
};
use std::collections::HashSet;

impl Frames {
    /// The name of a mesh or height field in the size that a frame asks for: its own for the first size that is asked for, and one
    /// made of that and a number for each other.
    pub(in crate::mjcf) fn instance(&mut self, asset: &mut String, frame: FrameId) {
        if asset.is_empty() {
            return;
        }
        let length = self.scale(frame).length;
        let lengths = self.instances.entry(asset.clone()).or_default();
        let known = lengths.iter().position(|&other| other == length);
        let number = known.unwrap_or_else(|| {
            lengths.push(length);
            lengths.len() - 1
        });
        if number > 0 {
            *asset = instance_name(asset, number);
        }
    }

    /// Remembers a geom, number `geom` of a body, if its mesh decides how its density is scaled.
    pub(in crate::mjcf) fn add_mesh(
        &mut self,
        spec: &GeomSpec,
        body: usize,
        geom: usize,
        frame: FrameId,
    ) {
        let length = self.scale(frame).length;
        let has_density = matches!(spec.mass, GeomMass::Density(_)) && !spec.shellinertia;
        if length != 1.0 && has_density && spec.kind == ShapeKind::Mesh {
            self.meshes.push((body, geom, length));
        }
    }

    /// The density of a shell is mass over area, not over volume.
    pub(super) fn weigh_shells(&self, builder: &mut ModelBuilder) {
        let shells: HashSet<&str> = (builder.meshes.iter())
            .filter(|mesh| mesh.inertia == MeshInertia::Shell)
            .map(|mesh| mesh.name.as_str())
            .collect();
        for &(body, geom, length) in &self.meshes {
            let geom = &mut builder.bodies[body].geoms[geom];
            if let GeomMass::Density(density) = &mut geom.mass
                && shells.contains(geom.mesh.as_str())
            {
                *density *= length;
            }
        }
    }

    /// Makes meshes and height fields of the sizes that were asked for.
    ///
    /// # Errors
    /// More memory for them than is left.
    pub(super) fn make_instances(
        &self,
        builder: &mut ModelBuilder,
        spending: &mut Spending,
    ) -> Result<(), LoadError> {
        for (name, lengths) in &self.instances {
            let mesh = (builder.meshes.iter()).position(|mesh| mesh.name == *name);
            if let Some(place) = mesh {
                let mesh = builder.meshes[place].clone();
                builder.meshes[place].scale = mesh.scale * lengths[0];
                for (number, &length) in lengths.iter().enumerate().skip(1) {
                    let bytes = 24 * mesh.vertices.len() + 12 * mesh.faces.len();
                    let taken = spending.bytes(bytes as u64);
                    taken.map_err(|excess| located(&mesh.origin, "mesh", name, excess))?;
                    builder.meshes.push(MeshSpec {
                        name: instance_name(name, number),
                        scale: mesh.scale * length,
                        ..mesh.clone()
                    });
                }
            }
            let field = (builder.height_fields.iter()).position(|field| field.name == *name);
            if let Some(place) = field {
                let field = builder.height_fields[place].clone();
                let sized = |length: f64| field.size.map(|size| size * length);
                builder.height_fields[place].size = sized(lengths[0]);
                for (number, &length) in lengths.iter().enumerate().skip(1) {
                    let taken = spending.bytes(8 * field.heights.len() as u64);
                    taken.map_err(|excess| located(&field.origin, "hfield", name, excess))?;
                    builder.height_fields.push(HeightFieldSpec {
                        name: instance_name(name, number),
                        size: sized(length),
                        ..field.clone()
                    });
                }
            }
        }
        Ok(())
    }
}

/// The name of an asset in one of its sizes, as MuJoCo gives it.
fn instance_name(name: &str, number: usize) -> String {
    match number {
        0 => name.to_owned(),
        _ => format!("{name}@{number}"),
    }
}
