//! Direct-current motors: torque K i from a current i driven by the voltage against resistance and back-EMF, with the
//! options of MuJoCo's `dcmotor`: a controller, inductance, heat, cogging, and LuGre friction.
//!
//! ```text
//! i = (V − K ω) / R,                         without inductance
//! i̇ = ((V − K ω) / R − i) / te,              with it: te = L / R, and |i̇| bounded
//! V = R₀/K (kp (position − l) + kd (velocity − ω) + ki ∫error + feedforward) + K ω, bounded, + voltage
//! R = R₀ (1 + α (T + ambient − T₀)),         C Ṫ = R i² − T / RT
//! friction σ₀ z + σ₁ ż,                      ż = ω − σ₀ |ω| z / g(ω),  g = F_C + (F_S − F_C) exp(−(ω/v_S)²)
//! cogging  A sin(N l + φ)
//! ```
//!
//! Canudas de Wit et al. (1995), *A new model for control of systems with friction*. The parameters are stored as in
//! MuJoCo: `gainprm` R₀ K α T₀ kp ki kd Vmax; `dynprm` te, largest |i̇|, RT, C, ambient, σ₀, σ₁, slew rate, bound of
//! the integral; `biasprm` A N φ F_C F_S v_S.

use super::actuator::{ActuatorInputs, ActuatorMotion};
use crate::dynamics::setpoint::{Setpoints, integral_rate};
use crate::model::{BiasKind, ControlInput, Model, Params};
use clench_math::{Real, kernel};

/// The minimum of divisors (MuJoCo's `mjMINVAL`).
const MIN_DIVISOR: f64 = 1e-15;

#[inline(always)]
fn divisor<T: Real>(x: T) -> T {
    x.max(T::new(MIN_DIVISOR))
}

/// A motor's circuit at an instant.
struct Circuit<T> {
    setpoints: Setpoints<T>,
    /// R.
    resistance: T,
    /// K.
    constant: T,
    /// V.
    voltage: T,
    /// ∂V/∂ω.
    voltage_slope: T,
    /// ∂V/∂l.
    voltage_length_slope: T,
}

impl<T: Real> Circuit<T> {
    #[kernel]
    fn new(
        model: &Model,
        params: &Params<T>,
        inputs: ActuatorInputs<'_, T>,
        u: usize,
        at: ActuatorMotion<T>,
    ) -> Self {
        let actuator = &model.actuators[u];
        let (dyn_, gain) = (&params.actuator_dynprm[u], &params.actuator_gainprm[u]);
        let [cold, constant, tempcoef, reftemp, kp, ki, kd, vmax, ..] = *gain;
        let setpoints = Setpoints::new(model, params, inputs, u);
        let (mut voltage, mut voltage_slope) = (T::ZERO, T::ZERO);
        let mut voltage_length_slope = T::ZERO;
        let controlled =
            |input: &ControlInput| !matches!(input, ControlInput::Voltage | ControlInput::Command);
        if actuator.inputs.iter().any(controlled) {
            let integral = actuator.states.integral.map_or(T::ZERO, |a| inputs.act[a]);
            let torque = kp * (setpoints.position - at.length)
                + kd * (setpoints.velocity - at.velocity)
                + ki * integral
                + setpoints.feedforward;
            let per_torque = cold / constant;
            voltage = per_torque * torque + constant * at.velocity;
            let limited = vmax.gt(T::ZERO);
            let beyond = limited & voltage.abs().ge(vmax);
            voltage_slope = T::select(beyond, T::ZERO, constant - per_torque * kd);
            voltage_length_slope = T::select(beyond, T::ZERO, -per_torque * kp);
            voltage = T::select(limited, voltage.max(-vmax).min(vmax), voltage);
        }
        let resistance = match actuator.states.temperature {
            Some(a) => cold * (T::ONE + tempcoef * (inputs.act[a] + dyn_[4] - reftemp)),
            None => cold,
        };
        Circuit {
            voltage: voltage + setpoints.voltage,
            setpoints,
            resistance,
            constant,
            voltage_slope,
            voltage_length_slope,
        }
    }

    /// Returns the steady current of the voltage and back-EMF.
    #[inline(always)]
    fn steady_current(&self, velocity: T) -> T {
        (self.voltage - self.constant * velocity) / self.resistance
    }

    /// Returns i̇, within its bound.
    #[inline(always)]
    fn current_rate(&self, prm: &[T; 10], current: T, velocity: T) -> T {
        let rate = (self.steady_current(velocity) - current) / prm[0];
        let limit = prm[1];
        let limited = rate.max(-limit).min(limit);
        T::select(limit.gt(T::ZERO), limited, rate)
    }
}

/// Computes the rates of the activations of actuator `u`.
#[kernel]
pub(crate) fn activation_rates<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    u: usize,
    at: ActuatorMotion<T>,
    act_dot: &mut [T],
) {
    let states = model.actuators[u].states;
    let prm = &params.actuator_dynprm[u];
    let circuit = Circuit::new(model, params, inputs, u, at);
    if let Some(a) = states.slew {
        act_dot[a] = circuit.setpoints.slew_rate(params, inputs.act[a]);
    }
    if let Some(a) = states.integral {
        let error = circuit.setpoints.position - at.length;
        act_dot[a] = integral_rate(error, inputs.act[a], prm[8]);
    }
    if let Some(a) = states.temperature {
        let current = match states.current {
            Some(current) => inputs.act[current],
            None => circuit.steady_current(at.velocity),
        };
        let heat = circuit.resistance * current * current;
        act_dot[a] = (heat - inputs.act[a] / prm[2]) / prm[3];
    }
    if let Some(a) = states.bristle {
        act_dot[a] = bristle_decay(params, u, at.velocity) * inputs.act[a] + at.velocity;
    }
    if let Some(a) = states.current {
        act_dot[a] = circuit.current_rate(prm, inputs.act[a], at.velocity);
    }
}

/// Computes −σ₀ |ω| / g(ω), the decay rate of the bristle's deflection.
#[kernel]
fn bristle_decay<T: Real>(params: &Params<T>, u: usize, velocity: T) -> T {
    let [_, _, _, coulomb, static_, stribeck, ..] = params.actuator_biasprm[u];
    let ratio = velocity / divisor(stribeck);
    let level = coulomb + (static_ - coulomb) * (-ratio * ratio).exp();
    -params.actuator_dynprm[u][5] * velocity.abs() / divisor(level)
}

/// Advances an activation of a motor by a time step. A current approaches its steady value like an exact filter, a
/// deflection is integrated exactly at constant velocity, and an integral stays within its bound.
#[kernel]
pub(crate) fn next_activation<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    a: usize,
    (act, act_dot): (T, T),
    velocity: T,
) -> T {
    let states = model.actuators[u].states;
    let (h, prm) = (params.timestep, &params.actuator_dynprm[u]);
    if states.current == Some(a) {
        let te = divisor(prm[0]);
        return act + act_dot * te * (T::ONE - (-h / te).exp());
    }
    if states.bristle == Some(a) {
        let decay = bristle_decay(params, u, velocity);
        let remaining = (decay * h).exp();
        let moves = decay.abs().gt(T::new(MIN_DIVISOR));
        let time = T::select(
            moves,
            (remaining - T::ONE) / T::select(moves, decay, T::ONE),
            h,
        );
        return remaining * act + time * velocity;
    }
    let next = act + act_dot * h;
    if states.integral == Some(a) {
        let limit = prm[8];
        let within = next.max(-limit).min(limit);
        return T::select(limit.gt(T::ZERO), within, next);
    }
    next
}

/// Returns the gain and the voltage of a motor: the gain is K for the current if that is a state, else K / R for the
/// voltage.
#[kernel]
pub(crate) fn gain_and_voltage<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    u: usize,
    at: ActuatorMotion<T>,
) -> (T, T) {
    let circuit = Circuit::new(model, params, inputs, u, at);
    let gain = match model.actuators[u].states.current {
        Some(_) => circuit.constant,
        None => circuit.constant / divisor(circuit.resistance),
    };
    (gain, circuit.voltage)
}

/// Returns the force that back-EMF subtracts at this gain: zero if the current is a state, whose equation includes it.
#[inline(always)]
pub(crate) fn back_emf<T: Real>(
    model: &Model,
    params: &Params<T>,
    u: usize,
    gain: T,
    at: ActuatorMotion<T>,
) -> T {
    match model.actuators[u].states.current {
        Some(_) => T::ZERO,
        None => gain * params.actuator_gainprm[u][1] * at.velocity,
    }
}

/// Computes ∂force/∂velocity of a motor's gain, and of its back-EMF if its bias is a motor's.
#[kernel]
pub(crate) fn electrical_slope<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let circuit = Circuit::new(model, params, inputs, u, at);
    let actuator = &model.actuators[u];
    let net = match actuator.states.current {
        None if actuator.bias != BiasKind::DcMotor => circuit.voltage_slope,
        _ => circuit.voltage_slope - circuit.constant,
    };
    by_voltage(model, params, act_dot, u, &circuit, net)
}

/// Computes ∂force/∂length of a motor's gain.
#[kernel]
pub(crate) fn electrical_length_slope<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    at: ActuatorMotion<T>,
) -> T {
    let circuit = Circuit::new(model, params, inputs, u, at);
    let net = circuit.voltage_length_slope;
    by_voltage(model, params, act_dot, u, &circuit, net)
}

/// Returns the change of the force if the driving voltage changes by `net`: a current that is a state follows it within
/// the step only with `actearly`.
#[inline(always)]
fn by_voltage<T: Real>(
    model: &Model,
    params: &Params<T>,
    act_dot: &[T],
    u: usize,
    circuit: &Circuit<T>,
    net: T,
) -> T {
    let actuator = &model.actuators[u];
    let steady = circuit.constant * net / divisor(circuit.resistance);
    match actuator.states.current {
        None => steady,
        Some(_) if !actuator.actearly => T::ZERO,
        Some(a) => {
            let prm = &params.actuator_dynprm[u];
            let te = divisor(prm[0]);
            let share = T::ONE - (-params.timestep / te).exp();
            let at_limit = prm[1].gt(T::ZERO) & act_dot[a].abs().ge(prm[1]);
            T::select(at_limit, T::ZERO, steady * share)
        }
    }
}

/// Computes cogging and friction, which the motor's torque limits do not clamp.
#[kernel]
pub(crate) fn mechanical_force<T: Real>(
    model: &Model,
    params: &Params<T>,
    inputs: ActuatorInputs<'_, T>,
    act_dot: &[T],
    u: usize,
    length: T,
) -> T {
    let [amplitude, poles, phase, ..] = params.actuator_biasprm[u];
    let cogging = amplitude * (poles * length + phase).sin_cos().0;
    match model.actuators[u].states.bristle {
        Some(a) => {
            let prm = &params.actuator_dynprm[u];
            cogging - (prm[5] * inputs.act[a] + prm[6] * act_dot[a])
        }
        None => cogging,
    }
}

/// Computes ∂force/∂velocity of friction, at constant decay of the deflection.
#[inline(always)]
pub(crate) fn mechanical_slope<T: Real>(model: &Model, params: &Params<T>, u: usize) -> T {
    match model.actuators[u].states.bristle {
        Some(_) => -params.actuator_dynprm[u][6],
        None => T::ZERO,
    }
}

/// Computes ∂force/∂length of cogging.
#[kernel]
pub(crate) fn cogging_slope<T: Real>(params: &Params<T>, u: usize, length: T) -> T {
    let [amplitude, poles, phase, ..] = params.actuator_biasprm[u];
    amplitude * poles * (poles * length + phase).sin_cos().1
}
