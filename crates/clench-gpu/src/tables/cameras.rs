//! Cameras: their bodies, targets and lenses.

use super::{NONE, Tables};
use clench_rigid::model::{CameraMode, Model};

/// The words of a camera.
const CAMERA_FIELDS: [&str; 7] = [
    "CAMERA_MODE",
    "CAMERA_BODY",
    "CAMERA_TARGET",
    "CAMERA_WIDTH",
    "CAMERA_HEIGHT",
    "CAMERA_ORTHOGRAPHIC",
    "CAMERA_INTRINSIC",
];
/// The camera modes.
const MODES: [&str; 5] = ["FIXED", "TRACK", "TRACK_COM", "TARGET_BODY", "TARGET_COM"];

/// Returns the code of a mode, and the target body.
fn mode(mode: CameraMode) -> [usize; 2] {
    match mode {
        CameraMode::Fixed => [0, NONE as usize],
        CameraMode::Track => [1, NONE as usize],
        CameraMode::TrackCom(_) => [2, NONE as usize],
        CameraMode::TargetBody(target) => [3, target],
        CameraMode::TargetBodyCom(target) => [4, target],
    }
}

impl Tables {
    pub(super) fn cameras(&mut self, m: &Model) {
        for names in [&CAMERA_FIELDS[..], &MODES] {
            for (code, name) in names.iter().enumerate() {
                self.constant(name, code);
            }
        }
        self.constant("CAMERA_SIZE", CAMERA_FIELDS.len());
        let (cameras, p) = (&m.cameras, &m.params);
        self.count("NCAMERA", cameras.len());
        let words = cameras.iter().flat_map(|camera| {
            let [mode, target] = mode(camera.mode);
            let [width, height] = camera.resolution;
            let [parallel, intrinsic] = [camera.orthographic, camera.intrinsic].map(usize::from);
            [
                mode,
                camera.body,
                target,
                width,
                height,
                parallel,
                intrinsic,
            ]
        });
        self.words("CAMERAS", words);
        let vectors =
            |v: &[clench_math::Vec3<f64>]| Vec::from_iter(v.iter().flat_map(|v| v.to_array()));
        self.numbers("CAM_POS", vectors(&p.cam_pos));
        self.numbers("CAM_QUAT", p.cam_quat.iter().flat_map(|q| q.to_array()));
        self.numbers("CAM_POS0", vectors(&p.cam_pos0));
        self.numbers("CAM_POSCOM0", vectors(&p.cam_poscom0));
        self.numbers("CAM_MAT0", p.cam_mat0.iter().copied().flatten());
        self.numbers("CAM_FOVY", p.cam_fovy.iter().copied());
        self.numbers("CAM_SENSORSIZE", p.cam_sensorsize.iter().copied().flatten());
        self.numbers("CAM_INTRINSIC", p.cam_intrinsic.iter().copied().flatten());
    }
}
