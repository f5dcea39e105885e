//! Equality constraints.

/// What an equality constraint holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EqualityTarget {
    /// Points of two bodies coincide; anchors are `params.eq_anchor1`, `eq_anchor2`.
    Connect {
        /// First body.
        body1: usize,
        /// Second body.
        body2: usize,
    },
    /// Frames of two bodies coincide; poses are `params.eq_anchor1`, `eq_anchor2`,
    /// `eq_quat1`, `eq_quat2`, `eq_torquescale`.
    Weld {
        /// First body.
        body1: usize,
        /// Second body.
        body2: usize,
    },
    /// A joint follows another by `params.eq_polycoef`.
    Joint {
        /// The joint that follows.
        joint1: usize,
        /// The joint that leads.
        joint2: Option<usize>,
    },
    /// A tendon follows another by `params.eq_polycoef`.
    Tendon {
        /// The tendon that follows.
        tendon1: usize,
        /// The tendon that leads.
        tendon2: Option<usize>,
    },
}

impl EqualityTarget {
    /// The kind in a word, as MJCF has it.
    pub fn kind(self) -> &'static str {
        match self {
            EqualityTarget::Connect { .. } => "connect",
            EqualityTarget::Weld { .. } => "weld",
            EqualityTarget::Joint { .. } => "joint",
            EqualityTarget::Tendon { .. } => "tendon",
        }
    }
}

/// An equality constraint.
#[derive(Clone, Debug)]
pub struct Equality {
    /// Name, possibly empty.
    pub name: String,
    /// What it holds.
    pub target: EqualityTarget,
    /// The sites that are held together, where it names sites and not bodies.
    pub sites: Option<[usize; 2]>,
    /// On in the initial state.
    pub active0: bool,
}
