//! Actuator inputs: clamped controls, activation dynamics, and setpoints on a circle.

use super::actuator::{ActuatorContext, ActuatorInputs};
use super::setpoint::nearest_setpoint;
use crate::dynamics::dc_motor;
use crate::model::{DynamicsKind, Model, Params};
use crate::state::State;
use clench_math::{Mask, Real, kernel};

/// The maximum number of controls of an actuator: position, velocity, feedforward and voltage.
const MAX_CONTROLS: usize = 4;
/// The shortest time constant (s) of a filter (MuJoCo's `mjMINVAL`).
const MIN_TIMECONST: f64 = 1e-15;

/// Computes the effective controls `offset` seconds after the time of the state: reads delayed ones from the history,
/// then clamps them.
#[kernel]
pub(crate) fn acting_controls<T: Real>(
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
pub(super) fn time_constant<T: Real>(at: ActuatorContext<T>) -> T {
    at.dynprm()[0].max(T::new(MIN_TIMECONST))
}

/// Advances activation `a` of an actuator by a time step at its rate, within its range. An exact filter covers 1 −
/// exp(−h/τ) of the distance to its control.
#[inline(always)]
pub(crate) fn next_activation<T: Real>(
    at: ActuatorContext<T>,
    a: usize,
    (act, act_dot): (T, T),
) -> T {
    let h = at.params.timestep;
    let actuator = at.actuator();
    let next = match actuator.dynamics {
        DynamicsKind::FilterExact => {
            let tau = time_constant(at);
            act + act_dot * tau * (T::ONE - (-h / tau).exp())
        }
        DynamicsKind::DcMotor => {
            return dc_motor::next_activation(at, a, (act, act_dot));
        }
        DynamicsKind::None
        | DynamicsKind::Integrator
        | DynamicsKind::Filter
        | DynamicsKind::Muscle
        | DynamicsKind::Pid
        | DynamicsKind::User => act + act_dot * h,
    };
    if actuator.actlimited {
        let [low, high] = at.params.actuator_actrange[at.u];
        next.clamp(low, high)
    } else {
        next
    }
}

/// Returns the factor of the gain of an actuator: its control or its activation (at the end of the step with
/// `actearly`).
#[inline(always)]
pub(crate) fn input<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let actuator = at.actuator();
    let input = match actuator.act() {
        None => inputs.ctrl[actuator.controls.start],
        Some(a) => acting(at, inputs, act_dot, a),
    };
    nearest_setpoint(at, input, at.length)
}

/// Returns activation `a` of an actuator for its gain: at the end of the step with `actearly`.
#[inline(always)]
pub(crate) fn acting<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
    a: usize,
) -> T {
    match at.actuator().actearly {
        true => next_activation(at, a, (inputs.act[a], act_dot[a])),
        false => inputs.act[a],
    }
}
