//! What an author says about a camera.

use super::Origin;
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// How a camera's frame follows bodies.
#[derive(Clone, Debug, Default)]
pub enum CameraTracking {
    /// Fixed to its body.
    #[default]
    Fixed,
    /// At a constant offset from its body in world axes, with a constant orientation.
    Track,
    /// The same from the centre of mass of its body and all below it. Its offset is that from the centre of mass of the body of that
    /// name at first, if it is not empty (as in MuJoCo, where `target` says so).
    TrackCom(String),
    /// Fixed in place to its body, turned towards the body of that name; fixed altogether where it is empty.
    TargetBody(String),
    /// Turned towards the centre of mass of that body and all below it.
    TargetBodyCom(String),
}

/// What a camera sees at once.
#[derive(Clone, Copy, Debug)]
pub enum CameraLens {
    /// The vertical field of view, degrees; with parallel lines of sight, the height of the picture, m.
    FieldOfView(f64),
    /// A pinhole before a sensor.
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
    /// How its frame follows bodies.
    pub tracking: CameraTracking,
    /// Whether its lines of sight are parallel.
    pub orthographic: bool,
    /// What it sees at once.
    pub lens: CameraLens,
    /// Pixels: width, height.
    pub resolution: [usize; 2],
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// One pixel that sees 45 degrees, as in MuJoCo.
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
