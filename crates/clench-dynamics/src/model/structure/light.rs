//! Lights. Only viewers use them.

use super::camera::CameraMode;
use clench_math::Vec3;

/// A light.
#[derive(Clone, Debug)]
pub struct Light {
    /// Name, possibly empty.
    pub name: String,
    /// Body that carries it.
    pub body: usize,
    /// Its tracking mode, as a camera's.
    pub mode: CameraMode,
    /// Position in the body frame, m.
    pub pos: Vec3<f64>,
    /// Unit vector along which it shines, in the body frame.
    pub dir: Vec3<f64>,
    /// Offset from its body at `qpos0`, in world axes, m.
    pub pos0: Vec3<f64>,
    /// Offset from the centre of mass that it follows at `qpos0`, in world axes, m.
    pub poscom0: Vec3<f64>,
    /// Its direction at `qpos0`, in world axes.
    pub dir0: Vec3<f64>,
    /// Its optical properties.
    pub properties: LightProperties,
}

/// The optical properties of a light, in MuJoCo's terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightProperties {
    /// The kind of light.
    pub kind: LightKind,
    /// True if it is on.
    pub active: bool,
    /// True if it casts shadows.
    pub castshadow: bool,
    /// Attenuation [a, b, c]: at distance d light is divided by a + b d + c d², unless it is directional.
    pub attenuation: [f64; 3],
    /// The cutoff angle of a spot, degrees.
    pub cutoff: f64,
    /// The intensity of a spot falls with this power of the cosine of the angle to its direction.
    pub exponent: f64,
    /// Ambient colour, each part from 0 to 1.
    pub ambient: [f64; 3],
    /// Diffuse colour.
    pub diffuse: [f64; 3],
    /// Specular colour.
    pub specular: [f64; 3],
}

/// The kind of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// From its position, about its direction.
    Spot,
    /// Along its direction everywhere, like sunlight.
    Directional,
    /// From its position in all directions.
    Point,
}

/// MuJoCo's defaults.
impl Default for LightProperties {
    fn default() -> Self {
        LightProperties {
            kind: LightKind::Spot,
            active: true,
            castshadow: true,
            attenuation: [1.0, 0.0, 0.0],
            cutoff: 45.0,
            exponent: 10.0,
            ambient: [0.0; 3],
            diffuse: [0.7; 3],
            specular: [0.3; 3],
        }
    }
}

/// The light at the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headlight {
    /// True if it is on.
    pub active: bool,
    /// Ambient colour, each part from 0 to 1.
    pub ambient: [f64; 3],
    /// Diffuse colour.
    pub diffuse: [f64; 3],
    /// Specular colour.
    pub specular: [f64; 3],
}

/// MuJoCo's defaults.
impl Default for Headlight {
    fn default() -> Self {
        Headlight {
            active: true,
            ambient: [0.1; 3],
            diffuse: [0.4; 3],
            specular: [0.5; 3],
        }
    }
}
