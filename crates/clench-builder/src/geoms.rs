//! Geoms and sites.

use super::element::Element;
use super::meshes::reach;
use super::placed::Assets;
use super::{BuildError, GeomSpec, SiteSpec};
use clench_collide::ShapeKind;
use clench_dynamics::model::{Geom, Model, Site};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// The pose of a body's frame in the model's frame if it was moved, with a unit quaternion; its geoms and sites follow.
pub(super) type Moved = Option<(Vec3<f64>, Quat<f64>)>;

pub(super) fn moved_pose(moved: Moved, pos: Vec3<f64>, quat: Quat<f64>) -> (Vec3<f64>, Quat<f64>) {
    let quat = quat.normalize();
    match moved {
        None => (pos, quat),
        Some((origin, rotation)) => (origin + rotation.rotate(pos), (rotation * quat).normalize()),
    }
}

/// Adds a geom of body `b`.
///
/// # Errors
/// Returns an error if the geom does not fit its asset, or if a plane would move.
pub(super) fn add_geom(
    spec: &GeomSpec,
    b: usize,
    moved: Moved,
    assets: &Assets,
    model: &mut Model,
) -> Result<(), BuildError> {
    let placed = assets.place(spec)?;
    let weld = &model.bodies[model.bodies[b].weld];
    if spec.kind == ShapeKind::Plane && !weld.joints.is_empty() {
        return Err(spec.error("a plane can only be attached to a static body"));
    }
    let flat = matches!(spec.kind, ShapeKind::Plane | ShapeKind::HeightField);
    let fluid_ellipsoid = spec.fluid_ellipsoid && !flat;
    model.bodies[b].fluid_ellipsoids |= fluid_ellipsoid;
    model.geoms.push(Geom {
        name: spec.name.clone(),
        kind: spec.kind,
        mesh: placed.mesh.map(|(index, _)| index),
        height_field: placed.height_field,
        body: b,
        contype: spec.contype,
        conaffinity: spec.conaffinity,
        condim: spec.condim,
        priority: spec.priority,
        group: spec.group,
        visible: spec.visible,
        fluid_ellipsoid,
        user: Arc::clone(&spec.user),
        origin: spec.origin.clone(),
    });
    let appearance = assets.palette.resolve(&spec.appearance);
    model.visuals.geoms.push(appearance);
    let (pos, quat) = moved_pose(moved, placed.pos, placed.quat);
    let p = &mut model.params;
    p.geom_pos.push(pos);
    p.geom_quat.push(quat);
    p.geom_size.push(placed.size);
    p.geom_rbound.push(placed.rbound);
    p.geom_friction.push(spec.friction);
    p.geom_margin.push(spec.margin);
    p.geom_gap.push(spec.gap);
    p.geom_surfacevel.push(placed.surfacevel);
    p.geom_adhesion.push(spec.adhesion);
    p.geom_fluidcoef.push(spec.fluidcoef);
    // Constants set these once the model is complete.
    p.geom_virtualmass.push([0.0; 3]);
    p.geom_virtualinertia.push([0.0; 3]);
    p.geom_solmix.push(spec.solmix);
    p.geom_solref.push(spec.solref);
    p.geom_solimp.push(spec.solimp);
    Ok(())
}

/// Adds a site of body `b`.
///
/// # Errors
/// Returns an error if a mesh does not exist.
pub(super) fn add_site(
    spec: &SiteSpec,
    b: usize,
    moved: Moved,
    assets: &Assets,
    model: &mut Model,
) -> Result<(), BuildError> {
    let mesh = assets.mesh_of_site(spec)?;
    let appearance = assets.palette.resolve(&spec.appearance);
    model.visuals.sites.push(appearance);
    model.sites.push(Site {
        name: spec.name.clone(),
        body: b,
        kind: spec.kind,
        group: spec.group,
        mesh: mesh.map(|(index, _)| index),
        user: Arc::clone(&spec.user),
    });
    let size = mesh.map_or(Vec3::from_array(spec.size), |(_, mesh)| reach(mesh));
    model.params.site_size.push(size);
    let (pos, quat) = moved_pose(moved, spec.pos, spec.quat);
    model.params.site_pos.push(pos);
    model.params.site_quat.push(quat);
    Ok(())
}
