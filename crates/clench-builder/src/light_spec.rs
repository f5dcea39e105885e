//! What an author says about a light.

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
    /// Where it shines, in the body frame; of any length but zero.
    pub dir: Vec3<f64>,
    /// How it follows bodies, as a camera does.
    pub tracking: CameraTracking,
    /// What it shines like.
    pub properties: LightProperties,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// Downwards, as in MuJoCo.
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
