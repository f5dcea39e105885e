//! The displacements of dry friction of dofs and tendons, in [`State::stick_friction`](crate::State::stick_friction).
//!
//! A row of loss η carries at most the displacement η R / (k d). After a solve its displacement is limited to that, and
//! then follows the motion of the dof or tendon in the step, by the gradient at its start.

use super::pairs::Stiction;
use crate::constraint::ConstraintSource;
use crate::model::{Model, Params};
use crate::sleep::Sleep;
use crate::stages::Lengths;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, kernel};

impl<T: Real> Stiction<T> {
    /// Limits the displacements to those that friction carries. Without friction they become zero, and asleep they
    /// remain.
    pub(super) fn drag_friction(&self, model: &Model, ws: &Workspace<T>, displacements: &mut [T]) {
        let nv = model.nv;
        if model.may_sleep() {
            for (i, displacement) in displacements.iter_mut().enumerate() {
                let awake = match i.checked_sub(nv) {
                    Some(tendon) => is_tendon_awake(model, &ws.sleep, tendon),
                    None => ws.sleep.is_awake(model.tree.tree_of(i)),
                };
                *displacement = T::select(awake, T::ZERO, *displacement);
            }
        } else {
            displacements.fill(T::ZERO);
        }
        for (b, record) in ws.record.blocks.iter().enumerate() {
            let displacement = match record.source {
                ConstraintSource::DofFriction(i) => &mut displacements[i],
                ConstraintSource::TendonFriction(i) => &mut displacements[nv + i],
                ConstraintSource::Equality(_) | ConstraintSource::Dynamic { .. } => continue,
                // Limits and contacts follow dry friction.
                ConstraintSource::JointLimit(_)
                | ConstraintSource::TendonLimit(_)
                | ConstraintSource::Contact(_) => break,
            };
            let block = ws.problem.block(b);
            let row = block.rows().start;
            let slope = self.slopes[row];
            let stiff = record.active & slope.gt(T::ZERO);
            let limit = block.shape[0] * block.r[0] / T::select(stiff, slope, T::ONE);
            let within = ws.record.pos[row].max(-limit).min(limit);
            *displacement = T::select(stiff, within, *displacement);
        }
    }
}

/// Returns the lanes in which any dof of a tendon is awake.
fn is_tendon_awake<T: Real>(model: &Model, sleep: &Sleep<T>, tendon: usize) -> T::Mask {
    let mut awake = T::Mask::splat(false);
    for &dof in model.tendon_dofs.dofs(tendon) {
        awake |= sleep.is_awake(model.tree.tree_of(dof as usize));
    }
    awake
}

/// Adds the motion of a step, which moved positions along `velocity` (nv) with the tendons initially at `start`.
#[kernel]
pub(crate) fn advance_friction<T: Real>(
    model: &Model,
    params: &Params<T>,
    start: Lengths<T>,
    velocity: &[T],
    displacements: &mut [T],
) {
    if displacements.is_empty() {
        return;
    }
    let h = params.timestep;
    let (dofs, tendons) = displacements.split_at_mut(model.nv);
    for (i, displacement) in dofs.iter_mut().enumerate() {
        if model.dofs[i].frictionloss {
            *displacement += h * velocity[i];
        }
    }
    for (t, displacement) in tendons.iter_mut().enumerate() {
        if model.tendons[t].frictionloss {
            for (dof, arm) in model.tendon_dofs.row(start.jacobian, t) {
                *displacement += h * arm * velocity[dof];
            }
        }
    }
}
