//! Equality constraints.

/// What an equality constraint holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
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

/// What an equality couples, whatever it asks of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupled {
    /// Two bodies.
    Bodies([usize; 2]),
    /// A joint that follows, and one that leads.
    Joints(usize, Option<usize>),
    /// A tendon that follows, and one that leads.
    Tendons(usize, Option<usize>),
}

impl EqualityTarget {
    /// One line a kind: its word in MJCF, its number in MuJoCo, its rows, and what it couples.
    #[inline(always)]
    fn facts(self) -> (&'static str, i32, usize, Coupled) {
        use Coupled::*;
        match self {
            EqualityTarget::Connect { body1, body2 } => ("connect", 0, 3, Bodies([body1, body2])),
            EqualityTarget::Weld { body1, body2 } => ("weld", 1, 6, Bodies([body1, body2])),
            EqualityTarget::Joint { joint1, joint2 } => ("joint", 2, 1, Joints(joint1, joint2)),
            EqualityTarget::Tendon { tendon1, tendon2 } => {
                ("tendon", 3, 1, Tendons(tendon1, tendon2))
            }
        }
    }

    /// The kind in a word, as MJCF has it.
    pub fn kind(self) -> &'static str {
        self.facts().0
    }
    /// The kind as a number, MuJoCo's `mjtEq`.
    pub fn code(self) -> i32 {
        self.facts().1
    }
    /// How many rows it has.
    pub fn rows(self) -> usize {
        self.facts().2
    }
    /// What it couples.
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
    /// What it holds.
    pub target: EqualityTarget,
    /// The sites that are held together, where it names sites and not bodies.
    pub sites: Option<[usize; 2]>,
    /// On in the initial state.
    pub active0: bool,
}
