//! Dry friction and limits of dofs, joints and tendons.

use super::{Capacity, Tables};
use crate::codes::{Code, codes, row};
use clench_rigid::model::{JointKind, Model};
use clench_rigid::settings::StepSettings;
use clench_solver::Cost;

codes! {
    /// The kinds of block of the convex problem; those of contacts come last.
    enum BlockKind {
        Frames = "FRAMES",
        Coupling = "COUPLING",
        DryFriction = "DRY_FRICTION",
        Limit = "LIMIT",
        MetricTerm = "METRIC_TERM",
        ContactNormal = "CONTACT_NORMAL",
        ContactPyramid = "CONTACT_PYRAMID",
        ContactElliptic = "CONTACT_ELLIPTIC",
    }
}
codes! {
    of Cost {
        Quadratic = "COST_QUADRATIC",
        OneSided = "COST_ONE_SIDED",
        Huber = "COST_HUBER",
        Pyramid = "COST_PYRAMID",
        Elliptic = "COST_ELLIPTIC",
        Coulomb = "COST_COULOMB",
    }
}
codes! {
    /// The fields of a block.
    enum BlockField {
        Kind = "BLOCK_KIND",
        Cost = "BLOCK_COST",
        Dim = "BLOCK_DIM",
        Row = "BLOCK_ROW",
        Source = "BLOCK_SOURCE",
    }
}
/// The number of words of a block.
pub(crate) const BLOCK_SIZE: usize = BlockField::ALL.len();

row! {
    /// Dry friction of a dof or tendon.
    numbers FrictionNumbers, "FRICTION" {
        loss: 1,
        invweight: 1,
        solref: 2,
        solimp: 5,
    }
}
row! {
    /// The limits of a joint or tendon.
    numbers LimitNumbers, "LIMIT" {
        low: 1,
        high: 1,
        margin: 1,
        invweight: 1,
        solref: 2,
        solimp: 5,
    }
}

impl Tables {
    /// Adds dry friction. Returns its sources: dofs, then tendons.
    pub(super) fn friction(
        &mut self,
        m: &Model,
        s: &StepSettings,
        capacity: &mut Capacity,
    ) -> Vec<usize> {
        self.codes::<BlockKind>();
        self.codes::<Cost>();
        self.codes::<BlockField>();
        self.constant("BLOCK_SIZE", BLOCK_SIZE);
        self.row::<FrictionNumbers>();
        let p = &m.params;
        let on = s.flags.constraint && s.flags.frictionloss;
        let (mut sources, mut numbers) = (Vec::new(), Vec::new());
        let mut add = |source: usize, row: FrictionNumbers| {
            if on && row.loss[0] > 0.0 {
                sources.push(source);
                numbers.extend(row.numbers());
            }
        };
        for (i, _) in m.dofs.iter().enumerate().filter(|(_, d)| d.frictionloss) {
            let row = FrictionNumbers {
                loss: [p.dof_frictionloss[i]],
                invweight: [p.dof_invweight0[i]],
                solref: p.dof_solref[i],
                solimp: p.dof_solimp[i],
            };
            add(i, row);
        }
        for (t, _) in (m.tendons.iter().enumerate()).filter(|(_, t)| t.frictionloss) {
            let row = FrictionNumbers {
                loss: [p.tendon_frictionloss[t]],
                invweight: [p.tendon_invweight0[t]],
                solref: p.tendon_solref_fri[t],
                solimp: p.tendon_solimp_fri[t],
            };
            add(m.nv + t, row);
        }
        self.count("NFRICTION", sources.len());
        capacity.blocks += sources.len();
        capacity.rows += sources.len();
        self.words("FRICTION_SOURCE", sources.iter().copied());
        self.numbers("FRICTION_PRM", numbers);
        sources
    }

    /// Adds limits. Returns their coordinates: joints, then tendons.
    pub(super) fn limits(
        &mut self,
        m: &Model,
        s: &StepSettings,
        capacity: &mut Capacity,
    ) -> Vec<usize> {
        let p = &m.params;
        let on = s.flags.constraint && s.enable_joint_limit;
        let (mut coordinates, mut numbers) = (Vec::new(), Vec::new());
        self.row::<LimitNumbers>();
        let mut add = |coordinate: usize, row: LimitNumbers| {
            coordinates.push(coordinate);
            numbers.extend(row.numbers());
        };
        for (j, joint) in m.joints.iter().enumerate() {
            if on && joint.limited && joint.kind != JointKind::Free {
                let [low, high] = p.jnt_range[j];
                let row = LimitNumbers {
                    low: [low],
                    high: [high],
                    margin: [p.jnt_margin[j]],
                    invweight: [p.dof_invweight0[joint.dof]],
                    solref: p.jnt_solref[j],
                    solimp: p.jnt_solimp[j],
                };
                add(j, row);
            }
        }
        let on = s.flags.constraint && s.flags.limit;
        for (t, _) in (m.tendons.iter().enumerate()).filter(|(_, t)| on && t.limited) {
            let [low, high] = p.tendon_range[t];
            let row = LimitNumbers {
                low: [low],
                high: [high],
                margin: [p.tendon_margin[t]],
                invweight: [p.tendon_invweight0[t]],
                solref: p.tendon_solref_lim[t],
                solimp: p.tendon_solimp_lim[t],
            };
            add(m.joints.len() + t, row);
        }
        self.count("NLIMIT", coordinates.len());
        // Both limits of a coordinate can be active if its range is narrower than the margins.
        capacity.blocks += 2 * coordinates.len();
        capacity.rows += 2 * coordinates.len();
        self.words("LIMIT_COORDINATE", coordinates.iter().copied());
        self.numbers("LIMIT_PRM", numbers);
        coordinates
    }
}
