//! The author's description of a camera.

use super::Origin;
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// The tracking mode of a camera.
#[derive(Clone, Debug, Default)]
pub enum CameraTracking {
    /// Fixed to its body.
    #[default]
    Fixed,
    /// At a constant offset from its body in world axes, with a constant orientation.
    Track,
    /// The same from the centre of mass of its body and its descendants. If the name is not empty, the offset is the
    /// initial one from the centre of mass of the named body (as with `target` in MuJoCo).
    TrackCom(String),
    /// Fixed in position to its body, and pointed at the named body; entirely fixed if the name is empty.
    TargetBody(String),
    /// Pointed at the centre of mass of the named body and its descendants.
    TargetBodyCom(String),
}

/// The field of view of a camera.
#[derive(Clone, Copy, Debug)]
pub enum CameraLens {
    /// The vertical field of view, degrees; for an orthographic camera the height of the picture, m.
    FieldOfView(f64),
    /// A pinhole in front of a sensor.
    Intrinsic {
        /// Width and height of the sensor, m.
        sensorsize: [f64; 2],
        /// Horizontal and vertical focal length, m.
        focal: [f64; 2],
        /// Offset of the principal point, m.
        principal: [f64; 2],
    },
}

/// A camera: it looks along the negative z axis of its frame, x to the right and y up.
#[derive(Clone, Debug)]
pub struct CameraSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Position in the body frame, m.
    pub pos: Vec3<f64>,
    /// Orientation in the body frame.
    pub quat: Quat<f64>,
    /// Its tracking mode.
    pub tracking: CameraTracking,
    /// True if the projection is orthographic.
    pub orthographic: bool,
    /// Its field of view.
    pub lens: CameraLens,
    /// Pixels: width, height.
    pub resolution: [usize; 2],
    /// The user's own numbers, unused by physics.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// One pixel with a field of view of 45 degrees, as in MuJoCo.
impl Default for CameraSpec {
    fn default() -> Self {
        CameraSpec {
            name: String::new(),
            pos: Vec3::ZERO,
            quat: Quat::IDENTITY,
            tracking: CameraTracking::Fixed,
            orthographic: false,
            lens: CameraLens::FieldOfView(45.0),
            resolution: [1; 2],
            user: Arc::default(),
            origin: None,
        }
    }
}
