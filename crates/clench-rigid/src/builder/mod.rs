//! What an author says about a model, before anything is computed: plain public fields, filled in by a file reader or
//! by hand, turned into a [`Model`](crate::Model) by `ModelBuilder::build`.
//!
//! Angles are radians, orientations unit quaternions, poses relative to the parent body. References between elements
//! are names. `None` means "not said": the builder then applies MuJoCo's rule for that field.
//!
//! A pendulum:
//!
//! ```
//! use clench_rigid::builder::{BodySpec, GeomSpec, JointSpec, ModelBuilder};
//!
//! let mut builder = ModelBuilder::new("pendulum");
//! builder.add_body(
//!     ModelBuilder::WORLD,
//!     BodySpec::new("arm")
//!         .at([0.0, 0.0, 1.0])
//!         .joint(JointSpec::hinge("pivot", [0.0, 1.0, 0.0]).damping(0.01))
//!         .geom(GeomSpec::capsule(0.02, 0.25).at([0.0, 0.0, -0.25]).mass(0.5)),
//! );
//! let model = builder.build()?;
//!
//! let arm = model.body("arm").unwrap();
//! assert_eq!((model.nq, model.nv), (1, 1));
//! assert_eq!(model.params.body_mass[arm], 0.5);
//! # Ok::<(), clench_rigid::builder::BuildError>(())
//! ```

mod actuators;
mod added_mass;
mod assets;
mod bodies;
mod budget;
mod build;
mod cameras;
mod check;
mod constructors;
mod contacts;
mod controllers;
mod element;
mod elements;
mod equalities;
mod error;
mod fuse;
mod geoms;
mod histories;
mod inertia;
mod invweight0;
mod joints;
mod keyframes;
mod length_range;
mod meshes;
mod physics;
mod placed;
mod relations;
mod resolve;
mod sensor_specs;
mod sensors;
mod shapes;
mod sleep;
mod solid;
mod tendons;
mod transmissions;
mod uses;
mod visuals;

pub use assets::{HeightFieldSpec, MeshInertia, MeshSpec};
pub use cameras::{CameraLens, CameraSpec, CameraTracking};
pub use elements::{
    BodySpec, DEFAULT_DYNAMIC_CONSTRAINTS, DEFAULT_SOLIMP, DEFAULT_SOLREF, GeomMass, GeomSpec,
    InertiaSpec, InertialSpec, JointSpec, SiteSpec,
};
pub use error::{BuildError, Origin, shorten};
pub use histories::HistorySpec;
pub use length_range::{LengthRangeMode, LengthRangeSpec};
pub use physics::{CompilerSpec, ContactOverride, InertiaFromGeom, PhysicsSpec};
pub use placed::surfacevel_in_frame;
pub use relations::{
    ActuatorSpec, ConnectAnchor, EqualityKind, EqualitySpec, ExcludeSpec, KeyframeSpec, PairSpec,
    TendonSpec, TransmissionSpec, WrapSpec,
};

use crate::Budget;
use crate::model::{Custom, Texture};
pub use sensor_specs::{
    ContactQuerySpec, ContactSideName, FrameKind, FrameName, GeomsName, SensorSpec, SensorSubject,
};

pub use visuals::{AppearanceSpec, MaterialSpec};

use crate::options::RigidOptions;

/// A model as its author wrote it.
#[derive(Clone, Debug)]
pub struct ModelBuilder {
    /// Name of the model.
    pub name: String,
    /// How to derive what was not said: inertia from geoms, limits from ranges, total mass.
    pub compiler: CompilerSpec,
    /// Time step, gravity, medium, integrator and feature flags.
    pub physics: PhysicsSpec,
    /// Solver options that the source sets; they rank below a user's and above the design's defaults.
    pub options: RigidOptions,
    /// What building the model, and each of its steps, may ask for.
    pub budget: Budget,
    /// Bodies in order of appearance, parents before children; the first is the world.
    pub bodies: Vec<BodySpec>,
    /// Meshes that geoms refer to.
    pub meshes: Vec<MeshSpec>,
    /// Height fields that geoms refer to.
    pub height_fields: Vec<HeightFieldSpec>,
    /// Surfaces that elements refer to by name.
    pub materials: Vec<MaterialSpec>,
    /// Pictures that materials refer to by name.
    pub textures: Vec<Texture>,
    /// Tendons.
    pub tendons: Vec<TendonSpec>,
    /// Actuators.
    pub actuators: Vec<ActuatorSpec>,
    /// Sensors.
    pub sensors: Vec<SensorSpec>,
    /// Equality constraints.
    pub equalities: Vec<EqualitySpec>,
    /// Geom pairs that collide whatever their masks say.
    pub pairs: Vec<PairSpec>,
    /// Body pairs that never collide.
    pub excludes: Vec<ExcludeSpec>,
    /// Stored states.
    pub keyframes: Vec<KeyframeSpec>,
    /// Things worth telling the user once, such as a solver that was replaced.
    pub notes: Vec<String>,
    /// What was left out of the file because it is not supported yet, each with its place.
    pub left_out: Vec<String>,
    /// The user's own data.
    pub custom: Custom,
}

/// A world without anything in it.
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
            tendons: Vec::new(),
            actuators: Vec::new(),
            sensors: Vec::new(),
            equalities: Vec::new(),
            pairs: Vec::new(),
            excludes: Vec::new(),
            keyframes: Vec::new(),
            notes: Vec::new(),
            left_out: Vec::new(),
            custom: Custom::default(),
        }
    }
}
