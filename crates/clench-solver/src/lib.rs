//! The convex problem of constrained rigid-body dynamics, and its solvers.
//!
//! ```text
//! minimise over a:   ½ (a − a_unc)ᵀ M (a − a_unc)  +  Σ_k s_k( J_k a − aref_k )
//! ```
//!
//! A [`Problem`] holds M in the sparsity of a kinematic [`Tree`], the unconstrained acceleration and the constraint
//! blocks. A [`Solver`] computes the acceleration and the constraint forces. This crate has no notion of bodies, joints
//! or contacts: a constraint is given by J, aref, D and one of six [`Cost`]s.

#![deny(unreachable_pub)]
// Kernels traverse several arrays by the same row or column; an index is clearer than a chain of zips.
#![allow(clippy::needless_range_loop)]

mod block_index;
mod cg;
mod check;
mod constants;
mod continuation;
mod costs;
mod descent;
mod error;
mod hessian;
mod implicit;
mod islands;
mod iterate;
mod jacobian;
mod line_search;
mod metric_terms;
mod minimum_degree;
mod newton;
mod normal_forces;
mod noslip;
mod options;
mod partition;
mod passivity;
mod plain;
mod prediction;
mod problem;
mod ray;
mod response;
mod results;
mod runs;
mod sliding;
mod slot;
mod solver;
mod sparse;
mod stats;
mod stopwatch;
mod switching;
mod threads;
mod transfer;
mod tree;
mod workspace;

#[doc(hidden)]
pub use constants::METHOD_CONSTANTS;
pub use costs::Cost;
pub use error::ProblemError;
pub use implicit::{ErrorBound, ErrorBounds};
pub use options::{ConstraintSolver, Settings, SolverOptions, Switch};
pub use partition::{Island, Partition};
pub use plain::PlainBlock;
pub use prediction::MAX_ELIMINATED;
pub use problem::{Block, BlockMut, Problem};
pub use response::{Response, block_force};
pub use solver::Solver;
pub use stats::{LaneStats, SolveStats, Status};
pub use stopwatch::{SolveClock, SolvePart, Stopwatch};
pub use threads::Threads;
pub use tree::{Tree, TreeFactor, TreeLu, TreeMatrix, solve_differentiated};
