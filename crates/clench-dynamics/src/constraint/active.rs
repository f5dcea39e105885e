//! The active lanes and the softness of constraints.

use super::context::ConstraintContext;
use super::coordinate::Coordinate;
use super::softness::Softness;
use crate::model::Coupled;
use crate::record::{BlockRecord, ConstraintSource};
use clench_math::{Mask, Real};

impl<T: Real> ConstraintContext<'_, T> {
    /// Returns the lanes in which an equality is on and couples any awake object.
    #[inline(always)]
    pub(super) fn active_equality(&self, equality: usize) -> T::Mask {
        let active = self.state.eq_active[equality];
        if !self.settings.flags.sleep {
            return active;
        }
        let awake = match self.model.equalities[equality].target.coupled() {
            Coupled::Points(bodies) | Coupled::Frames(bodies) => self.sleep.is_either_awake(bodies),
            Coupled::Joints(follower, leader) => {
                let joints = [Some(follower), leader].into_iter().flatten();
                self.awake(joints.map(Coordinate::Joint))
            }
            Coupled::Tendons(follower, leader) => {
                let tendons = [Some(follower), leader].into_iter().flatten();
                self.awake(tendons.map(Coordinate::Tendon))
            }
        };
        active & awake
    }

    /// Returns the lanes in which any dof of these coordinates is awake.
    #[inline(always)]
    pub(super) fn awake(&self, coordinates: impl IntoIterator<Item = Coordinate>) -> T::Mask {
        let mut awake = T::Mask::splat(!self.settings.flags.sleep);
        for coordinate in coordinates {
            coordinate.each(self, |dof, _| {
                awake |= self.sleep.is_awake(self.model.tree.tree_of(dof as usize));
            });
        }
        awake
    }

    /// Returns the softness of an equality at a violation, and the record of its block.
    #[inline(always)]
    pub(super) fn equality(&self, equality: usize, violation: T) -> (Softness<T>, BlockRecord<T>) {
        let source = ConstraintSource::Equality(equality);
        let solver = (
            self.params.eq_solref[equality],
            self.params.eq_solimp[equality],
        );
        self.soften(source, self.active_equality(equality), solver, violation)
    }

    /// Returns the softness of a constraint without margin at a violation, and the record of its block.
    #[inline(always)]
    pub(super) fn soften(
        &self,
        source: ConstraintSource,
        active: T::Mask,
        (solref, solimp): ([T; 2], [T; 5]),
        violation: T,
    ) -> (Softness<T>, BlockRecord<T>) {
        let soft = Softness::new(solref, solimp, violation, self.min_timeconst);
        let record = BlockRecord {
            source,
            active,
            margin: T::ZERO,
            impedance: soft.impedance,
        };
        (soft, record)
    }
}
