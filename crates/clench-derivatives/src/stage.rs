//! The stages of a step.

/// A stage of a step, each of which reads the results of those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    Positions,
    Velocities,
    Forces,
}
