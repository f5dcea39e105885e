//! From controls to what acts: clamped controls, activation dynamics, and setpoints on a circle.

use crate::dynamics::gain::ActuatorMotion;
use crate::dynamics::{dc_motor, muscle, pid};
use crate::model::{BiasKind, DynamicsKind, GainKind, JointKind, Model, Params, Transmission};
use crate::state::State;
use crate::workspace::{Positions, Velocities};
use clench_math::{Mask, Real, Vec3, kernel};

/// The most controls that an actuator has: position, velocity, feedforward and voltage.
const MAX_CONTROLS: usize = 4;
/// The shortest time constant (s) of a filter (MuJoCo's `mjMINVAL`).
const MIN_TIMECONST: f64 = 1e-15;

/// What actuators are given: controls as they act, and activations.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a, T> {
    /// Delayed, and within their ranges (nu).
    pub ctrl: &'a [T],
    /// Activations (na).
    pub act: &'a [T],
}

/// The controls as they act, `offset` seconds after the time of the state: those of delayed actuators are read from the past; then ranges clamp.
#[kernel]
pub fn acting_controls<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    offset: T,
    ctrl: &mut [T],
) {
    ctrl.copy_from_slice(&state.ctrl);
    for (u, actuator) in model.actuators.iter().enumerate() {
        let own = &mut ctrl[actuator.controls.clone()];
        if let Some(history) = &actuator.history {
            let delay = params.actuator_delay[u];
            let delayed = delay.gt(T::ZERO);
            if delayed.any() {
                let mut past = [T::ZERO; MAX_CONTROLS];
                history.read(&state.history, offset - delay, &mut past[..own.len()]);
                for (ctrl, &past) in own.iter_mut().zip(&past) {
                    *ctrl = T::select(delayed, past, *ctrl);
                }
            }
        }
        if model.flags.clampctrl {
            let ranges = &params.actuator_ctrlrange[actuator.controls.clone()];
            for ((ctrl, range), &limited) in own.iter_mut().zip(ranges).zip(&actuator.ctrllimited) {
                if limited {
                    *ctrl = ctrl.clamp(range[0], range[1]);
                }
            }
        }
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
    given: Given<'_, T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    act_dot: &mut [T],
) {
    for (u, actuator) in model.actuators.iter().enumerate() {
        let Some(a) = actuator.act() else { continue };
        let act = given.act[a];
        let ctrl = || given.ctrl[actuator.controls.start];
        let at = ActuatorMotion::of(model, pos, vel, u);
        act_dot[a] = match actuator.dynamics {
            // What a callback of MuJoCo's user would say.
            DynamicsKind::None | DynamicsKind::User => T::ZERO,
            DynamicsKind::Muscle => {
                muscle::activation_rate(ctrl(), act, &params.actuator_dynprm[u])
            }
            DynamicsKind::Integrator => {
                let controls = &given.ctrl[actuator.controls.clone()];
                for (a, &rate) in actuator.acts.clone().zip(controls) {
                    act_dot[a] = rate;
                }
                continue;
            }
            DynamicsKind::Filter | DynamicsKind::FilterExact => {
                (nearest_setpoint(model, params, u, ctrl(), act) - act) / time_constant(params, u)
            }
            DynamicsKind::Pid => {
                pid::activation_rates(model, params, given, u, at.length, act_dot);
                continue;
            }
            DynamicsKind::DcMotor => {
                dc_motor::activation_rates(model, params, given, u, at, act_dot);
                continue;
            }
        };
    }
}

/// Activation `a` of actuator `u` a time step later, from what it is and its rate, within its range. An exact filter approaches
/// its control by 1 − exp(−h/τ) of the distance.
#[inline(always)]
pub fn next_activation<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    a: usize,
    (act, act_dot): (T, T),
    velocity: T,
) -> T {
    let h = params.timestep;
    let actuator = &model.actuators[u];
    let next = match actuator.dynamics {
        DynamicsKind::FilterExact => {
            let tau = time_constant(params, u);
            act + act_dot * tau * (T::ONE - (-h / tau).exp())
        }
        DynamicsKind::DcMotor => {
            return dc_motor::next_activation(model, params, u, a, (act, act_dot), velocity);
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
    given: Given<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let actuator = &model.actuators[u];
    let input = match actuator.act() {
        None => given.ctrl[actuator.controls.start],
        Some(a) if actuator.actearly => {
            next_activation(model, params, u, a, (given.act[a], act_dot[a]), at.velocity)
        }
        Some(a) => given.act[a],
    };
    nearest_setpoint(model, params, u, input, at.length)
}

/// The setpoint of a servo on a ball joint, or on the rotation of a site in the frame of another, moved by whole turns to the one
/// nearest to `near`; other inputs pass
/// unchanged.
///
/// A servo is a PID controller, or has a fixed gain and an affine bias with `gain = −bias[1]`; a turn is 2π times the length of its gear.
#[inline(always)]
pub fn nearest_setpoint<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    input: T,
    near: T,
) -> T {
    let actuator = &model.actuators[u];
    let gear = &params.actuator_gear[u];
    let (rotates, axis) = match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            let on_ball = model.joints[j].kind == JointKind::Ball;
            (T::Mask::splat(on_ball), &gear[..3])
        }
        Transmission::SiteInFrame(_) => (Vec3::from_slice(gear).norm().eq(T::ZERO), &gear[3..]),
        _ => (T::Mask::splat(false), &gear[..3]),
    };
    let pid = actuator.gain == GainKind::Pid;
    let fixed = actuator.gain == GainKind::Fixed && actuator.bias == BiasKind::Affine;
    if !rotates.any() || !(pid || fixed) {
        return input;
    }
    let turn = Vec3::from_slice(axis).norm() * T::new(std::f64::consts::TAU);
    let pulls_back = params.actuator_gainprm[u][0].eq(-params.actuator_biasprm[u][1]);
    let wraps = rotates & (pulls_back | T::Mask::splat(pid)) & turn.gt(T::ZERO);
    if !wraps.any() {
        return input;
    }
    let turns = (input - near) / T::select(wraps, turn, T::ONE) + T::new(0.5);
    T::select(wraps, input - turn * turns.floor(), input)
}
