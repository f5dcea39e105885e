//! The author's description of a model, before anything is computed: plain public fields, filled in by a file reader or
//! by hand, turned into a [`Model`](clench_dynamics::Model) by `ModelBuilder::build`.
//!
//! Angles are radians, orientations unit quaternions, poses relative to the parent body. References between elements
//! are names. `None` means "not specified": the builder then applies MuJoCo's rule for that field.
//!
//! A pendulum:
//!
//! ```
//! use clench_builder::{BodySpec, GeomSpec, JointSpec, ModelBuilder};
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
//! # Ok::<(), clench_builder::BuildError>(())
//! ```

#![deny(unreachable_pub, unsafe_code)]

mod actuators;
mod appearance;
mod bodies;
mod budget;
mod build;
mod camera_spec;
mod cameras;
mod check;
mod constructors;
mod contacts;
mod controllers;
mod derived;
mod element;
mod element_number;
mod elements;
mod equalities;
mod error;
mod fuse;
mod geoms;
mod height_field_spec;
mod histories;
mod inertia;
mod joints;
mod keyframes;
mod length_range;
mod light_spec;
mod lights;
mod meshes;
mod model_builder;
mod physics;
mod placed;
mod processed_meshes;
mod relations;
mod resolve;
mod sensor_specs;
mod sensors;
mod shapes;
mod shared;
mod sleep;
mod solid;
mod tendons;
mod transmissions;
mod user_numbers;
mod uses;
mod visuals;

pub use appearance::{AppearanceSpec, MaterialSpec};
pub use camera_spec::{CameraLens, CameraSpec, CameraTracking};
pub use clench_dynamics::constraint::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
pub use clench_dynamics::model::{MeshInertia, MeshSpec, Origin};
pub use element_number::{ElementNumber, NumberDimension};
pub use elements::{
    BodySpec, DEFAULT_DYNAMIC_CONSTRAINTS, DOF_NUMBERS, GeomMass, GeomSpec, HistorySpec,
    InertiaSpec, InertialSpec, JOINT_NUMBERS, JointSpec, SiteSpec,
};
pub use error::{BuildError, shorten};
pub use height_field_spec::HeightFieldSpec;
pub use light_spec::LightSpec;
pub use model_builder::{DEFAULT_ZNEAR, ModelBuilder};
pub use physics::{
    CompilerSpec, ContactOverride, InertiaFromGeom, LengthRangeMode, LengthRangeSpec, PhysicsSpec,
    UserWidths,
};
pub use placed::surfacevel_in_frame;
pub use relations::{
    ActuatorSpec, ConnectAnchor, EqualityKind, EqualitySpec, ExcludeSpec, KeyframeElement,
    KeyframePart, KeyframeSpec, PairSpec, TENDON_NUMBERS, TendonSpec, TransmissionSpec, WrapSpec,
};
pub use sensor_specs::{
    ContactQuerySpec, ContactSideName, FrameKind, FrameName, GeomsName, SensorSpec, SensorSubject,
};
pub use shared::{ParamRange, SharedLayout};
