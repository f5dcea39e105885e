//! Meshes and height fields in every size that frames ask for.

use super::{FrameId, Frames, located};
use crate::LoadError;
use crate::mjcf::stretch::Stretch;
use crate::spending::Spending;
use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    GeomMass, GeomSpec, HeightFieldSpec, MeshInertia, MeshSpec, ModelBuilder,
};
use std::collections::HashSet;

impl Frames {
    /// The name of a mesh or height field in the shape that a frame asks for, whose map in its axes is this: its own for the first one
    /// that is asked for, and one made of that and a number for each other.
    pub(in crate::mjcf) fn instance(&mut self, asset: &mut String, stretch: Stretch) {
        if asset.is_empty() {
            return;
        }
        let shapes = self.instances.entry(asset.clone()).or_default();
        let known = shapes.iter().position(|&other| other == stretch);
        let number = known.unwrap_or_else(|| {
            shapes.push(stretch);
            shapes.len() - 1
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
        for (name, shapes) in &self.instances {
            let mesh = (builder.meshes.iter()).position(|mesh| mesh.name == *name);
            if let Some(place) = mesh {
                let mesh = builder.meshes[place].clone();
                stretch_mesh(&mut builder.meshes[place], shapes[0]);
                for (number, &shape) in shapes.iter().enumerate().skip(1) {
                    let bytes = 24 * mesh.vertices.len() + 12 * mesh.faces.len();
                    let taken = spending.bytes(bytes as u64);
                    taken.map_err(|excess| located(&mesh.origin, "mesh", name, excess))?;
                    let mut copy = MeshSpec {
                        name: instance_name(name, number),
                        ..mesh.clone()
                    };
                    stretch_mesh(&mut copy, shape);
                    builder.meshes.push(copy);
                }
            }
            let field = (builder.height_fields.iter()).position(|field| field.name == *name);
            if let Some(place) = field {
                let field = builder.height_fields[place].clone();
                let sized = |shape: Stretch| {
                    let [x, y, z] = shape.factors().to_array();
                    let [half_x, half_y, top, base] = field.size;
                    [half_x * x, half_y * y, top * z, base * z]
                };
                builder.height_fields[place].size = sized(shapes[0]);
                for (number, &shape) in shapes.iter().enumerate().skip(1) {
                    let taken = spending.bytes(8 * field.heights.len() as u64);
                    taken.map_err(|excess| located(&field.origin, "hfield", name, excess))?;
                    builder.height_fields.push(HeightFieldSpec {
                        name: instance_name(name, number),
                        size: sized(shape),
                        ..field.clone()
                    });
                }
            }
        }
        Ok(())
    }
}

/// Gives a mesh the shape that a map makes of it.
fn stretch_mesh(mesh: &mut MeshSpec, stretch: Stretch) {
    let along_axes = Stretch::along_axes(stretch.factors());
    if stretch == along_axes {
        mesh.scale = mesh.scale.scale_by(stretch.factors());
        return;
    }
    // The vertices are written as they end up, but for the signs of a scale that mirrors, which also turns the triangles.
    let back = mesh.refquat.normalize().conjugate();
    let signs = Vec3::from_array(mesh.scale.to_array().map(|x| 1.0_f64.copysign(x)));
    for vertex in &mut mesh.vertices {
        let placed = back.rotate(*vertex - mesh.refpos).scale_by(mesh.scale);
        *vertex = stretch.apply(placed).scale_by(signs);
    }
    let inverse = Vec3::from_array(mesh.scale.to_array().map(|x| 1.0 / x));
    for tangent in mesh.tangents.iter_mut().flatten() {
        let placed = back.rotate(*tangent).scale_by(inverse);
        *tangent = stretch.normal(placed).scale_by(signs);
    }
    mesh.refpos = Vec3::ZERO;
    mesh.refquat = Quat::IDENTITY;
    mesh.scale = signs;
}

/// The name of an asset in one of its sizes, as MuJoCo gives it.
fn instance_name(name: &str, number: usize) -> String {
    match number {
        0 => name.to_owned(),
        _ => format!("{name}@{number}"),
    }
}
