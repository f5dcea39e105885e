//! Articulated rigid bodies: a [`Sim`] moves one environment, a [`Batch`] as many as memory holds, with sensors, queries, inverse
//! kinematics and what is recorded.
//!
//! The [`Model`], the [`State`] and the step between two states are those of `clench-dynamics`; [`builder`] makes models. File formats
//! live in `clench-formats`, not here.

#![deny(unreachable_pub, unsafe_code)]

pub mod batch;
pub mod ik;
mod known;
mod output;
mod query;
pub mod readout;
mod sensor;
mod sim;

pub use clench_builder as builder;
pub use clench_dynamics::{
    budget, constraint, contact, dynamics, history, inverse, model, options, profile, settings,
    sleep, state, workspace,
};

pub use batch::{Batch, BatchOptions, EnvStatus, Precision};
pub use clench_dynamics::dynamics::frames::Axes;
pub use clench_dynamics::geometry::{RayFilter, RayHit};
pub use clench_dynamics::inverse::Acceleration;
pub use clench_dynamics::{
    Budget, Fault, Model, Params, RigidOptions, SimError, State, StepSettings, Workspace,
};
pub use ik::{Ik, IkOptions, IkSolution, IkStatus, IkTarget, IkTask};
pub use output::Output;
pub use query::Anchor;
pub use sim::{DynamicConstraint, Sim};
// Tables that other crates expand.
#[doc(hidden)]
pub use clench_dynamics::{rigid_options, state_fields};
