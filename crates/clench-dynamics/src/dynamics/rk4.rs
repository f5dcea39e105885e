//! Fourth-order Runge–Kutta, on the rotation group for ball and free joints.
//!
//! Positions, velocities and activations advance by the classical tableau: stages at 0, h/2, h/2, h, each reached along
//! the rates of the previous one, weighted 1/6, 1/3, 1/3, 1/6. Orientations are not a vector space: their increments
//! are rotation vectors u from the start, R = R₀ exp(u), and the average is of u̇, not of the angular velocity ω
//! (Munthe-Kaas 1998, *Runge–Kutta methods on Lie groups*). In the child's axes
//!
//! ```text
//! u̇ = ω + ½ u×ω + c u×(u×ω),   c = (1 − (θ/2) cot(θ/2)) / θ²,   θ = |u|
//! ```

use super::integration::{Integration, Rates};
use crate::dynamics::integrate::{
    add_scaled, advance_activations, advance_time, integrate_positions,
};
use crate::dynamics::plastic::yield_springs;
use crate::model::{JointKind, Model, Params};
use crate::profile::Stage;
use crate::stages::Lengths;
use crate::state::State;
use crate::stiction::advance_friction;
use crate::workspace::Workspace;
use clench_math::{Real, Vec3, kernel};
use std::mem::swap;

/// The times of stages 1, 2 and 3, in time steps.
const STAGES: [f64; 3] = [0.5, 0.5, 1.0];
/// Weights of stages 0 to 3.
pub const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
/// The squared angle, rad², below which c is computed from its series: the closed form loses digits there, and four
/// terms of the series are exact to 1e-15.
const SMALL: f64 = 0.01;

/// Advances the state by a time step. `ws` holds the forward dynamics of `state`; `forward` computes those of other
/// states.
#[kernel]
pub fn rk4<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
    mut forward: impl FnMut(&State<T>, &mut Workspace<T>),
) {
    let h = params.timestep;
    begin(state, ws);
    for (stage, &fraction) in STAGES.iter().enumerate() {
        let step = h * T::new(fraction);
        let Integration {
            start, stage: rate, ..
        } = &ws.integration;
        restore(start, state);
        integrate_positions(model, &mut state.qpos, &rate.position, step);
        add_scaled(&mut state.qvel, &rate.velocity, step);
        add_scaled(&mut state.act, &rate.activation, step);
        ws.clock.lap(Stage::Integration as usize);
        // The previous stage is closer than the last step: saves 9 to 15% of a humanoid's time in lanes.
        state.qacc_warmstart.copy_from_slice(&ws.qacc);
        // A failure in one stage is a failure of the step.
        let (singular, overflow) = (ws.singular, ws.collision.overflow);
        let excess = ws.collision.excess;
        ws.integration.offset = step;
        forward(state, ws);
        ws.integration.offset = T::ZERO;
        ws.singular |= singular;
        ws.collision.overflow |= overflow;
        ws.collision.excess = ws.collision.excess.max(excess);
        let weight = T::new(WEIGHTS[stage + 1]);
        collect(model, state, step, weight, ws);
    }
    restore(&ws.integration.start, state);
    // As in MuJoCo, a motor's bristles deflect by the velocity at the start of the step; users read that of the last
    // stage.
    let first = &mut ws.integration.actuator_velocity;
    swap(first, &mut ws.velocity.actuator_velocity);
    let mean = &ws.integration.mean;
    let (at, act) = ((&ws.position, &ws.velocity), &mut state.act);
    advance_activations(model, params, at, &mean.activation, act);
    let first = &mut ws.integration.actuator_velocity;
    swap(first, &mut ws.velocity.actuator_velocity);
    add_scaled(&mut state.qvel, &mean.velocity, h);
    integrate_positions(model, &mut state.qpos, &mean.position, h);
    let [length, jacobian] = &ws.integration.tendons;
    let (start, motion) = (
        Lengths { length, jacobian },
        (&state.qpos[..], &mean.position[..]),
    );
    yield_springs(model, params, &ws.sleep, start, motion, &mut state.plastic);
    advance_friction(model, params, start, motion.1, &mut state.stick_friction);
    advance_time(model, params, &ws.sensors.measured, state);
}

/// Stores the state and the rates of stage 0.
#[kernel]
fn begin<T: Real>(state: &State<T>, ws: &mut Workspace<T>) {
    let Integration {
        start,
        actuator_velocity,
        tendons: [length, jacobian],
        stage,
        mean,
        ..
    } = &mut ws.integration;
    actuator_velocity.copy_from_slice(&ws.velocity.actuator_velocity);
    if !length.is_empty() {
        length.copy_from_slice(&ws.position.ten_length);
        jacobian.copy_from_slice(&ws.position.ten_jacobian);
    }
    start.position.copy_from_slice(&state.qpos);
    start.velocity.copy_from_slice(&state.qvel);
    start.activation.copy_from_slice(&state.act);
    stage.position.copy_from_slice(&state.qvel);
    stage.velocity.copy_from_slice(&ws.qacc);
    stage.activation.copy_from_slice(&ws.force.act_dot);
    for values in [&mut mean.position, &mut mean.velocity, &mut mean.activation] {
        values.fill(T::ZERO);
    }
    add_weighted(mean, stage, T::new(WEIGHTS[0]));
}

#[inline(always)]
fn restore<T: Real>(start: &Rates<T>, state: &mut State<T>) {
    state.qpos.copy_from_slice(&start.position);
    state.qvel.copy_from_slice(&start.velocity);
    state.act.copy_from_slice(&start.activation);
}

#[kernel]
fn add_weighted<T: Real>(mean: &mut Rates<T>, stage: &Rates<T>, weight: T) {
    add_scaled(&mut mean.position, &stage.position, weight);
    add_scaled(&mut mean.velocity, &stage.velocity, weight);
    add_scaled(&mut mean.activation, &stage.activation, weight);
}

/// Collects the rates of a stage that was reached by advancing `step` along the previous one.
#[kernel]
fn collect<T: Real>(model: &Model, state: &State<T>, step: T, weight: T, ws: &mut Workspace<T>) {
    let Integration { stage, mean, .. } = &mut ws.integration;
    for joint in &model.joints {
        let dofs = joint.dof..joint.dof + joint.kind.nv();
        let rotation = dofs.end - 3.min(dofs.len())..dofs.end;
        let increment = match joint.kind {
            JointKind::Ball | JointKind::Free => {
                Vec3::from_slice(&stage.position[rotation.clone()]) * step
            }
            JointKind::Slide | JointKind::Hinge => Vec3::ZERO,
        };
        stage.position[dofs.clone()].copy_from_slice(&state.qvel[dofs]);
        if matches!(joint.kind, JointKind::Ball | JointKind::Free) {
            let omega = Vec3::from_slice(&state.qvel[rotation.clone()]);
            increment_rate(increment, omega).write(&mut stage.position[rotation]);
        }
    }
    stage.velocity.copy_from_slice(&ws.qacc);
    stage.activation.copy_from_slice(&ws.force.act_dot);
    add_weighted(mean, stage, weight);
}

/// Computes u̇ of the rotation vector u for the angular velocity ω (see above).
#[inline(always)]
pub fn increment_rate<T: Real>(u: Vec3<T>, omega: Vec3<T>) -> Vec3<T> {
    let squared = u.norm_squared();
    let series = T::new(1.0 / 12.0)
        + squared
            * (T::new(1.0 / 720.0)
                + squared * (T::new(1.0 / 30_240.0) + squared * T::new(1.0 / 1_209_600.0)));
    let small = squared.lt(T::new(SMALL));
    let angle_squared = T::select(small, T::ONE, squared);
    let half = angle_squared.sqrt() * T::new(0.5);
    let (sine, cosine) = half.sin_cos();
    let closed = (T::ONE - half * cosine / sine) / angle_squared;
    let c = T::select(small, series, closed);
    let turned = u.cross(omega);
    omega + turned * T::new(0.5) + u.cross(turned) * c
}
