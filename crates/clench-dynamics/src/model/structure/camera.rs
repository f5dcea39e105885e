//! Cameras: frames that look along their negative z axis, x to the right and y up.

use std::sync::Arc;

/// The tracking mode of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraMode {
    /// Fixed to its body.
    Fixed,
    /// At a constant offset from its body, with a constant orientation, both in world axes and with their values at
    /// `qpos0`.
    Track,
    /// The same at an offset from the centre of mass of its body's subtree. If it names a body, the offset is the one
    /// from the centre of mass of that body's subtree at `qpos0`, as in MuJoCo.
    TrackCom(Option<usize>),
    /// Positioned as a fixed one, and pointed at a body.
    TargetBody(usize),
    /// Pointed at the centre of mass of a body and its descendants.
    TargetBodyCom(usize),
}

/// A camera.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Name, possibly empty.
    pub name: String,
    /// Body that carries it.
    pub body: usize,
    /// Its tracking mode.
    pub mode: CameraMode,
    /// True if the projection is orthographic.
    pub orthographic: bool,
    /// Pixels: width, height.
    pub resolution: [usize; 2],
    /// True if its field of view comes from a focal length and the size of its sensor, not from `fovy`.
    pub intrinsic: bool,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
}
