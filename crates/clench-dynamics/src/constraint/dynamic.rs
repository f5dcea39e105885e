//! Constraints that are added at run time: connects and welds between any two bodies, such as a grasp by a suction
//! gripper.
//!
//! The model sets the number of slots in a state. The contents of a slot are fields of the state, so lanes may tie
//! different bodies in the same slot. Each pair of bodies that any lane ties becomes a block, active in the lanes that
//! tie this pair; in a lane, at most one block of a slot is active. All blocks use MuJoCo's default softness of
//! equalities.

use super::anchor_frames::{AnchorFrames, FrameConstraint};
use super::assembly::Assembly;
use super::context::ConstraintContext;
use super::softness::{DEFAULT_SOLIMP, DEFAULT_SOLREF};
use super::{connect, weld};
use crate::record::ConstraintSource;
use crate::state::slots::each_tie;
pub use crate::state::slots::{CONNECT, WELD, tied};
use clench_math::{Mask, Real, kernel};

/// Returns the reference dynamics and impedance of these constraints.
pub fn softness<T: Real>() -> ([T; 2], [T; 5]) {
    (DEFAULT_SOLREF.map(T::new), DEFAULT_SOLIMP.map(T::new))
}

/// Appends the constraints of the slots, in order.
#[kernel]
pub(super) fn push_all<T: Real>(context: &ConstraintContext<T>, out: &mut Assembly<T>) {
    let (solref, solimp) = softness();
    for slot in 0..context.state.dynamic_kind.len() {
        each_tie(context.model, context.state, slot, |tie| {
            let mut active = tie.lanes;
            if context.settings.flags.sleep {
                active &= context.sleep.is_either_awake(tie.bodies);
            }
            if !active.any() {
                return;
            }
            let (bodies, weld) = (tie.bodies, tie.weld);
            let constraint = FrameConstraint {
                frames: AnchorFrames::of_slot(context.state, slot, bodies),
                source: ConstraintSource::Dynamic { slot, bodies, weld },
                active,
                solref,
                solimp,
            };
            match weld {
                true => weld::push(context, out, &constraint),
                false => connect::push(context, out, &constraint),
            }
        });
    }
}
