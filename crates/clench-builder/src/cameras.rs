//! Cameras: the author's description, their targets, and their frames at qpos0.

use super::BuildError;
use super::camera_spec::{CameraLens, CameraSpec, CameraTracking};
use super::geoms::{Moved, moved_pose};
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use clench_dynamics::model::{Camera, CameraMode, Model};
use std::sync::Arc;

/// Adds a camera of body `b`, without a target. A camera with a field of view gets the unused focal lengths that MuJoCo
/// stores: the near clipping distance.
pub(super) fn add(spec: &CameraSpec, b: usize, moved: Moved, znear: f64, model: &mut Model) {
    let (fovy, sensorsize, intrinsic) = match spec.lens {
        CameraLens::FieldOfView(fovy) => (fovy, [0.0; 2], [znear, znear, 0.0, 0.0]),
        CameraLens::Intrinsic {
            sensorsize,
            focal,
            principal,
        } => {
            // In single precision, as in MuJoCo's compiler. For an orthographic camera this is the height of the
            // picture in metres.
            let half_angle = (0.5 * sensorsize[1] as f32).atan2(focal[1] as f32);
            let numbers = [focal[0], focal[1], principal[0], principal[1]];
            let fovy = 2.0 * f64::from(half_angle).to_degrees();
            (fovy, sensorsize, numbers)
        }
    };
    model.cameras.push(Camera {
        name: spec.name.clone(),
        body: b,
        mode: CameraMode::Fixed,
        orthographic: spec.orthographic,
        resolution: spec.resolution,
        intrinsic: matches!(spec.lens, CameraLens::Intrinsic { .. }),
        user: Arc::clone(&spec.user),
    });
    let (pos, quat) = moved_pose(moved, spec.pos, spec.quat);
    let p = &mut model.params;
    p.cam_pos.push(pos);
    p.cam_quat.push(quat);
    p.cam_fovy.push(fovy);
    p.cam_sensorsize.push(sensorsize);
    p.cam_intrinsic.push(intrinsic);
}

/// Resolves the bodies that cameras follow or point at.
///
/// # Errors
/// Returns an error if a body does not exist.
pub(super) fn aim_all(
    builder: &ModelBuilder,
    order: &[usize],
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    let specs = order.iter().flat_map(|&b| &builder.bodies[b].cameras);
    for (camera, spec) in model.cameras.iter_mut().zip(specs) {
        camera.mode = mode(&spec.tracking, |name| names.bodies.find(name, spec))?;
    }
    Ok(())
}

/// Returns the tracking mode of a camera or light; `find` looks up bodies by name.
///
/// # Errors
/// Returns an error if a body does not exist.
pub(super) fn mode(
    tracking: &CameraTracking,
    find: impl Fn(&str) -> Result<usize, BuildError>,
) -> Result<CameraMode, BuildError> {
    let named = |name: &String| match name.is_empty() {
        true => Ok(None),
        false => find(name).map(Some),
    };
    let target = |name: &String, mode: fn(usize) -> CameraMode| {
        named(name).map(|body| body.map_or(CameraMode::Fixed, mode))
    };
    Ok(match tracking {
        CameraTracking::Fixed => CameraMode::Fixed,
        CameraTracking::Track => CameraMode::Track,
        CameraTracking::TrackCom(name) => CameraMode::TrackCom(named(name)?),
        CameraTracking::TargetBody(name) => target(name, CameraMode::TargetBody)?,
        CameraTracking::TargetBodyCom(name) => target(name, CameraMode::TargetBodyCom)?,
    })
}
