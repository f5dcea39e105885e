//! Cameras: their bodies, targets and lenses.

use super::{NONE, Tables};
use crate::codes::{Code, codes, row};
use clench_rigid::model::{CameraMode, Model};

row! {
    /// The words of a camera.
    words CameraWords, "CAMERA" {
        mode,
        body,
        target,
        width,
        height,
        orthographic,
        intrinsic,
    }
}
codes! {
    /// The camera modes.
    enum Mode {
        Fixed = "FIXED",
        Track = "TRACK",
        TrackCom = "TRACK_COM",
        TargetBody = "TARGET_BODY",
        TargetCom = "TARGET_COM",
    }
}

/// Returns a mode without its body, and the target body.
fn mode(mode: CameraMode) -> (Mode, usize) {
    match mode {
        CameraMode::Fixed => (Mode::Fixed, NONE as usize),
        CameraMode::Track => (Mode::Track, NONE as usize),
        CameraMode::TrackCom(_) => (Mode::TrackCom, NONE as usize),
        CameraMode::TargetBody(target) => (Mode::TargetBody, target),
        CameraMode::TargetBodyCom(target) => (Mode::TargetCom, target),
    }
}

impl Tables {
    pub(super) fn cameras(&mut self, m: &Model) {
        self.row::<CameraWords>();
        self.codes::<Mode>();
        let (cameras, p) = (&m.cameras, &m.params);
        self.count("NCAMERA", cameras.len());
        let words = cameras.iter().flat_map(|camera| {
            let (mode, target) = mode(camera.mode);
            let [width, height] = camera.resolution;
            let row = CameraWords {
                mode: mode.code(),
                body: camera.body,
                target,
                width,
                height,
                orthographic: usize::from(camera.orthographic),
                intrinsic: usize::from(camera.intrinsic),
            };
            row.words()
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
