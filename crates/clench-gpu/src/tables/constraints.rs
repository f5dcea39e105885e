//! Dry friction and limits.

use super::{Capacity, Tables};
use clench_rigid::model::{JointKind, Model};
use clench_rigid::settings::StepSettings;

/// What a block of the convex problem is.
const BLOCK_KINDS: [&str; 5] = [
    "DRY_FRICTION",
    "LIMIT",
    "CONTACT_NORMAL",
    "CONTACT_PYRAMID",
    "CONTACT_ELLIPTIC",
];
/// What is known of a block.
const BLOCK_FIELDS: [&str; 4] = ["BLOCK_KIND", "BLOCK_DIM", "BLOCK_ROW", "BLOCK_SOURCE"];
/// How many numbers that is.
pub(crate) const BLOCK_SIZE: usize = BLOCK_FIELDS.len();

impl Tables {
    pub(super) fn friction(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        for names in [&BLOCK_KINDS[..], &BLOCK_FIELDS] {
            for (code, name) in names.iter().enumerate() {
                self.count(name, code);
            }
        }
        self.count("BLOCK_SIZE", BLOCK_SIZE);
        let p = &m.params;
        let on = s.flags.constraint && s.flags.frictionloss;
        let rubs = |&i: &usize| on && m.dofs[i].frictionloss && p.dof_frictionloss[i] > 0.0;
        let dofs = Vec::from_iter((0..m.nv).filter(rubs));
        self.count("NFRICTION", dofs.len());
        self.words("FRICTION_DOF", dofs.iter().copied());
        let numbers = |&i: &usize| {
            let strength = [p.dof_frictionloss[i], p.dof_invweight0[i]];
            let soft = p.dof_solref[i].into_iter().chain(p.dof_solimp[i]);
            strength.into_iter().chain(soft)
        };
        self.numbers("FRICTION_PRM", dofs.iter().flat_map(numbers));
        capacity.blocks += dofs.len();
        capacity.rows += dofs.len();
    }

    pub(super) fn limits(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        let p = &m.params;
        let on = s.flags.constraint && s.enable_joint_limit;
        let limited = |&j: &usize| on && m.joints[j].limited && m.joints[j].kind != JointKind::Free;
        let joints = Vec::from_iter((0..m.joints.len()).filter(limited));
        self.count("NLIMIT", joints.len());
        self.words("LIMIT_JNT", joints.iter().copied());
        let numbers = |&j: &usize| {
            let [low, high] = p.jnt_range[j];
            let place = [
                low,
                high,
                p.jnt_margin[j],
                p.dof_invweight0[m.joints[j].dof],
            ];
            let soft = p.jnt_solref[j].into_iter().chain(p.jnt_solimp[j]);
            place.into_iter().chain(soft)
        };
        self.numbers("LIMIT_PRM", joints.iter().flat_map(numbers));
        // A joint can be at both ends of its range, where that is narrower than the margins.
        capacity.blocks += 2 * joints.len();
        capacity.rows += 2 * joints.len();
    }
}
