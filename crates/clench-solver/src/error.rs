//! The errors of an invalid problem.

/// The reason why a problem is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A parent does not precede its child.
    #[error("dof {dof} has parent {parent}, which does not come before it")]
    ParentAfterChild {
        /// The child.
        dof: usize,
        /// Its parent.
        parent: usize,
    },
    /// An array has the wrong length.
    #[error("{what} has {found} entries where {expected} are needed")]
    WrongLength {
        /// The array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The required length.
        expected: usize,
    },
    /// A number is infinite or NaN.
    #[error("{what} is not finite at entry {index} (lane {lane})")]
    NotFinite {
        /// The array.
        what: &'static str,
        /// The index in the array.
        index: usize,
        /// The lane.
        lane: usize,
    },
    /// The mass matrix is not positive definite.
    #[error("the mass matrix is not positive definite (lane {lane})")]
    MassNotPositiveDefinite {
        /// The lane.
        lane: usize,
    },
    /// A constraint block is invalid.
    #[error("constraint block {block}: {reason}")]
    Block {
        /// The index of the block.
        block: usize,
        /// The reason.
        reason: &'static str,
    },
}
