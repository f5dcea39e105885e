//! The record of the convex problem: the constraint that each block comes from, and the position of each row.

use crate::model::Model;
use clench_math::Real;

/// The source of a constraint; the number is its index among the sources of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintSource {
    /// An equality of the model.
    Equality(usize),
    /// A constraint that was added at run time.
    Dynamic {
        /// The slot that holds it.
        slot: usize,
        /// The bodies that it ties.
        bodies: [usize; 2],
        /// True for a weld, false for a connect.
        weld: bool,
    },
    /// Dry friction of a dof.
    DofFriction(usize),
    /// Dry friction of a tendon.
    TendonFriction(usize),
    /// A limit of a joint.
    JointLimit(usize),
    /// A limit of a tendon.
    TendonLimit(usize),
    /// A contact of the workspace.
    Contact(usize),
}

impl ConstraintSource {
    /// Returns the kind of constraint as in MuJoCo, or "dynamic" if it was added at run time.
    pub fn kind(self) -> &'static str {
        match self {
            ConstraintSource::Equality(_) => "equality",
            ConstraintSource::Dynamic { .. } => "dynamic",
            ConstraintSource::DofFriction(_) => "friction_dof",
            ConstraintSource::TendonFriction(_) => "friction_tendon",
            ConstraintSource::JointLimit(_) => "limit_joint",
            ConstraintSource::TendonLimit(_) => "limit_tendon",
            ConstraintSource::Contact(_) => "contact",
        }
    }

    /// Returns the index of the source among those of its kind.
    pub fn index(self) -> usize {
        match self {
            ConstraintSource::Equality(i)
            | ConstraintSource::Dynamic { slot: i, .. }
            | ConstraintSource::DofFriction(i)
            | ConstraintSource::TendonFriction(i)
            | ConstraintSource::JointLimit(i)
            | ConstraintSource::TendonLimit(i)
            | ConstraintSource::Contact(i) => i,
        }
    }

    /// Returns the name of the source (of the joint for a dof); empty if unnamed, for contacts and if added at run
    /// time.
    pub fn name(self, model: &Model) -> &str {
        match self {
            ConstraintSource::Equality(i) => &model.equalities[i].name,
            ConstraintSource::DofFriction(i) => &model.joints[model.dofs[i].joint].name,
            ConstraintSource::TendonFriction(i) | ConstraintSource::TendonLimit(i) => {
                &model.tendons[i].name
            }
            ConstraintSource::JointLimit(i) => &model.joints[i].name,
            ConstraintSource::Dynamic { .. } | ConstraintSource::Contact(_) => "",
        }
    }
}

/// The data of a block that the problem does not store.
#[derive(Clone, Copy, Debug)]
pub struct BlockRecord<T: Real> {
    /// The source of the block.
    pub source: ConstraintSource,
    /// Lanes in which the block is active.
    pub active: T::Mask,
    /// The distance at which the block begins to act.
    pub margin: T,
    /// The impedance d, of the normal for contacts.
    pub impedance: T,
}

/// The records of all blocks and rows of the last constraint stage, in the order of the problem.
#[derive(Clone, Debug, Default)]
pub struct ConstraintRecord<T: Real> {
    /// One record per block.
    pub blocks: Vec<BlockRecord<T>>,
    /// The position of each row: violation, signed distance or angle.
    pub pos: Vec<T>,
    /// The rate of change of each position: J v plus the surfaces' own velocity.
    pub vel: Vec<T>,
    /// The dofs of the next block.
    pub(crate) dofs: Vec<u32>,
}

impl<T: Real> ConstraintRecord<T> {
    /// Clears all rows and retains their memory.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
        self.pos.clear();
        self.vel.clear();
    }
}
