//! Structure records: the kind and the relations of each element. No number that a user might randomize.

mod actuator;
mod body;
mod camera;
mod equality;
mod geom;
mod history;
mod keyframe;
mod light;
mod mesh_spec;
mod option;
mod origin;
mod pattern;
mod sleep;
mod tendon;
mod texture;
mod visual;

pub use actuator::{
    Actuator, BiasKind, ControlInput, ControllerStates, DynamicsKind, GainKind, Transmission,
};
pub use body::{Body, Dof, Joint, JointKind, Site};
pub use camera::{Camera, CameraMode};
pub use equality::{Coupled, Equality, EqualityTarget};
pub use geom::{Geom, HeightField, Mesh, Pair};
pub use history::{History, Interpolation};
pub use keyframe::Keyframe;
pub use light::{Headlight, Light, LightKind, LightProperties};
pub use mesh_spec::{MeshInertia, MeshSpec};
pub use option::{Flags, Integrator};
pub use origin::Origin;
pub use pattern::RowPattern;
pub use sleep::{KinematicTree, SleepPolicy};
pub use tendon::{Section, Tendon, Wrap};
pub use texture::{
    Pattern, Pixels, Texture, TextureKind, TextureMark, TexturePattern, TexturePicture,
};
pub use visual::{Appearance, Material, Visuals};
