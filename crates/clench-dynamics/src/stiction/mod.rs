//! Contacts and dry friction that stick (the option `stiction`).
//!
//! Without it, friction rows are dampers: a steady load f slips at the steady velocity R f / b. With it, they are
//! springs too:
//!
//! ```text
//! aref = −b v − k d φ        at rest the displacement φ = R f / (k d) carries the load f
//! ```
//!
//! φ is how far the material points of a contact have moved apart in the tangent plane since they stuck
//! (`displacement`). The relative pose at that time is the *stick reference* of a pair of geoms, one for all its
//! contacts, so that φ does not depend on which points detection returns. Dry friction of a dof or tendon has a
//! displacement of its own (`friction`). After a solve, `return_mapping` drags a reference along, so that no contact
//! stores more than it can carry. All of these are state (`references`) and constant within a step, so the problem
//! remains convex.
//!
//! `docs/contact.md` shows the effects, `docs/mathematics.md` derives steady state and stored energy.

mod displacement;
mod friction;
mod pairs;
mod references;
mod return_mapping;

pub(crate) use friction::advance_friction;
pub use pairs::Stiction;
pub(crate) use return_mapping::drag;

/// The constants of the return mapping, by their names in the GPU kernels.
pub const STICTION_CONSTANTS: &[(&str, f64)] = &[
    ("MAX_STICK_ROTATION", return_mapping::MAX_ROTATION),
    ("MIN_SQUARED_ARM", return_mapping::MIN_SQUARED_ARM),
];
