//! A model as its author wrote it.

use super::appearance::MaterialSpec;
use super::elements::BodySpec;
use super::physics::{CompilerSpec, PhysicsSpec, UserWidths};
use super::relations::{
    ActuatorSpec, EqualitySpec, ExcludeSpec, KeyframeSpec, PairSpec, TendonSpec,
};
use super::sensor_specs::SensorSpec;
use super::{HeightFieldSpec, MeshSpec};
use clench_dynamics::Budget;
use clench_dynamics::model::{Custom, Headlight, Texture};
use clench_dynamics::options::RigidOptions;

/// A model as its author wrote it.
#[derive(Clone, Debug)]
pub struct ModelBuilder {
    /// Name of the model.
    pub name: String,
    /// The derivation of missing fields: inertia from geoms, limits from ranges, total mass.
    pub compiler: CompilerSpec,
    /// Time step, gravity, medium, integrator and feature flags.
    pub physics: PhysicsSpec,
    /// Solver options that the file sets. They take precedence over the defaults, and a user's options over them.
    pub options: RigidOptions,
    /// Limits on the resources of building the model and of each of its steps.
    pub budget: Budget,
    /// Bodies in order of appearance, parents before children; the first is the world.
    pub bodies: Vec<BodySpec>,
    /// Meshes that geoms refer to.
    pub meshes: Vec<MeshSpec>,
    /// Height fields that geoms refer to.
    pub height_fields: Vec<HeightFieldSpec>,
    /// Materials that elements refer to by name.
    pub materials: Vec<MaterialSpec>,
    /// Textures that materials refer to by name.
    pub textures: Vec<Texture>,
    /// The light at the camera.
    pub headlight: Headlight,
    /// The near clipping distance of cameras, relative to the size of the model: the focal lengths that cameras with a
    /// field of view have without using them.
    pub znear: f64,
    /// Tendons.
    pub tendons: Vec<TendonSpec>,
    /// Actuators.
    pub actuators: Vec<ActuatorSpec>,
    /// Sensors.
    pub sensors: Vec<SensorSpec>,
    /// Equality constraints.
    pub equalities: Vec<EqualitySpec>,
    /// Geom pairs that collide regardless of their masks.
    pub pairs: Vec<PairSpec>,
    /// Body pairs that never collide.
    pub excludes: Vec<ExcludeSpec>,
    /// Stored states.
    pub keyframes: Vec<KeyframeSpec>,
    /// Messages to report to the user once, such as a replaced solver.
    pub notes: Vec<String>,
    /// Elements of the file that were omitted because they are not supported yet, each with its location.
    pub omitted: Vec<String>,
    /// The user's own data.
    pub custom: Custom,
    /// The number of the user's own numbers per element.
    pub user_widths: UserWidths,
}

/// The near clipping distance of a model that gives none.
pub const DEFAULT_ZNEAR: f64 = 0.01;

/// An empty world.
impl Default for ModelBuilder {
    fn default() -> Self {
        ModelBuilder {
            name: String::new(),
            compiler: CompilerSpec::default(),
            physics: PhysicsSpec::default(),
            options: RigidOptions::default(),
            budget: Budget::default(),
            bodies: vec![BodySpec::new("world")],
            meshes: Vec::new(),
            height_fields: Vec::new(),
            materials: Vec::new(),
            textures: Vec::new(),
            headlight: Headlight::default(),
            znear: DEFAULT_ZNEAR,
            tendons: Vec::new(),
            actuators: Vec::new(),
            sensors: Vec::new(),
            equalities: Vec::new(),
            pairs: Vec::new(),
            excludes: Vec::new(),
            keyframes: Vec::new(),
            notes: Vec::new(),
            omitted: Vec::new(),
            custom: Custom::default(),
            user_widths: UserWidths::default(),
        }
    }
}

impl ModelBuilder {
    /// Returns the settings that determine the inertia and the frame of a body.
    pub(super) fn settings_of<'a>(&'a self, body: &'a BodySpec) -> &'a CompilerSpec {
        body.compiler.as_deref().unwrap_or(&self.compiler)
    }
}
