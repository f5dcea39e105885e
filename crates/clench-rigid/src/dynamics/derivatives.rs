//! D = ∂τ/∂v: how smooth forces change with velocities, in the pattern of the mass matrix.
//!
//! Coriolis forces are left out, so that D is symmetric, and so is what couples dofs of different branches, so that M − h D
//! factors without fill (both as in MuJoCo's `implicitfast`). A force s along a generalized velocity J v contributes
//! its slope: s′ JᵀJ.

use super::actuator::{ActuatorInputs, ActuatorMotion, scaling_error};
use crate::dynamics::actuation::limited_tendon;
use crate::dynamics::ellipsoid::ellipsoid_rates;
use crate::dynamics::fluid::{Drag, fluid_acts, symmetric_and_skew};
use crate::dynamics::gain::{unlimited_force, unlimited_slope};
use crate::dynamics::reflected::{dof_damper, tendon_damper};
use crate::dynamics::transmission::moment;
use crate::dynamics::{dc_motor, orientation, tendon};
use crate::model::{BiasKind, GainKind, Model, Params, Transmission};
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Force, Mask, Motion, Real, kernel};
use clench_solver::TreeMatrix;

/// `matrix += scale · D`.
#[kernel]
pub fn add_velocity_derivatives<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel, force): (&Positions<T>, &Velocities<T>, &Forces<T>),
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if model.flags.actuation {
        for u in 0..model.actuators.len() {
            let slope = actuator_derivative(model, params, state, (pos, vel, force), u);
            for output in model.actuators[u].outputs.clone() {
                add_outer(model, moment(model, pos, output), slope * scale, matrix);
            }
        }
    }
    if fluid_acts(model, params) {
        for b in 1..model.nbody() {
            add_fluid(model, params, pos, vel, b, scale, matrix);
        }
    }
    if model.flags.damper {
        for (i, &v) in state.qvel.iter().enumerate() {
            if let Some(diagonal) = matrix.row_mut(&model.tree, i).last_mut() {
                *diagonal -= dof_damper(model, params, i).damping_slope(v) * scale;
            }
        }
        for (t, &velocity) in vel.ten_velocity.iter().enumerate() {
            let damping = tendon_damper(model, params, t).damping_slope(velocity);
            let row = tendon::gradient(model, pos, t);
            add_outer(model, row, -damping * scale, matrix);
        }
    }
}

/// Adds `scale · JᵀJ` of a sparse row J, where the pattern has room for it.
#[inline(always)]
pub fn add_outer<T: Real>(
    model: &Model,
    row: impl Iterator<Item = (usize, T)> + Clone,
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if scale.eq(T::ZERO).all() {
        return;
    }
    for (i, arm) in row.clone() {
        let entries = matrix.row_mut(&model.tree, i);
        for (j, other) in row.clone() {
            if let Ok(k) = model.tree.row(i).binary_search(&(j as u32)) {
                entries[k] += scale * arm * other;
            }
        }
    }
}

/// ∂force/∂velocity of actuator `u`; zero where a limit of the actuator, its tendon or its joint holds the force.
#[inline(always)]
fn actuator_derivative<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel, force): (&Positions<T>, &Velocities<T>, &Forces<T>),
    u: usize,
) -> T {
    let actuator = &model.actuators[u];
    if actuator.disabled {
        return T::ZERO;
    }
    if actuator.gain == GainKind::So3 {
        return orientation::slope(model, params, u, &force.actuator_force);
    }
    let (act_dot, at) = (&force.act_dot, ActuatorMotion::of(model, pos, vel, u));
    let given = ActuatorInputs {
        ctrl: &force.ctrl,
        act: &state.act,
    };
    let slope = unlimited_slope(model, params, given, act_dot, u, at);
    // The bias of a motor needs its gain.
    let is_motor = actuator.bias == BiasKind::DcMotor;
    let saturated = |value: T, [low, high]: [T; 2]| value.le(low) | value.ge(high);
    let mut held = T::Mask::splat(false);
    if actuator.forcelimited {
        // Cogging and friction of a motor come after its limit, which holds its current alone.
        let limited = match is_motor {
            true => unlimited_force(model, params, given, act_dot, u, at),
            false => force.actuator_force[actuator.outputs.start],
        };
        held |= saturated(limited, params.actuator_forcerange[u]);
    }
    if let Some(t) = limited_tendon(model, actuator.transmission) {
        held |= reached(force.ten_actuator_force[t], params.tendon_actfrcrange[t]);
    }
    // As in MuJoCo, friction counts here with a motor's gain, though it is part of its bias.
    let friction = || dc_motor::mechanical_slope(model, params, u);
    let slope = match actuator.gain {
        GainKind::DcMotor if is_motor => T::select(held, T::ZERO, slope) + friction(),
        GainKind::DcMotor => T::select(held, T::ZERO, slope + friction()),
        _ => T::select(held, T::ZERO, slope),
    };
    match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j)
            if model.joints[j].actfrclimited =>
        {
            let total = force.qfrc_actuator[model.joints[j].dof];
            let held = saturated(total, params.jnt_actfrcrange[j]);
            T::select(held, T::ZERO, slope)
        }
        _ => slope,
    }
}

/// Whether a sum of forces that were scaled into a range is at one of its ends. As in MuJoCo, where actuators reach the
/// range of their tendon and one of them is then cut by its own, what is left of the sum decides.
#[inline(always)]
fn reached<T: Real>(sum: T, [low, high]: [T; 2]) -> T::Mask {
    let rounding = scaling_error::<T>();
    sum.le(low + low.abs() * rounding) | sum.ge(high - high.abs() * rounding)
}

/// Adds the drag on body `b`: entry (i, j) is the power, along dof j, of the change of the drag with dof i. Of ellipsoids' forces
/// only what is symmetric is counted.
#[inline(always)]
fn add_fluid<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    b: usize,
    scale: T,
    matrix: &mut TreeMatrix<T>,
) {
    if model.bodies[b].fluid_ellipsoids {
        let [rates, _] = symmetric_and_skew(ellipsoid_rates(model, params, pos, vel, b));
        add_along_chain(
            model,
            pos,
            b,
            scale,
            matrix,
            #[inline(always)]
            |axis| {
                let mut sum = Force::ZERO;
                for (x, rate) in axis.to_array().into_iter().zip(rates) {
                    sum += rate * x;
                }
                sum
            },
        );
    } else {
        let drag = Drag::new(model, params, pos, vel, b);
        add_along_chain(
            model,
            pos,
            b,
            scale,
            matrix,
            #[inline(always)]
            |axis| drag.derivative(model, pos, axis),
        );
    }
}

/// Adds the change of a force on body `b` with its velocity, `change` of each dof that moves it.
#[inline(always)]
fn add_along_chain<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    b: usize,
    scale: T,
    matrix: &mut TreeMatrix<T>,
    change: impl Fn(Motion<T>) -> Force<T>,
) {
    let mut chain = model.bodies[b].last_dof;
    while let Some(i) = chain {
        let force = change(pos.cdof[i]);
        let entries = matrix.row_mut(&model.tree, i);
        for (entry, &j) in entries.iter_mut().zip(model.tree.row(i)) {
            *entry += scale * pos.cdof[j as usize].dot(force);
        }
        chain = model.dofs[i].parent;
    }
}
