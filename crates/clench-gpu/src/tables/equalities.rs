//! Equalities: the two frames or coordinates that each constrains, and its softness.

use super::{Capacity, NONE, Tables};
use crate::codes::{Code, codes, row};
use clench_rigid::constraint::dynamic::{CONNECT, WELD, softness};
use clench_rigid::model::{EqualityTarget, Model};
use clench_rigid::settings::StepSettings;

codes! {
    /// The kinds of equality.
    enum Kind {
        /// A connect or weld of static bodies, which has no rows.
        Static = "EQ_STATIC",
        Connect = "EQ_CONNECT",
        Weld = "EQ_WELD",
        /// An equality of joints or tendons.
        Coupling = "EQ_COUPLING",
    }
}
row! {
    /// The numbers of an equality of frames.
    numbers FramesNumbers, "FRAMES" {
        anchor1: 3,
        anchor2: 3,
        quat1: 4,
        quat2: 4,
        torquescale: 1,
        /// The bodies' inverse weights of translations and of rotations.
        invweight: 2,
        solref: 2,
        solimp: 5,
    }
}
row! {
    /// The numbers of an equality of coordinates.
    numbers CouplingNumbers, "COUPLING" {
        /// The initial values of the follower and of its leader.
        initial: 2,
        polycoef: 5,
        /// The sum of the inverse weights.
        invweight: 1,
        solref: 2,
        solimp: 5,
    }
}

impl Tables {
    /// Adds equalities; coordinates are joints, then tendons.
    pub(super) fn equalities(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        let on = s.flags.constraint && s.flags.equality;
        let count = if on { m.equalities.len() } else { 0 };
        let (mut kinds, mut pairs, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let mut numbers = Vec::new();
        for (i, equality) in m.equalities[..count].iter().enumerate() {
            // Frames of static bodies are unconstrained.
            let moves = |bodies: [usize; 2]| bodies.iter().any(|&b| m.bodies[b].last_dof.is_some());
            let unless_static = |kind: Kind, bodies: [usize; 2]| match moves(bodies) {
                true => (kind, bodies),
                false => (Kind::Static, bodies),
            };
            let tendon = |t: usize| m.joints.len() + t;
            let (kind, pair) = match equality.target {
                EqualityTarget::Connect { body1, body2 } => {
                    unless_static(Kind::Connect, [body1, body2])
                }
                EqualityTarget::Weld { body1, body2 } => unless_static(Kind::Weld, [body1, body2]),
                EqualityTarget::Joint { joint1, joint2 } => {
                    (Kind::Coupling, [joint1, joint2.unwrap_or(NONE as usize)])
                }
                EqualityTarget::Tendon { tendon1, tendon2 } => {
                    let leader = tendon2.map_or(NONE as usize, tendon);
                    (Kind::Coupling, [tendon(tendon1), leader])
                }
            };
            let dim = match kind {
                Kind::Static => 0,
                Kind::Connect | Kind::Weld | Kind::Coupling => equality.target.rows(),
            };
            kinds.push(kind.code());
            pairs.extend(pair);
            places.push(numbers.len());
            match kind {
                Kind::Coupling => numbers.extend(coupling(m, i, pair).numbers()),
                Kind::Static | Kind::Connect | Kind::Weld => {
                    numbers.extend(frames(m, i, pair).numbers());
                }
            }
            capacity.blocks += 1;
            capacity.rows += dim;
        }
        self.codes::<Kind>();
        self.row::<FramesNumbers>();
        self.row::<CouplingNumbers>();
        self.words("EQ_KIND", kinds);
        self.words("EQ_PAIR", pairs);
        let start = self.numbers.len();
        self.words("EQ_PRM", places.into_iter().map(|place| start + place));
        self.numbers("EQ_NUMBERS", numbers);
        self.slots(m, count, on, capacity);
    }

    /// Adds slots for constraints that are added at run time; as equalities, they follow the first `count`. They wake
    /// trees even if equalities do not `act`.
    fn slots(&mut self, m: &Model, count: usize, act: bool, capacity: &mut Capacity) {
        self.fixed_flag("ANY_SLOTS", capacity.slots > 0);
        self.count("NSLOT", capacity.slots);
        let slots = if act { capacity.slots } else { 0 };
        self.constant("SLOT_CONNECT", CONNECT as usize);
        self.constant("SLOT_WELD", WELD as usize);
        self.count("FIRST_SLOT", count);
        self.count("NEQ", count + slots);
        let row = (m.max_dynamic_constraints > 0).then(|| in_slot().numbers());
        self.numbers("SLOT_PRM", row.into_iter().flatten());
        let (body1, body2) = (0, 0);
        capacity.blocks += slots;
        capacity.rows += EqualityTarget::Weld { body1, body2 }.rows() * slots;
    }
}

/// Returns the numbers that all constraints in slots share.
fn in_slot() -> FramesNumbers {
    let (solref, solimp) = softness::<f64>();
    FramesNumbers {
        anchor1: [0.0; 3],
        anchor2: [0.0; 3],
        quat1: [0.0; 4],
        quat2: [0.0; 4],
        torquescale: [1.0],
        invweight: [0.0; 2],
        solref,
        solimp,
    }
}

fn frames(m: &Model, i: usize, bodies: [usize; 2]) -> FramesNumbers {
    let p = &m.params;
    let weight = |part: usize| bodies.iter().map(|&b| p.body_invweight0[b][part]).sum();
    FramesNumbers {
        anchor1: p.eq_anchor1[i].to_array(),
        anchor2: p.eq_anchor2[i].to_array(),
        quat1: p.eq_quat1[i].to_array(),
        quat2: p.eq_quat2[i].to_array(),
        torquescale: [p.eq_torquescale[i]],
        invweight: [weight(0), weight(1)],
        solref: p.eq_solref[i],
        solimp: p.eq_solimp[i],
    }
}

fn coupling(m: &Model, i: usize, coordinates: [usize; 2]) -> CouplingNumbers {
    let p = &m.params;
    let present = |c: usize| (c != NONE as usize).then_some(c);
    let initial = |c: usize| match m.joints.get(c) {
        Some(joint) => p.qpos0[joint.qpos],
        None => p.tendon_length0[c - m.joints.len()],
    };
    let weight = |c: usize| match m.joints.get(c) {
        Some(joint) => p.dof_invweight0[joint.dof],
        None => p.tendon_invweight0[c - m.joints.len()],
    };
    let weights = coordinates.into_iter().filter_map(present).map(weight);
    CouplingNumbers {
        initial: coordinates.map(|c| present(c).map_or(0.0, initial)),
        polycoef: p.eq_polycoef[i],
        invweight: [weights.sum()],
        solref: p.eq_solref[i],
        solimp: p.eq_solimp[i],
    }
}
