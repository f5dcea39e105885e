//! Kinematic trees, and their sleep policies.

use std::ops::Range;

/// The sleep policy of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SleepPolicy {
    /// The tree may sleep if nothing can move it undetected.
    #[default]
    Auto,
    /// The tree never sleeps.
    Never,
    /// The tree may sleep.
    Allowed,
    /// The tree may sleep, and starts asleep.
    Init,
}

/// A body whose degrees of freedom depend on no others, and its descendants.
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
    /// The resolved policy: never [`SleepPolicy::Auto`].
    pub sleep: SleepPolicy,
}
