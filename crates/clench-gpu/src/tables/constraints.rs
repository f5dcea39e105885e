//! Dry friction and limits of dofs, joints and tendons.

use super::{Capacity, Tables};
use clench_rigid::model::{JointKind, Model};
use clench_rigid::settings::StepSettings;

/// The kinds of block of the convex problem.
const BLOCK_KINDS: [&str; 7] = [
    "HELD",
    "COUPLING",
    "DRY_FRICTION",
    "LIMIT",
    "CONTACT_NORMAL",
    "CONTACT_PYRAMID",
    "CONTACT_ELLIPTIC",
];
/// The fields of a block.
const BLOCK_FIELDS: [&str; 4] = ["BLOCK_KIND", "BLOCK_DIM", "BLOCK_ROW", "BLOCK_SOURCE"];
/// The numbers of a block.
pub(crate) const BLOCK_SIZE: usize = BLOCK_FIELDS.len();

impl Tables {
    pub(super) fn friction(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        for names in [&BLOCK_KINDS[..], &BLOCK_FIELDS] {
            for (code, name) in names.iter().enumerate() {
                self.constant(name, code);
            }
        }
        self.constant("BLOCK_SIZE", BLOCK_SIZE);
        let p = &m.params;
        let on = s.flags.constraint && s.flags.frictionloss;
        let (mut sources, mut numbers) = (Vec::new(), Vec::new());
        let mut add = |source: usize, strength: [f64; 2], solref: [f64; 2], solimp: [f64; 5]| {
            if on && strength[0] > 0.0 {
                sources.push(source);
                numbers.extend(strength.into_iter().chain(solref).chain(solimp));
            }
        };
        for (i, _) in m.dofs.iter().enumerate().filter(|(_, d)| d.frictionloss) {
            let strength = [p.dof_frictionloss[i], p.dof_invweight0[i]];
            add(i, strength, p.dof_solref[i], p.dof_solimp[i]);
        }
        for (t, _) in (m.tendons.iter().enumerate()).filter(|(_, t)| t.frictionloss) {
            let strength = [p.tendon_frictionloss[t], p.tendon_invweight0[t]];
            add(
                m.nv + t,
                strength,
                p.tendon_solref_fri[t],
                p.tendon_solimp_fri[t],
            );
        }
        self.count("NFRICTION", sources.len());
        capacity.blocks += sources.len();
        capacity.rows += sources.len();
        // Dofs, then tendons.
        self.words("FRICTION_SOURCE", sources);
        self.numbers("FRICTION_PRM", numbers);
    }

    pub(super) fn limits(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        let p = &m.params;
        let on = s.flags.constraint && s.enable_joint_limit;
        let (mut coordinates, mut numbers) = (Vec::new(), Vec::new());
        let mut add = |coordinate: usize, place: [f64; 4], solref: [f64; 2], solimp: [f64; 5]| {
            coordinates.push(coordinate);
            numbers.extend(place.into_iter().chain(solref).chain(solimp));
        };
        for (j, joint) in m.joints.iter().enumerate() {
            if on && joint.limited && joint.kind != JointKind::Free {
                let [low, high] = p.jnt_range[j];
                let place = [low, high, p.jnt_margin[j], p.dof_invweight0[joint.dof]];
                add(j, place, p.jnt_solref[j], p.jnt_solimp[j]);
            }
        }
        let on = s.flags.constraint && s.flags.limit;
        for (t, _) in (m.tendons.iter().enumerate()).filter(|(_, t)| on && t.limited) {
            let [low, high] = p.tendon_range[t];
            let place = [low, high, p.tendon_margin[t], p.tendon_invweight0[t]];
            add(
                m.joints.len() + t,
                place,
                p.tendon_solref_lim[t],
                p.tendon_solimp_lim[t],
            );
        }
        self.count("NLIMIT", coordinates.len());
        // Both limits of a coordinate can be active if its range is narrower than the margins.
        capacity.blocks += 2 * coordinates.len();
        capacity.rows += 2 * coordinates.len();
        // Joints, then tendons.
        self.words("LIMIT_COORDINATE", coordinates);
        self.numbers("LIMIT_PRM", numbers);
    }
}
