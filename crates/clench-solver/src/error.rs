//! What is wrong with a problem that is not one.

/// Why a problem is not one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// Tree numbering.
    #[error("dof {dof} has parent {parent}, which does not come before it")]
    ParentAfterChild {
        /// The child.
        dof: usize,
        /// Its parent.
        parent: usize,
    },
    /// A slice of the wrong length.
    #[error("{what} has {found} entries where {expected} are needed")]
    WrongLength {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it needs.
        expected: usize,
    },
    /// An infinite or undefined number.
    #[error("{what} is not finite at entry {index} (lane {lane})")]
    NotFinite {
        /// Which array.
        what: &'static str,
        /// Where in it.
        index: usize,
        /// Which lane.
        lane: usize,
    },
    /// The mass matrix cannot be factored.
    #[error("the mass matrix is not positive definite (lane {lane})")]
    MassNotPositiveDefinite {
        /// Which lane.
        lane: usize,
    },
    /// A block that makes no sense.
    #[error("constraint block {block}: {reason}")]
    Block {
        /// Which block.
        block: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
}
