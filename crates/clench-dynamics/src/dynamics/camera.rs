//! Camera poses. No motion depends on them, so they are computed on demand.

use crate::model::{CameraMode, Model, Params};
use crate::stages::Positions;
use clench_math::{Mat3, Real, Vec3, kernel};

/// Returns the pose of a camera that is fixed to its body.
#[kernel]
pub fn fixed_pose<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    camera: usize,
) -> (Vec3<T>, Mat3<T>) {
    let body = model.cameras[camera].body;
    let position = pos.xpos[body] + pos.xmat[body] * params.cam_pos[camera];
    let rotation = (pos.xquat[body] * params.cam_quat[camera]).to_matrix();
    (position, rotation)
}

/// Returns the pose of a camera: its position, and its axes as columns.
#[kernel]
pub fn camera_pose<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    camera: usize,
) -> (Vec3<T>, Mat3<T>) {
    let initial_axes = || {
        let [x, y, z] = [0, 3, 6].map(|i| Vec3::from_slice(&params.cam_mat0[camera][i..]));
        Mat3 { rows: [x, y, z] }
    };
    let fixed = || fixed_pose(model, params, pos, camera);
    let body = model.cameras[camera].body;
    match model.cameras[camera].mode {
        CameraMode::Fixed => fixed(),
        CameraMode::Track => (pos.xpos[body] + params.cam_pos0[camera], initial_axes()),
        CameraMode::TrackCom(_) => {
            let position = pos.subtree_com[body] + params.cam_poscom0[camera];
            (position, initial_axes())
        }
        CameraMode::TargetBody(target) => {
            let position = fixed().0;
            (position, looking(position, pos.xpos[target]))
        }
        CameraMode::TargetBodyCom(target) => {
            let position = fixed().0;
            (position, looking(position, pos.subtree_com[target]))
        }
    }
}

/// Returns the axes of a camera that looks from one point to another, with the world's z axis upwards in its image. A
/// direction of zero length becomes the x axis, as in MuJoCo.
#[kernel]
fn looking<T: Real>(from: Vec3<T>, to: Vec3<T>) -> Mat3<T> {
    let up = Vec3::new(T::ZERO, T::ZERO, T::ONE);
    let z = (from - to).normalize().0;
    let x = up.cross(z).normalize().0;
    let y = z.cross(x).normalize().0;
    Mat3::from_columns(x, y, z)
}
