//! Kinematic trees, and which of them may sleep.

use std::ops::Range;

/// Whether a tree may sleep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SleepPolicy {
    /// As what acts on the tree says: nothing that could move it unseen, then it may.
    #[default]
    Auto,
    /// It never does.
    Never,
    /// It may.
    Allowed,
    /// It may, and begins asleep.
    Init,
}

/// A body whose degrees of freedom depend on no others, and all below it.
#[derive(Clone, Debug)]
pub struct KinematicTree {
    /// Its bodies.
    pub bodies: Range<usize>,
    /// Their position coordinates.
    pub qpos: Range<usize>,
    /// Their degrees of freedom.
    pub dofs: Range<usize>,
    /// Index of the mocap body that carries it.
    pub mocap: Option<usize>,
    /// Whether it may sleep, decided: never [`SleepPolicy::Auto`].
    pub sleep: SleepPolicy,
}
