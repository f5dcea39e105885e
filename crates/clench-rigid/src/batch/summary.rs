//! What a call did.

/// What a call did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Environments that failed in this call.
    pub failed: usize,
    /// Environments that run on.
    pub running: usize,
    /// How often environments started over from the initial state in this call, with the option `autoreset`.
    pub resets: usize,
}
