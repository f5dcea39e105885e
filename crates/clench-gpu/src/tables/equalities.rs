//! Equalities: the two frames or coordinates that each constrains, and its softness.

use super::{Capacity, NONE, Tables};
use clench_rigid::model::{Coupled, Model};
use clench_rigid::settings::StepSettings;

/// The numbers of an equality of frames: both anchors, both orientations, the length that scales rotations, the bodies'
/// inverse weights of translations and of rotations, then solref and solimp.
const HELD_SIZE: usize = 24;
/// The numbers of an equality of coordinates: both initial values, five coefficients, the sum of the inverse weights,
/// then solref and solimp.
const COUPLING_SIZE: usize = 15;

impl Tables {
    /// Adds equalities; coordinates are joints, then tendons.
    pub(super) fn equalities(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        let on = s.flags.constraint && s.flags.equality;
        let count = if on { m.equalities.len() } else { 0 };
        let (mut kinds, mut pairs, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let mut numbers = Vec::new();
        for (i, equality) in m.equalities[..count].iter().enumerate() {
            // Frames of static bodies are unconstrained.
            let moving =
                |bodies: [usize; 2]| bodies.iter().any(|&b| m.bodies[b].last_dof.is_some());
            let rows = equality.target.rows();
            let (rows, pair) = match equality.target.coupled() {
                Coupled::Bodies(bodies) => (if moving(bodies) { rows } else { 0 }, bodies),
                Coupled::Joints(follower, leader) => {
                    (rows, [follower, leader.unwrap_or(NONE as usize)])
                }
                Coupled::Tendons(follower, leader) => {
                    let tendon = |t: usize| m.joints.len() + t;
                    (
                        rows,
                        [tendon(follower), leader.map_or(NONE as usize, tendon)],
                    )
                }
            };
            kinds.push(rows);
            pairs.extend(pair);
            places.push(numbers.len());
            match rows {
                1 => numbers.extend(joint_equality(m, i, pair)),
                _ => numbers.extend(held(m, i, pair)),
            }
            capacity.blocks += 1;
            capacity.rows += rows;
        }
        self.count("NEQ", count);
        self.words("EQ_ROWS", kinds);
        self.words("EQ_PAIR", pairs);
        let start = self.numbers.len();
        self.words("EQ_PRM", places.into_iter().map(|place| start + place));
        self.numbers("EQ_NUMBERS", numbers);
    }
}

fn held(m: &Model, i: usize, bodies: [usize; 2]) -> [f64; HELD_SIZE] {
    let p = &m.params;
    let weight = |part: usize| bodies.iter().map(|&b| p.body_invweight0[b][part]).sum();
    let mut all = [0.0; HELD_SIZE];
    all[..3].copy_from_slice(&p.eq_anchor1[i].to_array());
    all[3..6].copy_from_slice(&p.eq_anchor2[i].to_array());
    all[6..10].copy_from_slice(&p.eq_quat1[i].to_array());
    all[10..14].copy_from_slice(&p.eq_quat2[i].to_array());
    all[14] = p.eq_torquescale[i];
    all[15] = weight(0);
    all[16] = weight(1);
    all[17..19].copy_from_slice(&p.eq_solref[i]);
    all[19..].copy_from_slice(&p.eq_solimp[i]);
    all
}

fn joint_equality(m: &Model, i: usize, coordinates: [usize; 2]) -> [f64; COUPLING_SIZE] {
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
    let mut all = [0.0; COUPLING_SIZE];
    for (to, c) in all.iter_mut().zip(coordinates) {
        *to = present(c).map_or(0.0, initial);
    }
    all[2..7].copy_from_slice(&p.eq_polycoef[i]);
    all[7] = coordinates
        .into_iter()
        .filter_map(present)
        .map(weight)
        .sum();
    all[8..10].copy_from_slice(&p.eq_solref[i]);
    all[10..].copy_from_slice(&p.eq_solimp[i]);
    all
}
