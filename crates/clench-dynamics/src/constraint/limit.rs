//! Limits: keep a joint or tendon within its range.
//!
//! ```text
//! hinge, slide, tendon:   lower  r = x − low,  J = ∂x/∂q        upper  r = high − x,  J = −∂x/∂q
//! ball:                   r = largest angle − angle,  J = −axis of the rotation, in the body's frame
//! ```
//!
//! A limit is active if r is below its margin, and only pushes: its cost is one-sided. A ball joint rotated by a
//! rotation vector θ has the angle |θ|; d|θ|/dt is the angular velocity along θ, independent of its other components.
//! A₀ is the inverse weight of the joint's first dof, or of the tendon.

use super::Softness;
use super::assembly::Assembly;
use super::context::{ConstraintContext, SoftnessLimits};
use super::coordinate::Coordinate;
use super::row::Row;
use crate::model::JointKind;
use crate::record::{BlockRecord, ConstraintSource};
use clench_math::{Mask, Quat, Real, kernel};
use clench_solver::Cost;

/// Appends the limits of all joints.
#[kernel]
pub(super) fn push_joints<T: Real>(context: &ConstraintContext<T>, out: &mut Assembly<T>) {
    let params = context.params;
    for (i, joint) in context.model.joints.iter().enumerate() {
        if !joint.limited {
            continue;
        }
        let awake = context
            .sleep
            .is_awake(context.model.tree.tree_of(joint.dof));
        if !awake.any() {
            continue;
        }
        let margin = params.jnt_margin[i];
        if let JointKind::Hinge | JointKind::Slide = joint.kind {
            // Most joints are well within their range.
            let (q, [low, high]) = (context.state.qpos[joint.qpos], params.jnt_range[i]);
            if !((q - low).lt(margin) | (high - q).lt(margin)).any() {
                continue;
            }
        }
        let limit = Limit {
            source: ConstraintSource::JointLimit(i),
            awake,
            margin,
            solref: &params.jnt_solref[i],
            solimp: &params.jnt_solimp[i],
            a0: params.dof_invweight0[joint.dof],
        };
        match joint.kind {
            JointKind::Hinge | JointKind::Slide => {
                limit.push_range(context, out, Coordinate::Joint(i), params.jnt_range[i]);
            }
            JointKind::Ball => limit.push_cone(context, out, i),
            JointKind::Free => {}
        }
    }
}

/// Appends the limits of all tendons.
#[kernel]
pub(super) fn push_tendons<T: Real>(context: &ConstraintContext<T>, out: &mut Assembly<T>) {
    let params = context.params;
    for (i, tendon) in context.model.tendons.iter().enumerate() {
        if !tendon.limited {
            continue;
        }
        let limit = Limit {
            source: ConstraintSource::TendonLimit(i),
            awake: context.awake([Coordinate::Tendon(i)]),
            margin: params.tendon_margin[i],
            solref: &params.tendon_solref_lim[i],
            solimp: &params.tendon_solimp_lim[i],
            a0: params.tendon_invweight0[i],
        };
        let coordinate = Coordinate::Tendon(i);
        limit.push_range(context, out, coordinate, params.tendon_range[i]);
    }
}

/// Computes the softness and the row of a limit at a distance, from its solref, solimp and inverse weight.
#[inline(always)]
pub(super) fn soft_row<T: Real>(
    limits: &SoftnessLimits<'_, T>,
    (solref, solimp, a0): ([T; 2], [T; 5], T),
    dist: T,
    margin: T,
) -> (Softness<T>, Row<T>) {
    let soft = Softness::new(solref, solimp, dist - margin, limits.min_timeconst);
    let soft = limits.resolved(soft, solref);
    (soft, Row::new(&soft, dist, margin, a0))
}

struct Limit<'a, T: Real> {
    source: ConstraintSource,
    /// The lanes in which any object that it limits is awake.
    awake: T::Mask,
    margin: T,
    solref: &'a [T; 2],
    solimp: &'a [T; 5],
    a0: T,
}

impl<T: Real> Limit<'_, T> {
    /// Appends a coordinate's lower, then upper limit.
    #[inline(always)]
    fn push_range(
        &self,
        context: &ConstraintContext<T>,
        out: &mut Assembly<T>,
        coordinate: Coordinate,
        [low, high]: [T; 2],
    ) {
        let value = coordinate.value(context);
        for (dist, sign) in [(value - low, T::ONE), (high - value, -T::ONE)] {
            if !(self.awake & dist.lt(self.margin)).any() {
                continue;
            }
            let dofs = out.dofs();
            dofs.clear();
            coordinate.insert_dofs(context, dofs);
            self.push(
                context,
                out,
                dist,
                #[inline(always)]
                |dofs, jacobian| {
                    coordinate.add_gradient(context, dofs, sign, jacobian);
                },
            );
        }
    }

    /// Appends the limit of a ball joint's angle.
    #[inline(always)]
    fn push_cone(&self, context: &ConstraintContext<T>, out: &mut Assembly<T>, joint: usize) {
        let (qpos, dof) = {
            let joint = &context.model.joints[joint];
            (joint.qpos, joint.dof as u32)
        };
        let orientation = Quat::from_slice(&context.state.qpos[qpos..]).normalize();
        let (axis, angle) = orientation.to_rotation_vector().normalize();
        let [low, high] = context.params.jnt_range[joint];
        let dist = low.max(high) - angle;
        if !(self.awake & dist.lt(self.margin)).any() {
            return;
        }
        let dofs = out.dofs();
        dofs.clear();
        dofs.extend(dof..dof + 3);
        self.push(context, out, dist, |_, jacobian| (-axis).write(jacobian));
    }

    #[inline(always)]
    fn push(
        &self,
        context: &ConstraintContext<T>,
        out: &mut Assembly<T>,
        dist: T,
        fill: impl FnOnce(&[u32], &mut [T]),
    ) {
        let numbers = (*self.solref, *self.solimp, self.a0);
        let (soft, row) = soft_row(&context.limits(), numbers, dist, self.margin);
        let block = BlockRecord {
            source: self.source,
            active: self.awake & dist.lt(self.margin),
            margin: self.margin,
            impedance: soft.impedance,
        };
        out.push(Cost::OneSided, block, &[row], fill);
    }
}
