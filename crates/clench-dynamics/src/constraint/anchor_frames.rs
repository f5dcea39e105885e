//! The anchor frames of connects and welds, both of the model and added at run time.

use super::context::ConstraintContext;
use super::softness::Softness;
use crate::model::Params;
use crate::record::{BlockRecord, ConstraintSource};
use crate::stages::Positions;
use crate::state::State;
use clench_math::{Quat, Real, Vec3};

/// Two frames, one on each of two bodies.
pub struct AnchorFrames<T> {
    /// The bodies.
    pub bodies: [usize; 2],
    /// The origin of each frame in its body's frame.
    pub anchors: [Vec3<T>; 2],
    /// The orientation of each frame in its body's frame; unused by connects.
    pub quats: [Quat<T>; 2],
    /// The length that scales rotations of a weld.
    pub torquescale: T,
}

impl<T: Real> AnchorFrames<T> {
    /// Returns the frames of an equality of the model.
    #[inline(always)]
    pub fn of_equality(params: &Params<T>, equality: usize, bodies: [usize; 2]) -> Self {
        AnchorFrames {
            bodies,
            anchors: [params.eq_anchor1[equality], params.eq_anchor2[equality]],
            quats: [params.eq_quat1[equality], params.eq_quat2[equality]],
            torquescale: params.eq_torquescale[equality],
        }
    }

    /// Returns the frames of a constraint that was added at run time.
    #[inline(always)]
    pub fn of_slot(state: &State<T>, slot: usize, bodies: [usize; 2]) -> Self {
        AnchorFrames {
            bodies,
            anchors: [state.dynamic_anchor1[slot], state.dynamic_anchor2[slot]],
            quats: [state.dynamic_quat[slot], Quat::IDENTITY],
            torquescale: T::ONE,
        }
    }

    /// Returns the origins in world coordinates.
    #[inline(always)]
    pub fn points(&self, pos: &Positions<T>) -> [Vec3<T>; 2] {
        let [body1, body2] = self.bodies;
        [
            pos.xpos[body1] + pos.xmat[body1] * self.anchors[0],
            pos.xpos[body2] + pos.xmat[body2] * self.anchors[1],
        ]
    }
}

/// Two constrained frames, with their softness and active lanes.
pub(super) struct FrameConstraint<T: Real> {
    pub frames: AnchorFrames<T>,
    pub source: ConstraintSource,
    pub active: T::Mask,
    pub solref: [T; 2],
    pub solimp: [T; 5],
}

impl<T: Real> FrameConstraint<T> {
    /// Creates the constraint of an equality.
    #[inline(always)]
    pub(super) fn by_equality(
        context: &ConstraintContext<T>,
        equality: usize,
        bodies: [usize; 2],
    ) -> Self {
        FrameConstraint {
            frames: AnchorFrames::of_equality(context.params, equality, bodies),
            source: ConstraintSource::Equality(equality),
            active: context.active_equality(equality),
            solref: context.params.eq_solref[equality],
            solimp: context.params.eq_solimp[equality],
        }
    }

    /// Returns the softness at a violation, and the record of the block.
    #[inline(always)]
    pub(super) fn soften(
        &self,
        context: &ConstraintContext<T>,
        violation: T,
    ) -> (Softness<T>, BlockRecord<T>) {
        context.soften(
            self.source,
            self.active,
            (self.solref, self.solimp),
            violation,
        )
    }
}
