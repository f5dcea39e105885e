//! The actuator shortcuts `pid` and `dcmotor`.

use super::inputs::read_inputs;
use super::shortcut::{ActuatorParams, not_negative};
use crate::document::Element;
use crate::error::LoadError;
use clench_dynamics::model::{BiasKind, DynamicsKind, GainKind};

/// Reads `pid`: force = kp (position − length) + kv (velocity − its velocity) + ki ∫error + feedforward.
pub(crate) fn read_pid(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    element.at_most_one(&["kv", "dampratio"])?;
    let lent = inherited.gain == GainKind::Pid;
    let (mut ki, [_, kp, kv, ..]) = match lent {
        true => (inherited.gainprm[0], inherited.biasprm),
        false => (0.0, [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    };
    let [mut imax, mut slewmax] = match lent {
        true => [inherited.dynprm[0], inherited.dynprm[1]],
        false => [0.0; 2],
    };
    let mut gain = -kp;
    element.set_number("kp", &mut gain)?;
    element.set_number("ki", &mut ki)?;
    element.set_number("imax", &mut imax)?;
    element.set_number("slewmax", &mut slewmax)?;
    if slewmax < 0.0 {
        return Err(element.error("slewmax cannot be negative"));
    }
    let mut parameters = ActuatorParams {
        gain: GainKind::Pid,
        gainprm: [0.0; 10],
        bias: BiasKind::Affine,
        dynprm: [0.0; 10],
        inputs: inherited.inputs.filter(|_| lent),
        inheritrange: if lent { inherited.inheritrange } else { 0.0 },
        ..ActuatorParams::default()
    };
    parameters.gainprm[0] = ki;
    parameters.biasprm[1] = -gain;
    parameters.biasprm[2] = match (
        not_negative(element, "kv")?,
        not_negative(element, "dampratio")?,
    ) {
        (Some(kv), _) => -kv,
        (None, Some(dampratio)) => dampratio,
        (None, None) => kv,
    };
    parameters.dynprm[0] = if ki == 0.0 { 0.0 } else { imax };
    parameters.dynprm[1] = slewmax;
    if ki != 0.0 || slewmax != 0.0 {
        parameters.dynamics = DynamicsKind::Pid;
    }
    element.set_number("inheritrange", &mut parameters.inheritrange)?;
    read_inputs(element, &mut parameters.inputs)?;
    Ok(parameters)
}

/// The force limits set by `saturation` of a `dcmotor`.
pub(crate) enum Saturation {
    /// Not specified: limits are unchanged.
    Inherited,
    /// No limit.
    None,
    /// The maximum torque.
    Torque(f64),
}

/// Reads `dcmotor`: a motor with its controller, circuit, heat and friction; `damping` is the linear damping of the
/// actuator.
pub(crate) fn read_dc_motor(
    element: &Element,
    inherited: ActuatorParams,
    damping: f64,
) -> Result<(ActuatorParams, Saturation), LoadError> {
    let lent = inherited.gain == GainKind::DcMotor;
    let zeros = ActuatorParams {
        dynamics: DynamicsKind::DcMotor,
        dynprm: [0.0; 10],
        gain: GainKind::DcMotor,
        gainprm: [0.0; 10],
        bias: BiasKind::DcMotor,
        biasprm: [0.0; 10],
        actearly: true,
        ..ActuatorParams::default()
    };
    let mut motor = zeros;
    if lent {
        motor.dynprm = inherited.dynprm;
        motor.gainprm = inherited.gainprm;
        motor.biasprm = inherited.biasprm;
        motor.inputs = inherited.inputs;
    }
    read_inputs(element, &mut motor.inputs)?;
    read_constants(element, &mut motor, damping)?;
    read_circuit(element, &mut motor)?;
    read_heat(element, &mut motor)?;
    read_friction(element, &mut motor)?;
    let saturation = read_saturation(element, &mut motor)?;
    motor.actdim = count_activations(&motor);
    Ok((motor, saturation))
}

/// Returns the number of activations: one each for current, heat, friction, slew and integral. A `general` of its class
/// inherits it.
fn count_activations(motor: &ActuatorParams) -> i32 {
    let [te, _, thermal, _, _, bristle, _, slewmax, ..] = motor.dynprm;
    let states = [te, thermal, bristle, slewmax, motor.gainprm[5]];
    states.map(|state| i32::from(state > 0.0)).iter().sum()
}

/// Reads resistance R and motor constant K, specified or from a nominal operating point (MuJoCo's technical note on
/// motors, section 2.1).
fn read_constants(
    element: &Element,
    motor: &mut ActuatorParams,
    damping: f64,
) -> Result<(), LoadError> {
    let [mut resistance, inherited, ..] = motor.gainprm;
    let mut constants = [inherited, 0.0];
    element.overlay("motorconst", &mut constants)?;
    element.set_number("resistance", &mut resistance)?;
    let mut nominal = [0.0; 3];
    element.overlay("nominal", &mut nominal)?;
    let [torque, mut back_emf] = constants;
    let [voltage, stall, speed] = nominal;
    if torque < 0.0 || back_emf < 0.0 {
        return Err(element.error("the constants in motorconst cannot be negative"));
    }
    if voltage > 0.0 && back_emf == 0.0 && speed > 0.0 {
        back_emf = nominal_back_emf(nominal, resistance, damping);
    }
    let constant = match (torque > 0.0, back_emf > 0.0) {
        (true, true) => (torque * back_emf).sqrt(),
        (true, false) => torque,
        _ => back_emf,
    };
    if resistance == 0.0 && voltage > 0.0 && stall > 0.0 {
        resistance = constant * voltage / stall;
    }
    let passive = motor
        .inputs
        .is_some_and(|inputs| inputs.controls().is_empty());
    if constant <= 0.0 && !passive {
        return Err(
            element.error("its motor constant must be positive: give motorconst or nominal")
        );
    }
    if resistance <= 0.0 {
        return Err(element.error("its resistance must be positive: give resistance or nominal"));
    }
    (motor.gainprm[0], motor.gainprm[1]) = (resistance, constant);
    Ok(())
}

/// Returns the back-EMF constant for which the motor, with its damping, reaches its no-load speed at the nominal
/// voltage.
fn nominal_back_emf([voltage, stall, speed]: [f64; 3], resistance: f64, damping: f64) -> f64 {
    let undamped = voltage / speed;
    if damping <= 0.0 {
        return undamped;
    }
    if resistance > 0.0 {
        let discriminant = voltage * voltage - 4.0 * resistance * damping * speed * speed;
        return match discriminant > 0.0 {
            true => (voltage + discriminant.sqrt()) / (2.0 * speed),
            false => undamped,
        };
    }
    let damped = undamped - voltage * damping / stall;
    match stall > 0.0 && damped > 0.0 {
        true => damped,
        false => undamped,
    }
}

/// Reads the inductance, and the controller's gains and limits.
fn read_circuit(element: &Element, motor: &mut ActuatorParams) -> Result<(), LoadError> {
    let mut inductance = [0.0; 2];
    if element.overlay("inductance", &mut inductance)? > 0 {
        let [inductance, timeconst] = inductance;
        if inductance < 0.0 || timeconst < 0.0 {
            return Err(element.error("inductance and its time constant cannot be negative"));
        }
        let inductive = inductance > 0.0;
        motor.dynprm[0] = if inductive {
            inductance / motor.gainprm[0]
        } else {
            timeconst
        };
    }
    let (gain, bounds) = (&mut motor.gainprm, &mut motor.dynprm);
    let mut controller = [gain[4], gain[5], gain[6], bounds[7], bounds[8], gain[7]];
    if element.overlay("controller", &mut controller)? > 0 {
        let [kp, ki, kd, slewmax, imax, vmax] = controller;
        [gain[4], gain[5], gain[6], bounds[7], bounds[8]] = [kp, ki, kd, slewmax, imax];
        gain[7] = vmax.max(0.0);
    }
    Ok(())
}

fn read_heat(element: &Element, motor: &mut ActuatorParams) -> Result<(), LoadError> {
    let (gain, prm) = (&mut motor.gainprm, &mut motor.dynprm);
    let mut thermal = [prm[2], prm[3], 0.0, gain[2], gain[3], prm[4]];
    if element.overlay("thermal", &mut thermal)? == 0 {
        return Ok(());
    }
    let [
        mut resistance,
        mut capacity,
        timeconst,
        tempcoef,
        reference,
        ambient,
    ] = thermal;
    if resistance <= 0.0 && capacity <= 0.0 && timeconst <= 0.0 {
        (gain[2], gain[3]) = (0.0, 0.0);
        prm[2..5].fill(0.0);
        return Ok(());
    }
    if timeconst > 0.0 && resistance > 0.0 {
        capacity = timeconst / resistance;
    } else if timeconst > 0.0 && capacity > 0.0 && resistance == 0.0 {
        resistance = timeconst / capacity;
    }
    if resistance <= 0.0 || capacity <= 0.0 {
        let message =
            "two of resistance, capacitance and time constant in thermal must be positive";
        return Err(element.error(message));
    }
    (gain[2], gain[3]) = (tempcoef, reference);
    (prm[2], prm[3], prm[4]) = (resistance, capacity, ambient);
    Ok(())
}

/// Reads cogging and LuGre friction.
fn read_friction(element: &Element, motor: &mut ActuatorParams) -> Result<(), LoadError> {
    let (bias, prm) = (&mut motor.biasprm, &mut motor.dynprm);
    let mut cogging = [bias[0], bias[1], bias[2]];
    element.overlay("cogging", &mut cogging)?;
    bias[..3].copy_from_slice(&cogging);
    let mut lugre = [prm[5], prm[6], bias[3], bias[4], bias[5]];
    if element.overlay("lugre", &mut lugre)? > 0 {
        let lugre = if lugre[0] > 0.0 { lugre } else { [0.0; 5] };
        prm[5..7].copy_from_slice(&lugre[..2]);
        bias[3..6].copy_from_slice(&lugre[2..]);
    }
    Ok(())
}

fn read_saturation(element: &Element, motor: &mut ActuatorParams) -> Result<Saturation, LoadError> {
    let mut saturation = [0.0, 0.0, motor.dynprm[1]];
    if element.overlay("saturation", &mut saturation)? == 0 {
        return Ok(Saturation::Inherited);
    }
    let [torque, current, rate] = saturation;
    motor.dynprm[1] = rate.max(0.0);
    Ok(match () {
        () if torque > 0.0 => Saturation::Torque(torque),
        // As in MuJoCo, the positive current makes the range of a negative torque count, which the builder refuses.
        () if torque < 0.0 && current > 0.0 => Saturation::Torque(torque),
        () if torque == 0.0 && current > 0.0 => Saturation::Torque(motor.gainprm[1] * current),
        () => Saturation::None,
    })
}
