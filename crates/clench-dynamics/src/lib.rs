//! The step of articulated rigid bodies: [`Model`], the data that never changes while stepping; [`State`], the data
//! that a user saves and restores; [`Workspace`], everything derived; and the stages that turn them into the convex
//! problem of `clench-solver` and integrate its solution.
//!
//! `clench-builder` makes models. Users of simulations, batches, sensors and queries want `clench-rigid`, which
//! re-exports the public part of this crate. The rest is internal to `clench-builder` and `clench-rigid` and may change
//! with any version.
//!
//! [`Step`] holds the step as this crate has compiled it for each number type.

#![deny(unreachable_pub, unsafe_code)]

pub mod budget;
pub mod check;
pub mod constants;
pub mod constraint;
pub mod contact;
pub mod context;
pub mod dynamics;
pub mod error;
pub mod fixed;
pub mod geometry;
pub mod history;
pub mod inverse;
pub mod joint_description;
pub mod model;
pub mod options;
pub mod part;
pub mod pipeline;
pub mod profile;
pub mod readings;
pub mod record;
mod remove_derivatives;
pub mod settings;
pub mod singular;
pub mod sleep;
pub mod stages;
pub mod state;
pub mod step;
pub mod stiction;
pub mod workspace;

pub use budget::Budget;
pub use context::StepContext;
pub use error::{Fault, SimError};
pub use model::{Model, Params};
pub use options::RigidOptions;
pub use settings::StepSettings;
pub use state::State;
pub use step::Step;
pub use workspace::Workspace;

// The rows of the solver in the table of options.
#[doc(hidden)]
pub use clench_solver::solver_options;
