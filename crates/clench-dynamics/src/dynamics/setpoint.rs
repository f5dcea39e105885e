//! Setpoints of controllers: the controls of an actuator by kind, with a rate limit on the first.

use super::actuator::{ActuatorContext, ActuatorInputs};
use crate::model::{
    BiasKind, ControlInput, DynamicsKind, GainKind, JointKind, Model, Params, Transmission,
};
use clench_math::{Mask, Real, Vec3, kernel};

/// The controls of an actuator with a controller; zero for absent ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setpoints<T> {
    /// Position.
    pub position: T,
    /// Velocity.
    pub velocity: T,
    /// Additional force or torque.
    pub feedforward: T,
    /// Voltage at the terminals of a motor, in addition to its controller's.
    pub voltage: T,
    /// The first control after its rate limit: the target of its slew activation.
    pub first: T,
}

impl<T: Real> Setpoints<T> {
    /// Returns the setpoints of an actuator. A rate limit of the first control starts at its previous value, and on a
    /// circle takes the shorter arc.
    #[kernel]
    pub fn new(at: ActuatorContext<T>, inputs: ActuatorInputs<T>) -> Self {
        let actuator = at.actuator();
        let mut setpoints = Setpoints {
            position: T::ZERO,
            velocity: T::ZERO,
            feedforward: T::ZERO,
            voltage: T::ZERO,
            first: T::ZERO,
        };
        for (k, input) in actuator.inputs.iter().enumerate() {
            let mut value = inputs.ctrl[actuator.controls.start + k];
            if k == 0 {
                if let Some(a) = actuator.states.slew {
                    let rate = match actuator.dynamics {
                        DynamicsKind::Pid => at.dynprm()[1],
                        DynamicsKind::None
                        | DynamicsKind::Integrator
                        | DynamicsKind::Filter
                        | DynamicsKind::FilterExact
                        | DynamicsKind::Muscle
                        | DynamicsKind::DcMotor
                        | DynamicsKind::User => at.dynprm()[7],
                    };
                    let (before, step) = (inputs.act[a], rate * at.params.timestep);
                    value = nearest_setpoint(at, value, before);
                    value = value.clamp(before - step, before + step);
                }
                setpoints.first = value;
            }
            match input {
                ControlInput::Position => setpoints.position = value,
                ControlInput::Velocity => setpoints.velocity = value,
                ControlInput::Feedforward => setpoints.feedforward = value,
                ControlInput::Voltage => setpoints.voltage = value,
                // Inputs of orientation servos and plain gains, which have no controller.
                ControlInput::Command | ControlInput::RotationVector | ControlInput::Quaternion => {
                }
            }
        }
        setpoints
    }

    /// Returns the rate of the activation that stores the first control.
    #[inline(always)]
    pub(crate) fn slew_rate(&self, params: &Params<T>, before: T) -> T {
        (self.first - before) / params.timestep
    }
}

/// Returns the rate of an integral of an error; an integral at its positive bound only decreases in magnitude.
#[inline(always)]
pub(crate) fn integral_rate<T: Real>(error: T, integral: T, limit: T) -> T {
    let has_limit = limit.gt(T::ZERO);
    let high = has_limit & integral.ge(limit);
    let low = has_limit & !high & integral.le(-limit);
    let from_low = T::select(low, error.max(T::ZERO), error);
    T::select(high, error.min(T::ZERO), from_low)
}

/// Returns the length change in a whole turn of a servo on a ball joint, or on the rotation of a site in the frame of
/// another: 2π times the length of its gear; zero for other actuators. A servo is a PID controller, or has a fixed gain
/// and an affine bias with `gain = −bias[1]`.
#[kernel]
pub fn whole_turn<T: Real>(model: &Model, params: &Params<T>, u: usize) -> T {
    let actuator = &model.actuators[u];
    let gear = &params.actuator_gear[u];
    let (rotates, axis) = match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            let on_ball = model.joints[j].kind == JointKind::Ball;
            (T::Mask::splat(on_ball), &gear[..3])
        }
        Transmission::SiteInFrame(_) => (Vec3::from_slice(gear).norm().eq(T::ZERO), &gear[3..]),
        Transmission::Tendon(_)
        | Transmission::Site(_)
        | Transmission::SliderCrank(_)
        | Transmission::Body(_)
        | Transmission::Rotation(_)
        | Transmission::RotationInFrame(_) => (T::Mask::splat(false), &gear[..3]),
    };
    let pid = actuator.gain == GainKind::Pid;
    let fixed = actuator.gain == GainKind::Fixed && actuator.bias == BiasKind::Affine;
    if !rotates.any() || !(pid || fixed) {
        return T::ZERO;
    }
    let full_turn = Vec3::from_slice(axis).norm() * T::new(std::f64::consts::TAU);
    let pulls_back = params.actuator_gainprm[u][0].eq(-params.actuator_biasprm[u][1]);
    let wraps = rotates & (pulls_back | T::Mask::splat(pid));
    T::select(wraps, full_turn, T::ZERO)
}

/// Moves the setpoint of a servo by [whole turns](whole_turn) to the one nearest to `near`; returns other inputs
/// unchanged.
#[kernel]
pub(crate) fn nearest_setpoint<T: Real>(at: ActuatorContext<T>, input: T, near: T) -> T {
    let full_turn = whole_turn(at.model, at.params, at.u);
    let wraps = full_turn.gt(T::ZERO);
    if !wraps.any() {
        return input;
    }
    let turns = (input - near) / T::select(wraps, full_turn, T::ONE) + T::new(0.5);
    T::select(wraps, input - full_turn * turns.floor(), input)
}
