//! The volume and the inertia of a geom, from its shape or from a mesh's triangles.

use super::placed::PlacedGeom;
use clench_collide::{Shape, ShapeKind};
use clench_math::Vec3;

/// Returns the volume in m³, or the surface in m² of a shell. A plane has neither.
pub(super) fn measure(geom: &PlacedGeom) -> f64 {
    match geom.spec.kind {
        ShapeKind::Mesh => geom.mesh.map_or(0.0, |(_, mesh)| mesh.measure),
        kind => Shape::new(kind, geom.size).measure(geom.spec.shellinertia),
    }
}

/// Returns the principal moments in kg m² of the geom with this mass, about its own axes.
pub(super) fn moments(geom: &PlacedGeom, mass: f64) -> Vec3<f64> {
    match geom.spec.kind {
        ShapeKind::Mesh => {
            let half = geom.mesh.map_or(Vec3::ZERO, |(_, mesh)| mesh.half_box);
            // The box with the mesh's moments.
            Shape::new(ShapeKind::Box, half).moments(mass, false)
        }
        kind => Shape::new(kind, geom.size).moments(mass, geom.spec.shellinertia),
    }
}
