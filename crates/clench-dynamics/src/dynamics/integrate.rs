//! Advances the state by a time step, given its rates of change.

use super::actuator::ActuatorContext;
use super::integration::Integration;
use super::setpoint::nearest_setpoint;
use crate::dynamics::activation::next_activation;
use crate::dynamics::orientation;
use crate::dynamics::plastic::yield_springs;
use crate::model::{GainKind, JointKind, Model, Params};
use crate::part::Part;
use crate::sleep::stop_sleeping;
use crate::stages::{Lengths, Positions, Velocities};
use crate::state::State;
use crate::stiction::advance_friction;
use crate::workspace::Workspace;
use clench_math::{Quat, Real, Vec3, kernel};
use clench_solver::solve_differentiated;

/// Computes `out += x · scale`, entry by entry.
#[inline(always)]
pub fn add_scaled<T: Real>(out: &mut [T], x: &[T], scale: T) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out += x * scale;
    }
}

/// Moves `qpos` along `velocity` (nv) for `time` seconds. Orientations rotate about the child's axes.
pub fn integrate_positions<T: Real>(model: &Model, qpos: &mut [T], velocity: &[T], time: T) {
    integrate_parts(model, &[Part::whole(model)], qpos, velocity, time);
}

/// Does so for some parts.
#[kernel]
fn integrate_parts<T: Real>(
    model: &Model,
    parts: &[Part],
    qpos: &mut [T],
    velocity: &[T],
    time: T,
) {
    for joint in parts
        .iter()
        .flat_map(|part| &model.joints[part.joints.clone()])
    {
        let (mut q, mut v) = (&mut qpos[joint.qpos..], &velocity[joint.dof..]);
        match joint.kind {
            JointKind::Slide | JointKind::Hinge => q[0] += v[0] * time,
            JointKind::Ball | JointKind::Free => {
                if joint.kind == JointKind::Free {
                    add_scaled(&mut q[..3], v, time);
                    (q, v) = (&mut q[3..], &v[3..]);
                }
                let rotated = Quat::from_slice(q).integrate(Vec3::from_slice(v), time);
                rotated.write(q);
            }
        }
    }
}

/// Writes the constant velocity (nv) that moves `from` to `to` (nq each) in `time` seconds: the inverse of
/// [`integrate_positions`]. Quaternions need not be of unit length.
#[kernel]
pub fn differentiate_positions<T: Real>(
    model: &Model,
    from: &[T],
    to: &[T],
    time: T,
    velocity: &mut [T],
) {
    let rate = T::ONE / time;
    for joint in &model.joints {
        let (mut v, mut q) = (joint.dof, joint.qpos);
        if let JointKind::Ball | JointKind::Free = joint.kind {
            if joint.kind == JointKind::Free {
                for k in 0..3 {
                    velocity[v + k] = (to[q + k] - from[q + k]) * rate;
                }
                (v, q) = (v + 3, q + 3);
            }
            let [from, to] = [from, to].map(|all| Quat::from_slice(&all[q..]).normalize());
            (to.difference(from) * rate).write(&mut velocity[v..v + 3]);
        } else {
            velocity[v] = (to[q] - from[q]) * rate;
        }
    }
}

/// Advances activations by `act_dot`; those of disabled actuators change only by whole turns on a circle.
#[kernel]
pub(crate) fn advance_activations<T: Real>(
    model: &Model,
    params: &Params<T>,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    act_dot: &[T],
    act: &mut [T],
) {
    if !model.flags.actuation {
        return;
    }
    for (u, actuator) in model.actuators.iter().enumerate() {
        for a in actuator.acts.clone() {
            let rate = if actuator.disabled {
                T::ZERO
            } else {
                act_dot[a]
            };
            let at = ActuatorContext::new(model, params, (pos, vel), u);
            act[a] = next_activation(at, a, (act[a], rate));
            if actuator.gain == GainKind::Fixed {
                act[a] = nearest_setpoint(at, act[a], at.length);
            }
        }
        if actuator.gain.is_rotation() && !actuator.acts.is_empty() {
            orientation::shorten(&mut act[actuator.acts.clone()]);
        }
    }
}

/// Records the step's controls and sensor measurements for delayed reading, and advances the time.
#[inline(always)]
pub(crate) fn advance_time<T: Real>(
    model: &Model,
    params: &Params<T>,
    measured: &[T],
    state: &mut State<T>,
) {
    for actuator in &model.actuators {
        if let Some(history) = &actuator.history {
            let ctrl = &state.ctrl[actuator.controls.clone()];
            history.push(&mut state.history, ctrl, params.timestep);
        }
    }
    let now = state.rounded_time();
    for (sensor, &period) in model.sensors.iter().zip(&params.sensor_interval) {
        if let Some(history) = &sensor.history {
            let sample = &measured[sensor.numbers.clone()];
            history.push_periodic(&mut state.history, sample, (period, now), params.timestep);
        }
    }
    state.pass(params.timestep);
}

/// Solves for `integration.qacc` from the sum of all forces, with `integration.factor`; in dual numbers with
/// `integration.matrix`. It solves in the parts that the pass computes.
#[inline(always)]
pub(crate) fn solve_implicit<T: Real>(model: &Model, ws: &mut Workspace<T>) {
    sum_forces(ws);
    let tree = ws.sleep.rows(model);
    let Integration {
        matrix,
        factor,
        qacc,
        ..
    } = &mut ws.integration;
    if T::IS_DUAL {
        solve_differentiated(tree, matrix, qacc);
    } else {
        factor.solve(tree, qacc);
    }
}

/// Factors `integration.matrix` for [`solve_implicit`], which does so itself in dual numbers. Returns false in lanes in
/// which the matrix is not positive definite.
#[inline(always)]
pub(crate) fn factor_implicit<T: Real>(model: &Model, ws: &mut Workspace<T>) -> T::Mask {
    let tree = ws.sleep.rows(model);
    let Integration { matrix, factor, .. } = &mut ws.integration;
    if T::IS_DUAL {
        return factor.factor_values(tree, matrix);
    }
    ws.solver.factor(factor, tree, matrix)
}

/// Stores the sum of all forces in `integration.qacc`.
#[inline(always)]
pub(crate) fn sum_forces<T: Real>(ws: &mut Workspace<T>) {
    let forces = ws.force.qfrc_smooth.iter().zip(&ws.qfrc_constraint);
    for (qacc, (&smooth, &constraint)) in ws.integration.qacc.iter_mut().zip(forces) {
        *qacc = smooth + constraint;
    }
}

/// Advances activations, then velocities by `integration.qacc`, then positions with the new velocities (semi-implicit
/// Euler), then rest positions of springs, then time. Positions of parts that the pass does not compute stay the same.
#[kernel]
pub(crate) fn advance_semi_implicit<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &Workspace<T>,
) {
    let h = params.timestep;
    let (at, act_dot) = ((&ws.position, &ws.velocity), &ws.force.act_dot);
    advance_activations(model, params, at, act_dot, &mut state.act);
    add_scaled(&mut state.qvel, &ws.integration.qacc, h);
    stop_sleeping(model, &ws.sleep, &mut state.qvel);
    let parts = ws.sleep.computed();
    integrate_parts(model, parts, &mut state.qpos, &state.qvel, h);
    let motion = (&state.qpos[..], &state.qvel[..]);
    yield_springs(
        model,
        params,
        &ws.sleep,
        Lengths::of(&ws.position),
        motion,
        &mut state.plastic,
    );
    advance_friction(
        model,
        params,
        Lengths::of(&ws.position),
        &state.qvel,
        &mut state.stick_friction,
    );
    advance_time(model, params, &ws.sensors.measured, state);
}
