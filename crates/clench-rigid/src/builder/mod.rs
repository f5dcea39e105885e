//! What an author says about a model, before anything is computed: plain public fields, filled in by a file reader or
//! by hand, turned into a [`Model`](crate::Model) by `ModelBuilder::build`.
//!
//! Angles are radians, orientations unit quaternions, poses relative to the parent body. References between elements
//! are names. `None` means "not said": the builder then applies MuJoCo's rule for that field.

mod elements;
mod error;
mod physics;

pub use elements::{
    ActuatorSpec, BodySpec, ConnectAnchor, DEFAULT_SOLIMP, DEFAULT_SOLREF, EqualityKind,
    EqualitySpec, ExcludeSpec, GeomMass, GeomSpec, InertiaSpec, InertialSpec, JointSpec,
    KeyframeSpec, PairSpec, SiteSpec, TendonSpec, TransmissionSpec,
};
pub use error::{BuildError, Origin};
pub use physics::{CompilerSpec, ContactOverride, InertiaFromGeom, PhysicsSpec};

use clench_solver::RigidOptions;

/// A model as its author wrote it.
#[derive(Clone, Debug, Default)]
pub struct ModelBuilder {
    /// Name of the model.
    pub name: String,
    /// How to derive what was not said: inertia from geoms, limits from ranges, total mass.
    pub compiler: CompilerSpec,
    /// Time step, gravity, medium, integrator and feature flags.
    pub physics: PhysicsSpec,
    /// Solver options that the source sets; they rank below a user's and above the design's defaults.
    pub options: RigidOptions,
    /// Bodies in order of appearance, parents before children; the first is the world.
    pub bodies: Vec<BodySpec>,
    /// Fixed tendons.
    pub tendons: Vec<TendonSpec>,
    /// Actuators.
    pub actuators: Vec<ActuatorSpec>,
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
}
