//! From controls to what acts: clamped controls, activation dynamics, and setpoints on a circle.

use crate::dynamics::muscle;
use crate::model::{BiasKind, DynamicsKind, GainKind, JointKind, Model, Params, Transmission};
use crate::state::State;
use crate::workspace::Positions;
use clench_math::{Mask, Real, Vec3, kernel};

/// The shortest time constant (s) of a filter (MuJoCo's `mjMINVAL`).
const MIN_TIMECONST: f64 = 1e-15;

/// The control of actuator `u` within its range.
#[inline(always)]
pub fn control<T: Real>(model: &Model, params: &Params<T>, state: &State<T>, u: usize) -> T {
    let ctrl = state.ctrl[u];
    if model.actuators[u].ctrllimited && model.flags.clampctrl {
        let [low, high] = params.actuator_ctrlrange[u];
        ctrl.clamp(low, high)
    } else {
        ctrl
    }
}

#[inline(always)]
fn time_constant<T: Real>(params: &Params<T>, u: usize) -> T {
    params.actuator_dynprm[u][0].max(T::new(MIN_TIMECONST))
}

/// The rate of change of each activation (na). A filtered servo on a circle turns towards its control by the shorter way.
#[kernel]
pub fn activation_rates<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    act_dot: &mut [T],
) {
    for (u, actuator) in model.actuators.iter().enumerate() {
        let Some(a) = actuator.act() else { continue };
        let ctrl = control(model, params, state, u);
        act_dot[a] = match actuator.dynamics {
            // What a callback of MuJoCo's user would say.
            DynamicsKind::None | DynamicsKind::User => T::ZERO,
            DynamicsKind::Muscle => {
                muscle::activation_rate(ctrl, state.act[a], &params.actuator_dynprm[u])
            }
            DynamicsKind::Integrator => ctrl,
            DynamicsKind::Filter | DynamicsKind::FilterExact => {
                let act = state.act[a];
                (nearest_setpoint(model, params, u, ctrl, act) - act) / time_constant(params, u)
            }
        };
    }
}

/// The activation of actuator `u` a time step later, if its rate is `act_dot`, within its range. An exact filter
/// approaches its control by 1 − exp(−h/τ) of the distance.
#[inline(always)]
pub fn next_activation<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    act: T,
    act_dot: T,
) -> T {
    let h = params.timestep;
    let actuator = &model.actuators[u];
    let next = match actuator.dynamics {
        DynamicsKind::FilterExact => {
            let tau = time_constant(params, u);
            act + act_dot * tau * (T::ONE - (-h / tau).exp())
        }
        _ => act + act_dot * h,
    };
    if actuator.actlimited {
        let [low, high] = params.actuator_actrange[u];
        next.clamp(low, high)
    } else {
        next
    }
}

/// What the gain of actuator `u` multiplies: its control, or its activation (of the end of the step with `actearly`).
#[inline(always)]
pub fn input<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    pos: &Positions<T>,
    act_dot: &[T],
    u: usize,
) -> T {
    let actuator = &model.actuators[u];
    let input = match actuator.act() {
        None => control(model, params, state, u),
        Some(a) if actuator.actearly => next_activation(model, params, u, state.act[a], act_dot[a]),
        Some(a) => state.act[a],
    };
    nearest_setpoint(model, params, u, input, pos.actuator_length[u])
}

/// The setpoint of a position servo on a ball joint, moved by whole turns to the one nearest to `near`; other inputs pass
/// unchanged.
///
/// A servo has a fixed gain and an affine bias with `gain = −bias[1]`; a turn is 2π times the length of its gear.
#[inline(always)]
pub fn nearest_setpoint<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    input: T,
    near: T,
) -> T {
    let actuator = &model.actuators[u];
    let on_ball = match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            model.joints[j].kind == JointKind::Ball
        }
        Transmission::Tendon(_) => false,
    };
    let servo = on_ball && actuator.gain == GainKind::Fixed && actuator.bias == BiasKind::Affine;
    if !servo {
        return input;
    }
    let turn = Vec3::from_slice(&params.actuator_gear[u]).norm() * T::new(std::f64::consts::TAU);
    let wraps = params.actuator_gainprm[u][0].eq(-params.actuator_biasprm[u][1]) & turn.gt(T::ZERO);
    if !wraps.any() {
        return input;
    }
    let turns = (input - near) / T::select(wraps, turn, T::ONE) + T::new(0.5);
    T::select(wraps, input - turn * turns.floor(), input)
}
