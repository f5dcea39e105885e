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

use super::actuator::{ActuatorContext, ActuatorInputs};
use crate::dynamics::setpoint::{Setpoints, integral_rate};
use crate::model::{BiasKind, ControlInput};
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
    fn new(at: ActuatorContext<T>, inputs: ActuatorInputs<T>) -> Self {
        let actuator = at.actuator();
        let [cold, constant, tempcoef, reftemp, kp, ki, kd, vmax, ..] = *at.gainprm();
        let setpoints = Setpoints::new(at, inputs);
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
            Some(a) => cold * (T::ONE + tempcoef * (inputs.act[a] + at.dynprm()[4] - reftemp)),
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

/// Computes the rates of the activations of an actuator.
#[kernel]
pub(crate) fn activation_rates<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &mut [T],
) {
    let (states, prm) = (at.actuator().states, at.dynprm());
    let circuit = Circuit::new(at, inputs);
    if let Some(a) = states.slew {
        act_dot[a] = circuit.setpoints.slew_rate(at.params, inputs.act[a]);
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
        act_dot[a] = bristle_decay(at) * inputs.act[a] + at.velocity;
    }
    if let Some(a) = states.current {
        act_dot[a] = circuit.current_rate(prm, inputs.act[a], at.velocity);
    }
}

/// Computes −σ₀ |ω| / g(ω), the decay rate of the bristle's deflection.
#[kernel]
fn bristle_decay<T: Real>(at: ActuatorContext<T>) -> T {
    let [_, _, _, coulomb, static_, stribeck, ..] = *at.biasprm();
    let ratio = at.velocity / divisor(stribeck);
    let level = coulomb + (static_ - coulomb) * (-ratio * ratio).exp();
    -at.dynprm()[5] * at.velocity.abs() / divisor(level)
}

/// Advances an activation of a motor by a time step. A current approaches its steady value like an exact filter, a
/// deflection is integrated exactly at constant velocity, and an integral stays within its bound.
#[kernel]
pub(crate) fn next_activation<T: Real>(
    at: ActuatorContext<T>,
    a: usize,
    (act, act_dot): (T, T),
) -> T {
    let states = at.actuator().states;
    let (h, prm) = (at.params.timestep, at.dynprm());
    if states.current == Some(a) {
        let te = divisor(prm[0]);
        return act + act_dot * te * (T::ONE - (-h / te).exp());
    }
    if states.bristle == Some(a) {
        let decay = bristle_decay(at);
        let remaining = (decay * h).exp();
        let moves = decay.abs().gt(T::new(MIN_DIVISOR));
        let time = T::select(
            moves,
            (remaining - T::ONE) / T::select(moves, decay, T::ONE),
            h,
        );
        return remaining * act + time * at.velocity;
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
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
) -> (T, T) {
    let circuit = Circuit::new(at, inputs);
    let gain = match at.actuator().states.current {
        Some(_) => circuit.constant,
        None => circuit.constant / divisor(circuit.resistance),
    };
    (gain, circuit.voltage)
}

/// Returns the force that back-EMF subtracts at this gain: zero if the current is a state, whose equation includes it.
#[inline(always)]
pub(crate) fn back_emf<T: Real>(at: ActuatorContext<T>, gain: T) -> T {
    match at.actuator().states.current {
        Some(_) => T::ZERO,
        None => gain * at.gainprm()[1] * at.velocity,
    }
}

/// Computes ∂force/∂velocity of a motor's gain, and of its back-EMF if its bias is a motor's.
#[kernel]
pub(crate) fn electrical_slope<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let circuit = Circuit::new(at, inputs);
    let actuator = at.actuator();
    let net = match actuator.states.current {
        None if actuator.bias != BiasKind::DcMotor => circuit.voltage_slope,
        _ => circuit.voltage_slope - circuit.constant,
    };
    by_voltage(at, act_dot, &circuit, net)
}

/// Computes ∂force/∂length of a motor's gain.
#[kernel]
pub(crate) fn electrical_length_slope<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let circuit = Circuit::new(at, inputs);
    let net = circuit.voltage_length_slope;
    by_voltage(at, act_dot, &circuit, net)
}

/// Returns the change of the force if the driving voltage changes by `net`: a current that is a state follows it within
/// the step only with `actearly`.
#[inline(always)]
fn by_voltage<T: Real>(at: ActuatorContext<T>, act_dot: &[T], circuit: &Circuit<T>, net: T) -> T {
    let actuator = at.actuator();
    let steady = circuit.constant * net / divisor(circuit.resistance);
    match actuator.states.current {
        None => steady,
        Some(_) if !actuator.actearly => T::ZERO,
        Some(a) => {
            let prm = at.dynprm();
            let te = divisor(prm[0]);
            let share = T::ONE - (-at.params.timestep / te).exp();
            let at_limit = prm[1].gt(T::ZERO) & act_dot[a].abs().ge(prm[1]);
            T::select(at_limit, T::ZERO, steady * share)
        }
    }
}

/// Computes cogging and friction, which the motor's torque limits do not clamp.
#[kernel]
pub(crate) fn mechanical_force<T: Real>(
    at: ActuatorContext<T>,
    inputs: ActuatorInputs<T>,
    act_dot: &[T],
) -> T {
    let [amplitude, poles, phase, ..] = *at.biasprm();
    let cogging = amplitude * (poles * at.length + phase).sin_cos().0;
    match at.actuator().states.bristle {
        Some(a) => {
            let prm = at.dynprm();
            cogging - (prm[5] * inputs.act[a] + prm[6] * act_dot[a])
        }
        None => cogging,
    }
}

/// Computes ∂force/∂velocity of friction, at constant decay of the deflection.
#[inline(always)]
pub(crate) fn mechanical_slope<T: Real>(at: ActuatorContext<T>) -> T {
    match at.actuator().states.bristle {
        Some(_) => -at.dynprm()[6],
        None => T::ZERO,
    }
}

/// Computes ∂force/∂length of cogging.
#[kernel]
pub(crate) fn cogging_slope<T: Real>(at: ActuatorContext<T>) -> T {
    let [amplitude, poles, phase, ..] = *at.biasprm();
    amplitude * poles * (poles * at.length + phase).sin_cos().1
}
