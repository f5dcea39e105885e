//! Lights. Only viewers ask for them.

use super::camera::CameraMode;
use clench_math::Vec3;

/// A light.
#[derive(Clone, Debug)]
pub struct Light {
    /// Name, possibly empty.
    pub name: String,
    /// Body that carries it.
    pub body: usize,
    /// How it follows bodies, as a camera does.
    pub mode: CameraMode,
    /// Position in the body frame, m.
    pub pos: Vec3<f64>,
    /// Unit vector along which it shines, in the body frame.
    pub dir: Vec3<f64>,
    /// Offset from its body at `qpos0`, in world axes, m.
    pub pos0: Vec3<f64>,
    /// Offset from the centre of mass that it follows at `qpos0`, in world axes, m.
    pub poscom0: Vec3<f64>,
    /// Where it shines at `qpos0`, in world axes.
    pub dir0: Vec3<f64>,
    /// What it shines like.
    pub properties: LightProperties,
}

/// What a light shines like, in MuJoCo's terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightProperties {
    /// Where its light goes.
    pub kind: LightKind,
    /// Whether it shines.
    pub active: bool,
    /// Whether things in its way cast shadows.
    pub castshadow: bool,
    /// At the distance d from it light is divided by a + b d + c d², unless it is directional.
    pub attenuation: [f64; 3],
    /// A spot shines so far about its direction, degrees.
    pub cutoff: f64,
    /// A spot is weaker by this power of the cosine of the angle to its direction.
    pub exponent: f64,
    /// Colour of its light from everywhere, each part from 0 to 1.
    pub ambient: [f64; 3],
    /// Colour of its light on what faces it.
    pub diffuse: [f64; 3],
    /// Colour of its highlights.
    pub specular: [f64; 3],
}

/// Where the light of a light goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// From its position, about its direction.
    Spot,
    /// Along its direction everywhere, like the sun's.
    Directional,
    /// From its position into all directions.
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

/// The light that goes with the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headlight {
    /// Whether it shines.
    pub active: bool,
    /// Colour of its light from everywhere, each part from 0 to 1.
    pub ambient: [f64; 3],
    /// Colour of its light on what faces it.
    pub diffuse: [f64; 3],
    /// Colour of its highlights.
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
