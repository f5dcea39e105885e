//! The summary of a call.

/// The summary of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// The number of environments that failed in this call.
    pub failed: usize,
    /// The number of environments that still run.
    pub running: usize,
    /// The number of `autoreset` resets in this call.
    pub resets: usize,
}
