//! Articulated rigid bodies: a [`Sim`] simulates one environment, a [`Batch`] many, with sensors, queries, inverse
//! kinematics and recorded outputs.
//!
//! The [`Model`], the [`State`] and the step are defined in `clench-dynamics`; [`builder`] creates models. File formats
//! are in `clench-formats`.

#![deny(unreachable_pub, unsafe_code)]

pub mod batch;
pub mod ik;
mod output;
mod precision;
mod query;
pub mod readout;
mod sensor;
mod sim;
mod validity;

pub use clench_builder as builder;
pub use clench_dynamics::{
    budget, constraint, contact, dynamics, history, inverse, model, options, profile, settings,
    sleep, state, stiction, workspace,
};

pub use batch::{Batch, BatchOptions, EnvStatus};
pub use clench_dynamics::dynamics::frames::Axes;
pub use clench_dynamics::geometry::{RayFilter, RayHit};
pub use clench_dynamics::inverse::Acceleration;
pub use clench_dynamics::{
    Budget, Fault, Model, Params, RigidOptions, SimError, State, StepSettings, Workspace,
};
pub use ik::{Ik, IkOptions, IkSolution, IkStatus, IkTarget, IkTask};
pub use output::Output;
#[doc(hidden)]
pub use output::Source as OutputSource;
pub use precision::Precision;
pub use query::{Anchor, Place, Query};
#[doc(hidden)]
pub use sensor::evaluate as evaluate_sensors;
pub use sim::{DynamicConstraint, Sim};
// Macro tables for other crates.
#[doc(hidden)]
pub use clench_dynamics::{rigid_options, state_fields};
