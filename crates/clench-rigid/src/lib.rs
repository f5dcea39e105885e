//! Articulated rigid bodies: an immutable [`Model`] and its builder, smooth dynamics, contact selection, and the
//! constraints that turn a model and a state into the convex problem that `clench-solver` solves. A [`Sim`] moves one
//! environment, a [`Batch`] as many as memory holds.
//!
//! Data lives in three kinds of struct: [`Model`] never changes while stepping, [`State`] is what a user saves and
//! restores, [`Workspace`] is everything derived. File formats live in `clench-formats`, not here.

#![deny(unreachable_pub, unsafe_code)]

pub mod batch;
pub mod budget;
pub mod builder;
mod check;
pub mod constraint;
pub mod contact;
pub mod dynamics;
mod error;
mod fixed;
mod geometry;
pub mod history;
pub mod ik;
pub mod inverse;
mod known;
pub mod model;
pub mod options;
mod output;
pub mod pipeline;
mod place;
pub mod profile;
mod query;
pub mod readout;
pub mod sensor;
pub mod settings;
mod sim;
mod singular;
pub mod sleep;
mod stages;
pub mod state;
pub mod workspace;

pub use batch::{Batch, BatchOptions, EnvStatus, Precision};
pub use budget::Budget;
pub use error::{Fault, SimError};
pub use ik::{Ik, IkOptions, IkSolution, IkStatus, IkTarget, IkTask};
pub use inverse::Acceleration;
pub use options::RigidOptions;
pub use settings::StepSettings;
// The rows of the solver in the table of options.
#[doc(hidden)]
pub use clench_solver::solver_options;
pub use dynamics::frames::Axes;
pub use geometry::{RayFilter, RayHit};
pub use model::{Model, Params};
pub use output::Output;
pub use query::Anchor;
pub use sim::{DynamicConstraint, Sim};
pub use state::State;
pub use workspace::Workspace;
