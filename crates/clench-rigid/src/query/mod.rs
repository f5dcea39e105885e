//! Queries of a simulation, one file per subject. Results that depend on positions or velocities are computed on demand
//! if they are stale. No query changes a status, a statistic or a bit of a later step. `table.rs` lists those whose
//! answers are numbers, of a `Batch` too. The computations themselves are in `dynamics`.

mod answer;
mod cast;
mod checks;
mod frames;
mod geoms;
mod ik;
mod inertia;
mod input;
mod inverse;
mod scan;
mod table;

pub(crate) use checks::{check_body, check_object};
pub use frames::Anchor;
pub use input::QueryInput;
pub(crate) use table::geom_of;
pub use table::{Place, Query};
