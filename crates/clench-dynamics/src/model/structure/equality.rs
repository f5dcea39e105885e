//! Equality constraints.

/// The relation that an equality constraint enforces.
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
        /// The follower joint.
        joint1: usize,
        /// The leader joint.
        joint2: Option<usize>,
    },
    /// A tendon follows another by `params.eq_polycoef`.
    Tendon {
        /// The follower tendon.
        tendon1: usize,
        /// The leader tendon.
        tendon2: Option<usize>,
    },
}

/// The elements that an equality couples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupled {
    /// A point of each of two bodies.
    Points([usize; 2]),
    /// A frame of each of two bodies.
    Frames([usize; 2]),
    /// A follower joint and its leader.
    Joints(usize, Option<usize>),
    /// A follower tendon and its leader.
    Tendons(usize, Option<usize>),
}

impl EqualityTarget {
    /// Returns the facts of a kind: its keyword in MJCF, its number in MuJoCo, its rows, and what it couples.
    #[inline(always)]
    fn facts(self) -> (&'static str, i32, usize, Coupled) {
        use Coupled::*;
        match self {
            EqualityTarget::Connect { body1, body2 } => ("connect", 0, 3, Points([body1, body2])),
            EqualityTarget::Weld { body1, body2 } => ("weld", 1, 6, Frames([body1, body2])),
            EqualityTarget::Joint { joint1, joint2 } => ("joint", 2, 1, Joints(joint1, joint2)),
            EqualityTarget::Tendon { tendon1, tendon2 } => {
                ("tendon", 3, 1, Tendons(tendon1, tendon2))
            }
        }
    }

    /// Returns the keyword of the kind in MJCF.
    pub fn kind(self) -> &'static str {
        self.facts().0
    }
    /// Returns the number of the kind, MuJoCo's `mjtEq`.
    pub fn code(self) -> i32 {
        self.facts().1
    }
    /// Returns the number of its rows.
    pub fn rows(self) -> usize {
        self.facts().2
    }
    /// Returns the elements that it couples.
    #[inline(always)]
    pub fn coupled(self) -> Coupled {
        self.facts().3
    }
}

/// An equality constraint.
#[derive(Clone, Debug)]
pub struct Equality {
    /// Name, possibly empty.
    pub name: String,
    /// The relation that it enforces.
    pub target: EqualityTarget,
    /// The sites that it couples, if it names sites and not bodies.
    pub sites: Option<[usize; 2]>,
    /// True for a weld of bodies to which the model gives no relative pose: it is that at qpos0.
    pub pose_at_qpos0: bool,
    /// True if initially active.
    pub active0: bool,
}
