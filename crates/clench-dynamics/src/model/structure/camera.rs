//! Cameras: frames that look along their negative z axis, x to the right and y up.

use std::sync::Arc;

/// How a camera's frame follows bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraMode {
    /// Fixed to its body.
    Fixed,
    /// At a constant offset from its body, with a constant orientation, both in world axes and as they are at `qpos0`.
    Track,
    /// The same at an offset from the centre of mass of its body and all below it. If it names a body, the offset is the one from that
    /// body's centre of mass at `qpos0`, as in MuJoCo.
    TrackCom(Option<usize>),
    /// Placed as one that is fixed, turned towards a body.
    TargetBody(usize),
    /// Turned towards the centre of mass of a body and all below it.
    TargetBodyCom(usize),
}

/// A camera.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Name, possibly empty.
    pub name: String,
    /// Body that carries it.
    pub body: usize,
    /// How its frame follows bodies.
    pub mode: CameraMode,
    /// Whether its lines of sight are parallel.
    pub orthographic: bool,
    /// Pixels: width, height.
    pub resolution: [usize; 2],
    /// Whether its field of view comes from a focal length and the size of its sensor, not from `fovy`.
    pub intrinsic: bool,
    /// The user's own numbers, as many for each element of its kind.
    pub user: Arc<[f64]>,
}
