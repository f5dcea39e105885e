//! Lights: checks, poses and targets.

use super::cameras;
use super::element::Element;
use super::geoms::{Moved, moved_pose};
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use super::{BuildError, LightSpec};
use clench_dynamics::model::{CameraMode, Light, LightProperties, Model};
use clench_dynamics::stages::Positions;
use clench_math::{Quat, Vec3};

/// Checks the numbers of a light.
///
/// # Errors
/// Returns an error if numbers are not finite or the direction is zero.
pub(super) fn check(light: &LightSpec) -> Result<(), BuildError> {
    let LightProperties {
        attenuation,
        cutoff,
        exponent,
        ambient,
        diffuse,
        specular,
        ..
    } = light.properties;
    light.require_finite("pos", &light.pos.to_array())?;
    light.require_finite("dir", &light.dir.to_array())?;
    light.require_finite("attenuation", &attenuation)?;
    light.require_finite("cutoff and exponent", &[cutoff, exponent])?;
    light.require_finite("colour", [ambient, diffuse, specular].as_flattened())?;
    match light.dir.norm() > 0.0 {
        true => Ok(()),
        false => Err(light.error("dir must not be zero")),
    }
}

/// Adds a light of body `b`, without a target.
pub(super) fn add(spec: &LightSpec, b: usize, moved: Moved, model: &mut Model) {
    let (pos, rotation) = moved_pose(moved, spec.pos, Quat::IDENTITY);
    let dir = rotation.rotate(spec.dir.normalize().0);
    model.visuals.lights.push(Light {
        name: spec.name.clone(),
        body: b,
        mode: CameraMode::Fixed,
        pos,
        dir,
        pos0: Vec3::ZERO,
        poscom0: Vec3::ZERO,
        dir0: dir,
        properties: spec.properties,
    });
}

/// Resolves the bodies that lights follow or point at.
///
/// # Errors
/// Returns an error if a body does not exist.
pub(super) fn aim_all(
    builder: &ModelBuilder,
    order: &[usize],
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    let specs = order.iter().flat_map(|&b| &builder.bodies[b].lights);
    for (light, spec) in model.visuals.lights.iter_mut().zip(specs) {
        light.mode = cameras::mode(&spec.tracking, |name| names.bodies.find(name, spec))?;
    }
    Ok(())
}

/// Records the initial poses, which tracking lights maintain.
pub(super) fn set_initial_poses(pose0: &Positions<f64>, model: &mut Model) {
    for light in &mut model.visuals.lights {
        let rotation = pose0.xmat[light.body];
        let pos = pose0.xpos[light.body] + rotation * light.pos;
        let from = match light.mode {
            CameraMode::TrackCom(Some(body)) => body,
            CameraMode::Fixed
            | CameraMode::Track
            | CameraMode::TrackCom(None)
            | CameraMode::TargetBody(_)
            | CameraMode::TargetBodyCom(_) => light.body,
        };
        light.pos0 = pos - pose0.xpos[light.body];
        light.poscom0 = pos - pose0.subtree_com[from];
        light.dir0 = rotation * light.dir;
    }
}
