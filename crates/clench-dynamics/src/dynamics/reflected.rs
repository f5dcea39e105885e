//! Damping and armature that actuators add to their targets, times the square of the gear, since a gear scales both
//! forces and velocities (MuJoCo's `damping` and `armature` of actuators).
//!
//! Both also act for disabled actuators, and no range limits them.

use crate::dynamics::polynomial::Polynomial;
use crate::model::{Model, Params};
use clench_math::Real;

/// Returns the damper of dof `i`: its own and that of its joint's actuators.
#[inline(always)]
pub(crate) fn dof_damper<T: Real>(model: &Model, params: &Params<T>, i: usize) -> Polynomial<T> {
    let own = Polynomial::new(params.dof_damping[i], params.dof_dampingpoly[i]);
    let actuators = &model.joints[model.dofs[i].joint].reflecting;
    add_dampers(params, actuators, own)
}

/// Returns the damper of tendon `t`: its own and that of its actuators.
#[inline(always)]
pub fn tendon_damper<T: Real>(model: &Model, params: &Params<T>, t: usize) -> Polynomial<T> {
    let own = Polynomial::new(params.tendon_damping[t], params.tendon_dampingpoly[t]);
    add_dampers(params, &model.tendons[t].reflecting, own)
}

#[inline(always)]
fn add_dampers<T: Real>(
    params: &Params<T>,
    actuators: &[usize],
    mut damper: Polynomial<T>,
) -> Polynomial<T> {
    for &u in actuators {
        let ratio = params.actuator_gear[u][0].squared();
        damper.linear += ratio * params.actuator_damping[u];
        for (to, &from) in (damper.higher.iter_mut()).zip(&params.actuator_dampingpoly[u]) {
            *to += ratio * from;
        }
    }
    damper
}

/// Returns the inertia added to dof `i`: its own armature and that of its joint's actuators.
#[inline(always)]
pub fn dof_armature<T: Real>(model: &Model, params: &Params<T>, i: usize) -> T {
    let actuators = &model.joints[model.dofs[i].joint].reflecting;
    add_armatures(params, actuators, params.dof_armature[i])
}

/// Returns the inertia of tendon `t`: its own armature and that of its actuators.
#[inline(always)]
pub fn tendon_armature<T: Real>(model: &Model, params: &Params<T>, t: usize) -> T {
    let actuators = &model.tendons[t].reflecting;
    add_armatures(params, actuators, params.tendon_armature[t])
}

#[inline(always)]
fn add_armatures<T: Real>(params: &Params<T>, actuators: &[usize], mut armature: T) -> T {
    for &u in actuators {
        armature += params.actuator_gear[u][0].squared() * params.actuator_armature[u];
    }
    armature
}
