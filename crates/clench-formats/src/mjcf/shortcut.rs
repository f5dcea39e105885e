//! The shortcuts of `<actuator>`: actuators whose dynamics, gain and bias derive from parameters of their own, such as
//! `kp`, `kv`, `area`.

use super::inputs::{Inputs, read_inputs};
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{ActuatorSpec, TransmissionSpec};
use clench_dynamics::model::{BiasKind, DynamicsKind, GainKind};

/// The element that an actuator is written with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Shortcut {
    #[default]
    General,
    Motor,
    Position,
    Velocity,
    IntVelocity,
    Orientation,
    Damper,
    Cylinder,
    Muscle,
    Pid,
    DcMotor,
    Adhesion,
}

impl Shortcut {
    /// Returns the shortcut of an element name.
    pub(super) fn from_tag(tag: &str) -> Option<Shortcut> {
        Some(match tag {
            "general" => Shortcut::General,
            "motor" => Shortcut::Motor,
            "position" => Shortcut::Position,
            "velocity" => Shortcut::Velocity,
            "intvelocity" => Shortcut::IntVelocity,
            "orientation" => Shortcut::Orientation,
            "damper" => Shortcut::Damper,
            "cylinder" => Shortcut::Cylinder,
            "muscle" => Shortcut::Muscle,
            "pid" => Shortcut::Pid,
            "dcmotor" => Shortcut::DcMotor,
            "adhesion" => Shortcut::Adhesion,
            _ => return None,
        })
    }

    /// Returns the kind of its gain.
    pub(super) fn gain(self) -> GainKind {
        match self {
            Shortcut::Orientation => GainKind::So3,
            Shortcut::Damper => GainKind::Affine,
            Shortcut::Muscle => GainKind::Muscle,
            Shortcut::Pid => GainKind::Pid,
            Shortcut::DcMotor => GainKind::DcMotor,
            _ => GainKind::Fixed,
        }
    }
}

/// The parameters from control to force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorParams {
    pub dynamics: DynamicsKind,
    pub dynprm: [f64; 10],
    pub gain: GainKind,
    pub gainprm: [f64; 10],
    pub bias: BiasKind,
    pub biasprm: [f64; 10],
    pub inheritrange: f64,
    pub actearly: bool,
    pub actdim: i32,
    /// The force range and its limited flag, if the saturation of a `dcmotor` is part of the parameters.
    pub saturation: Option<([f64; 2], Option<bool>)>,
    /// The control inputs; `None` for the default ones.
    pub inputs: Option<Inputs>,
    /// The shortcut that defined them, which also determines the control if `inputs` does not.
    pub shortcut: Shortcut,
}

/// Pads leading entries with zeros.
fn params<const N: usize>(leading: [f64; N]) -> [f64; 10] {
    let mut all = [0.0; 10];
    all[..N].copy_from_slice(&leading);
    all
}

impl Default for ActuatorParams {
    fn default() -> Self {
        let general = ActuatorSpec::general("", TransmissionSpec::Joint(String::new()));
        ActuatorParams {
            dynamics: general.dynamics,
            dynprm: general.dynprm,
            gain: general.gain,
            gainprm: general.gainprm,
            bias: general.bias,
            biasprm: general.biasprm,
            inheritrange: general.inheritrange,
            actearly: general.actearly,
            actdim: -1,
            saturation: None,
            inputs: None,
            shortcut: Shortcut::General,
        }
    }
}

/// Reads `position` and `intvelocity`: force = kp (target − length) − kv velocity.
fn read_servo(element: &Element, inherited: ActuatorParams) -> Result<ActuatorParams, LoadError> {
    element.at_most_one(&["kv", "dampratio"])?;
    let mut kp = inherited.gainprm[0];
    element.set_number("kp", &mut kp)?;
    let mut parameters = ActuatorParams {
        gainprm: params([kp]),
        bias: BiasKind::Affine,
        biasprm: params([0.0, -kp, inherited.biasprm[2]]),
        inheritrange: inherited.inheritrange,
        ..ActuatorParams::default()
    };
    if let Some(kv) = not_negative(element, "kv")? {
        parameters.biasprm[2] = -kv;
    }
    if let Some(dampratio) = not_negative(element, "dampratio")? {
        parameters.biasprm[2] = dampratio;
    }
    element.set_number("inheritrange", &mut parameters.inheritrange)?;
    Ok(parameters)
}

/// Reads `position`: a servo, filtered if it has a time constant.
pub(crate) fn read_position(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let mut parameters = read_servo(element, inherited)?;
    let filtered = inherited.dynamics == DynamicsKind::FilterExact;
    let inherited = filtered.then_some(inherited.dynprm[0]);
    let Some(timeconst) = not_negative(element, "timeconst")?.or(inherited) else {
        return Ok(parameters);
    };
    if timeconst > 0.0 {
        parameters.dynamics = DynamicsKind::FilterExact;
    }
    // A class passes it on even if it is zero.
    parameters.dynprm = params([timeconst]);
    Ok(parameters)
}

/// Reads `intvelocity`: a servo whose target is the integral of the control. Like `position`, it inherits the time
/// constant of a filtered class, and passes it on in its own class.
pub(crate) fn read_intvelocity(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    Ok(ActuatorParams {
        dynamics: DynamicsKind::Integrator,
        ..read_position(element, inherited)?
    })
}

/// Reads `orientation`: torque = kp · (rotation to the target) − kv · angular velocity.
pub(crate) fn read_orientation(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let mut parameters = ActuatorParams {
        gain: GainKind::So3,
        bias: BiasKind::So3,
        inheritrange: 0.0,
        inputs: inherited.inputs.filter(|_| inherited.gain == GainKind::So3),
        ..read_servo(element, inherited)?
    };
    read_inputs(element, &mut parameters.inputs)?;
    Ok(parameters)
}

/// Reads `damper`: force = −kv velocity · control.
pub(crate) fn read_damper(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let mut kv = match inherited.gain {
        GainKind::Affine => -inherited.gainprm[2],
        _ => 0.0,
    };
    element.set_number("kv", &mut kv)?;
    if kv < 0.0 {
        return Err(element.error("kv cannot be negative"));
    }
    Ok(ActuatorParams {
        gain: GainKind::Affine,
        gainprm: params([0.0, 0.0, -kv]),
        ..ActuatorParams::default()
    })
}

/// Reads `velocity`: force = kv (target − velocity).
pub(crate) fn read_velocity(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let mut kv = inherited.gainprm[0];
    element.set_number("kv", &mut kv)?;
    Ok(ActuatorParams {
        gainprm: params([kv]),
        bias: BiasKind::Affine,
        biasprm: params([0.0, 0.0, -kv]),
        ..ActuatorParams::default()
    })
}

/// Reads `cylinder`: force = area · filtered pressure + bias.
pub(crate) fn read_cylinder(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let mut parameters = ActuatorParams {
        dynamics: DynamicsKind::Filter,
        dynprm: params([inherited.dynprm[0]]),
        gainprm: params([inherited.gainprm[0]]),
        bias: BiasKind::Affine,
        biasprm: inherited.biasprm,
        ..ActuatorParams::default()
    };
    element.set_number("timeconst", &mut parameters.dynprm[0])?;
    element.set_number("area", &mut parameters.gainprm[0])?;
    if let Some([diameter]) = element.numbers("diameter")?.filter(|[d]| *d >= 0.0) {
        parameters.gainprm[0] = std::f64::consts::FRAC_PI_4 * diameter * diameter;
    }
    if let Some(bias) = element.numbers::<3>("bias")? {
        parameters.biasprm[..3].copy_from_slice(&bias);
    }
    Ok(parameters)
}

/// Reads `muscle`: dynamics, gain and bias of a muscle. Negative values of its own attributes stand for the defaults,
/// whatever its class.
pub(crate) fn read_muscle(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let usual_dynprm = params([0.01, 0.04]);
    let usual_prm = params([0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2]);
    let (mut dynprm, mut prm) = match inherited.gain {
        GainKind::Muscle => (inherited.dynprm, inherited.gainprm),
        _ => (usual_dynprm, usual_prm),
    };
    if let Some(timeconst) = element.numbers::<2>("timeconst")? {
        overwrite(&mut dynprm[..2], &timeconst, &usual_dynprm);
    }
    if let Some(range) = element.numbers::<2>("range")? {
        overwrite(&mut prm[..2], &range, &usual_prm);
    }
    let names = ["force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax"];
    for (k, name) in (2..).zip(names) {
        if let Some(value) = element.numbers::<1>(name)? {
            overwrite(&mut prm[k..=k], &value, &usual_prm[k..]);
        }
    }
    if let Some(tausmooth) = not_negative(element, "tausmooth")? {
        dynprm[2] = tausmooth;
    }
    Ok(ActuatorParams {
        dynamics: DynamicsKind::Muscle,
        dynprm,
        gain: GainKind::Muscle,
        gainprm: prm,
        bias: BiasKind::Muscle,
        biasprm: prm,
        ..ActuatorParams::default()
    })
}

/// Overwrites targets with the given numbers, using the default for negative ones.
fn overwrite(targets: &mut [f64], given: &[f64], usual: &[f64]) {
    for ((target, &given), &usual) in targets.iter_mut().zip(given).zip(usual) {
        *target = if given < 0.0 { usual } else { given };
    }
}

pub(crate) fn not_negative(element: &Element, name: &str) -> Result<Option<f64>, LoadError> {
    match element.numbers(name)? {
        Some([value]) if value < 0.0 => Err(element.error(format!("{name} cannot be negative"))),
        value => Ok(value.map(|[value]| value)),
    }
}

/// Reads `adhesion`: force = gain · control.
pub(super) fn read_adhesion(
    element: &Element,
    inherited: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let mut gain = inherited.gainprm[0];
    element.set_number("gain", &mut gain)?;
    if gain < 0.0 {
        return Err(element.error("gain cannot be negative"));
    }
    Ok(ActuatorParams {
        gainprm: params([gain]),
        ..ActuatorParams::default()
    })
}
