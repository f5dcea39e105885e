//! Meshes and height fields in every size that frames require.

use super::{FrameId, Frames, located};
use crate::error::LoadError;
use crate::mjcf::linear_map::LinearMap;
use crate::spending::Spending;
use clench_builder::{GeomMass, GeomSpec, HeightFieldSpec, MeshInertia, MeshSpec, ModelBuilder};
use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use std::collections::{HashMap, HashSet};

impl Frames {
    /// Assigns the name of a mesh or height field in the shape given by a frame's map: its own for the first shape,
    /// with a number appended for each other.
    pub(in crate::mjcf) fn instance(&mut self, asset: &mut String, linear_map: LinearMap) {
        if asset.is_empty() {
            return;
        }
        let shapes = self.instances.entry(asset.clone()).or_default();
        let found = shapes.iter().position(|&other| other == linear_map);
        let number = found.unwrap_or_else(|| {
            shapes.push(linear_map);
            let number = shapes.len() - 1;
            if number > 0 {
                self.further_shapes.push((asset.clone(), number));
            }
            number
        });
        if number > 0 {
            *asset = instance_name(asset, number);
        }
    }

    /// Records a geom, number `geom` of a body, if its mesh determines the scaling of its density.
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

    /// Corrects the density of shells, which is mass over area, not over volume.
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

    /// Makes meshes and height fields of the requested sizes.
    ///
    /// # Errors
    /// Returns an error if they exceed the memory budget.
    pub(super) fn make_instances(
        &self,
        builder: &mut ModelBuilder,
        spending: &mut Spending,
    ) -> Result<(), LoadError> {
        let meshes = numbered(builder.meshes.iter().map(|mesh| &mesh.name));
        let fields = numbered(builder.height_fields.iter().map(|field| &field.name));
        for (name, number) in &self.further_shapes {
            let shape = self.instances[name][*number];
            if let Some(&place) = meshes.get(name) {
                let mesh = &builder.meshes[place];
                let bytes = 24 * mesh.vertices.len() + 12 * mesh.faces.len();
                let taken = spending.bytes(bytes as u64);
                taken.map_err(|excess| located(&mesh.origin, "mesh", name, excess))?;
                let mut copy = MeshSpec {
                    name: instance_name(name, *number),
                    ..mesh.clone()
                };
                scale_mesh(&mut copy, shape);
                builder.meshes.push(copy);
            }
            if let Some(&place) = fields.get(name) {
                let field = &builder.height_fields[place];
                let taken = spending.bytes(8 * field.heights.len() as u64);
                taken.map_err(|excess| located(&field.origin, "hfield", name, excess))?;
                let mut copy = HeightFieldSpec {
                    name: instance_name(name, *number),
                    ..field.clone()
                };
                scale_field(&mut copy, shape);
                builder.height_fields.push(copy);
            }
        }
        for (name, shapes) in &self.instances {
            if let Some(&place) = meshes.get(name) {
                scale_mesh(&mut builder.meshes[place], shapes[0]);
            }
            if let Some(&place) = fields.get(name) {
                scale_field(&mut builder.height_fields[place], shapes[0]);
            }
        }
        Ok(())
    }
}

/// Indexes assets by name; the first of a name takes precedence.
fn numbered<'a>(
    names: impl DoubleEndedIterator<Item = &'a String> + ExactSizeIterator,
) -> HashMap<String, usize> {
    let names = names.enumerate().rev();
    names.map(|(place, name)| (name.clone(), place)).collect()
}

/// Scales a height field by a map.
fn scale_field(field: &mut HeightFieldSpec, linear_map: LinearMap) {
    let [x, y, z] = linear_map.factors().to_array();
    let [half_x, half_y, top, base] = field.size;
    field.size = [half_x * x, half_y * y, top * z, base * z];
}

/// Deforms a mesh by a map.
fn scale_mesh(mesh: &mut MeshSpec, linear_map: LinearMap) {
    let along_axes = LinearMap::along_axes(linear_map.factors());
    if linear_map == along_axes {
        mesh.scale = mesh.scale.scale_by(linear_map.factors());
        return;
    }
    // The vertices are final except for the signs of a mirroring scale, which also flips the triangles.
    let back = mesh.refquat.normalize().conjugate();
    let signs = Vec3::from_array(mesh.scale.to_array().map(|x| 1.0_f64.copysign(x)));
    for vertex in &mut mesh.vertices {
        let placed = back.rotate(*vertex - mesh.refpos).scale_by(mesh.scale);
        *vertex = linear_map.apply(placed).scale_by(signs);
    }
    let inverse = Vec3::from_array(mesh.scale.to_array().map(|x| 1.0 / x));
    for tangent in mesh.tangents.iter_mut().flatten() {
        let placed = back.rotate(*tangent).scale_by(inverse);
        *tangent = linear_map.normal(placed).scale_by(signs);
    }
    mesh.refpos = Vec3::ZERO;
    mesh.refquat = Quat::IDENTITY;
    mesh.scale = signs;
}

/// Returns the name of an asset in one of its sizes, as in MuJoCo.
fn instance_name(name: &str, number: usize) -> String {
    match number {
        0 => name.to_owned(),
        _ => format!("{name}@{number}"),
    }
}
