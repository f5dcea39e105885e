//! The author's description of a light.

use super::Origin;
use super::camera_spec::CameraTracking;
use clench_dynamics::model::LightProperties;
use clench_math::Vec3;

/// A light.
#[derive(Clone, Debug)]
pub struct LightSpec {
    /// Name, possibly empty.
    pub name: String,
    /// Position in the body frame, m.
    pub pos: Vec3<f64>,
    /// Its direction in the body frame; of any length but zero.
    pub dir: Vec3<f64>,
    /// Its tracking mode, as a camera's.
    pub tracking: CameraTracking,
    /// Its optical properties.
    pub properties: LightProperties,
    /// The source location.
    pub origin: Option<Origin>,
}

/// Pointed downwards, as in MuJoCo.
impl Default for LightSpec {
    fn default() -> Self {
        LightSpec {
            name: String::new(),
            pos: Vec3::ZERO,
            dir: Vec3::new(0.0, 0.0, -1.0),
            tracking: CameraTracking::Fixed,
            properties: LightProperties::default(),
            origin: None,
        }
    }
}
