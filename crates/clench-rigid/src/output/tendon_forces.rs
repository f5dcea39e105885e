//! Forces of spatial tendons on bodies.
//!
//! A tendon with force f, in the sense that J f are its forces along dofs, pulls at each end of each of its straight
//! spans with f times the gradient of its length with respect to that end. The force includes spring, damper,
//! actuators, inertia and constraints.

use super::source::Source;
use clench_dynamics::constraint::{ConstraintSource, equality_slope};
use clench_dynamics::dynamics::reflected::{tendon_armature, tendon_damper};
use clench_dynamics::dynamics::tendon::gradient;
use clench_dynamics::dynamics::tendon_path::{Span, each_span};
use clench_dynamics::model::{Coupled, Transmission};
use clench_math::{Mask, Real, kernel};

/// Calls `show` for every span of every spatial tendon, with the force of the tendon.
#[kernel]
pub(super) fn each_pull<T: Real>(s: &Source<T>, mut show: impl FnMut(Span<T>, T)) {
    for (t, tendon) in s.model.tendons.iter().enumerate() {
        if !tendon.is_spatial() {
            continue;
        }
        let force = smooth_force(s, t) + constraint_force(s, t);
        each_span(
            s.model,
            s.params,
            &s.ws.position,
            tendon,
            #[inline(always)]
            |span| {
                show(span, force);
            },
        );
    }
}

/// Returns the force of springs, dampers, actuators and inertia along tendon `t`.
#[kernel]
fn smooth_force<T: Real>(s: &Source<T>, t: usize) -> T {
    let (model, params, ws) = (s.model, s.params, &s.ws);
    let mut force = T::ZERO;
    if model.flags.spring {
        force += ws.force.ten_spring[t];
    }
    if model.flags.damper {
        let velocity = ws.velocity.ten_velocity[t];
        force -= velocity * tendon_damper(model, params, t).damping(velocity);
    }
    for (u, actuator) in model.actuators.iter().enumerate() {
        if actuator.transmission == Transmission::Tendon(t) {
            force += ws.force.actuator_force[actuator.outputs.start] * params.actuator_gear[u][0];
        }
    }
    let armature = tendon_armature(model, params, t);
    if !armature.eq(T::ZERO).all() {
        let mut acceleration = ws.force.ten_bias[t];
        for (dof, arm) in gradient(model, &ws.position, t) {
            acceleration += arm * ws.qacc[dof];
        }
        force -= armature * acceleration;
    }
    force
}

/// Returns the force of limits, dry friction and equalities along tendon `t`.
#[kernel]
fn constraint_force<T: Real>(s: &Source<T>, t: usize) -> T {
    let ws = &s.ws;
    let mut sum = T::ZERO;
    for (index, record) in ws.record.blocks.iter().enumerate() {
        let block = ws.problem.block(index);
        let scale = match record.source {
            ConstraintSource::TendonFriction(of) if of == t => T::ONE,
            // The row of a limit is plus or minus the tendon's gradient.
            ConstraintSource::TendonLimit(of) if of == t => {
                let mut along = T::ZERO;
                for (&entry, (_, arm)) in
                    block
                        .jacobian
                        .iter()
                        .zip(gradient(s.model, &ws.position, t))
                {
                    along += entry * arm;
                }
                T::select(along.ge(T::ZERO), T::ONE, -T::ONE)
            }
            ConstraintSource::Equality(e) => match s.model.equalities[e].target.coupled() {
                Coupled::Tendons(follower, _) if follower == t => T::ONE,
                Coupled::Tendons(_, Some(leader)) if leader == t => {
                    -equality_slope(s.params, &ws.position, e, leader)
                }
                Coupled::Tendons(..)
                | Coupled::Points(_)
                | Coupled::Frames(_)
                | Coupled::Joints(..) => continue,
            },
            // Constraints of another tendon, or of none.
            ConstraintSource::TendonFriction(_)
            | ConstraintSource::TendonLimit(_)
            | ConstraintSource::Dynamic { .. }
            | ConstraintSource::DofFriction(_)
            | ConstraintSource::JointLimit(_)
            | ConstraintSource::Contact(_) => continue,
        };
        let force = scale * ws.solver.force()[block.row];
        sum += T::select(record.active, force, T::ZERO);
    }
    sum
}
