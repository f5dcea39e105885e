//! The controls of actuators, and the activations of controllers and motors: MuJoCo's rules for gains of the kinds
//! `pid`, `dcmotor` and `so3`.

use super::element::Element;
use super::{ActuatorSpec, BuildError, TransmissionSpec};
use clench_dynamics::model::{BiasKind, ControlInput, ControllerStates, DynamicsKind, GainKind};

/// The controls of an actuator, and its activations with a special meaning.
pub(super) struct Controller {
    /// The meaning of each control.
    pub inputs: Vec<ControlInput>,
    /// The activations.
    pub states: ControllerStates,
    /// The number of activations.
    pub count: usize,
}

/// Returns the controls of an actuator; its activations start at `first`.
///
/// # Errors
/// Returns an error if kinds are incompatible, the gain does not support an input, or parameters lack the inputs that
/// they need.
pub(super) fn controller(spec: &ActuatorSpec, first: usize) -> Result<Controller, BuildError> {
    if spec.dynamics == DynamicsKind::Pid && spec.gain != GainKind::Pid {
        return Err(spec.error("dynamics of the kind pid need a gain of that kind"));
    }
    let motor = [
        spec.dynamics == DynamicsKind::DcMotor,
        spec.gain == GainKind::DcMotor,
        spec.bias == BiasKind::DcMotor,
    ];
    match spec.gain {
        GainKind::Pid => pid(spec, first),
        GainKind::So3 => orientation_servo(spec),
        GainKind::Fixed
        | GainKind::Affine
        | GainKind::Muscle
        | GainKind::DcMotor
        | GainKind::User => {
            if spec.bias == BiasKind::So3 {
                let reason = "gain and bias must both be of the kind so3, or neither";
                return Err(spec.error(reason));
            }
            if motor != [false; 3] {
                return parts_of_motor(spec, first);
            }
            Ok(Controller {
                inputs: vec![ControlInput::Command],
                states: ControllerStates::default(),
                count: 0,
            })
        }
    }
}

fn orientation_servo(spec: &ActuatorSpec) -> Result<Controller, BuildError> {
    let (vector, quaternion) = (
        vec![ControlInput::RotationVector; 3],
        vec![ControlInput::Quaternion; 4],
    );
    let inputs = spec.inputs.clone().unwrap_or_else(|| vector.clone());
    let integrates = spec.dynamics == DynamicsKind::Integrator;
    if spec.bias != BiasKind::So3 {
        return Err(spec.error("gain and bias must both be of the kind so3, or neither"));
    }
    if !integrates && spec.dynamics != DynamicsKind::None {
        return Err(spec.error("a gain of the kind so3 needs an integrator, or no dynamics"));
    }
    if spec.gainprm[0] != -spec.biasprm[1] {
        return Err(spec.error("a gain of the kind so3 needs gainprm[0] = -biasprm[1]"));
    }
    if inputs != vector && (inputs != quaternion || integrates) {
        return Err(spec.error(match integrates {
            true => "an orientation servo that integrates is controlled by a rotation vector (expmap)",
            false => "an orientation servo is controlled by a rotation vector (expmap) or a quaternion (quat)",
        }));
    }
    Ok(Controller {
        inputs,
        states: ControllerStates::default(),
        count: 0,
    })
}

/// Numbers activations in the order in which they are requested.
struct Numbering {
    first: usize,
    count: usize,
}

impl Numbering {
    fn next_if(&mut self, wanted: bool) -> Option<usize> {
        let number = self.first + self.count;
        self.count += usize::from(wanted);
        wanted.then_some(number)
    }
}

fn pid(spec: &ActuatorSpec, first: usize) -> Result<Controller, BuildError> {
    use ControlInput::{Feedforward, Position, Velocity};
    let ki = spec.gainprm[0];
    let [imax, slewmax, ..] = spec.dynprm;
    let stateful = spec.dynamics == DynamicsKind::Pid;
    if matches!(spec.transmission, TransmissionSpec::Body(_)) {
        return Err(spec.error("a gain of the kind pid cannot act on the contacts of a body"));
    }
    if spec.bias != BiasKind::Affine {
        return Err(spec.error("a gain of the kind pid needs an affine bias"));
    }
    if !stateful && spec.dynamics != DynamicsKind::None {
        return Err(spec.error("a gain of the kind pid needs dynamics of that kind, or none"));
    }
    if !stateful && ki != 0.0 {
        return Err(spec.error("ki (gainprm[0]) needs dynamics of the kind pid"));
    }
    let inputs = inputs(
        spec,
        &[Position, Velocity],
        &[Position, Velocity, Feedforward],
    )?;
    let mut numbers = Numbering { first, count: 0 };
    let mut states = ControllerStates::default();
    if stateful {
        spec.require_not_negative("imax (dynprm[0])", &[imax])?;
        spec.require_not_negative("slewmax (dynprm[1])", &[slewmax])?;
        if !inputs.contains(&Position) {
            return Err(spec.error("ki and slewmax of a pid need the input pos"));
        }
        states.slew = numbers.next_if(slewmax > 0.0);
        states.integral = numbers.next_if(ki > 0.0);
        if numbers.count == 0 {
            return Err(spec.error("dynamics of the kind pid need a positive ki or slewmax"));
        }
    }
    Ok(Controller {
        inputs,
        states,
        count: numbers.count,
    })
}

/// Returns the controls of a motor, or of a `general` with parts of a motor: its dynamics, gain and bias each
/// contribute, as in MuJoCo, which requires that the number of activations matches the motor's parameters. A motor's
/// bias requires its gain here, because MuJoCo's derivatives of another gain's force that is clamped to a range are not
/// known.
fn parts_of_motor(spec: &ActuatorSpec, first: usize) -> Result<Controller, BuildError> {
    if spec.bias == BiasKind::DcMotor && spec.gain != GainKind::DcMotor {
        return Err(spec.error("a bias of the kind dcmotor needs a gain of that kind"));
    }
    let controller = match spec.gain {
        GainKind::DcMotor => dc_motor(spec, first)?,
        GainKind::Fixed
        | GainKind::Affine
        | GainKind::Muscle
        | GainKind::Pid
        | GainKind::So3
        | GainKind::User => Controller {
            inputs: vec![ControlInput::Command],
            ..motor_states(spec, first)
        },
    };
    if spec.dynamics == DynamicsKind::DcMotor && !spec.actearly {
        return Err(spec.error("actearly cannot be false for a dcmotor"));
    }
    let states = controller.states;
    if spec.gain != GainKind::DcMotor && (states.slew.is_some() || states.integral.is_some()) {
        return Err(spec.error("a controller of a dcmotor needs a gain of that kind"));
    }
    let count = match spec.dynamics {
        DynamicsKind::None => 0,
        DynamicsKind::DcMotor => controller.count,
        DynamicsKind::User => spec.actdim.unwrap_or(1),
        DynamicsKind::Integrator
        | DynamicsKind::Filter
        | DynamicsKind::FilterExact
        | DynamicsKind::Muscle
        | DynamicsKind::Pid => 1,
    };
    if count != controller.count {
        return Err(spec.error(format!(
            "its dynamics have {count} activations, but its parameters are those of a dcmotor with {}",
            controller.count
        )));
    }
    Ok(controller)
}

fn dc_motor(spec: &ActuatorSpec, first: usize) -> Result<Controller, BuildError> {
    use ControlInput::{Feedforward, Position, Velocity, Voltage};
    let [_, constant, _, _, kp, ki, kd, ..] = spec.gainprm;
    let slewmax = spec.dynprm[7];
    let inputs = inputs(
        spec,
        &[Voltage],
        &[Position, Velocity, Feedforward, Voltage],
    )?;
    let controlled = inputs.iter().any(|&input| input != Voltage);
    if controlled && constant <= 0.0 {
        return Err(spec.error("a controller of a dcmotor needs a positive motor constant"));
    }
    let gains = [kp, ki, kd].iter().any(|&gain| gain != 0.0);
    if !controlled && (gains || slewmax > 0.0) {
        return Err(spec.error("a controller of a dcmotor needs an input pos, vel or ff"));
    }
    if ki > 0.0 && !inputs.contains(&Position) {
        return Err(spec.error("ki of a dcmotor needs the input pos"));
    }
    Ok(Controller {
        inputs,
        ..motor_states(spec, first)
    })
}

/// Returns the activations that the parameters of a motor imply, without its inputs.
fn motor_states(spec: &ActuatorSpec, first: usize) -> Controller {
    let [te, _, thermal, _, _, bristle, _, slewmax, ..] = spec.dynprm;
    let mut numbers = Numbering { first, count: 0 };
    let states = ControllerStates {
        slew: numbers.next_if(slewmax > 0.0),
        integral: numbers.next_if(spec.gainprm[5] > 0.0),
        temperature: numbers.next_if(thermal > 0.0),
        bristle: numbers.next_if(bristle > 0.0),
        current: numbers.next_if(te > 0.0),
    };
    Controller {
        inputs: Vec::new(),
        states,
        count: numbers.count,
    }
}

/// Returns the inputs that the author names, or the default ones.
fn inputs(
    spec: &ActuatorSpec,
    usual: &[ControlInput],
    allowed: &[ControlInput],
) -> Result<Vec<ControlInput>, BuildError> {
    let Some(given) = &spec.inputs else {
        return Ok(usual.to_vec());
    };
    let rises = given.windows(2).all(|pair| pair[0] < pair[1]);
    if !rises || given.iter().any(|input| !allowed.contains(input)) {
        return Err(spec.error(format!(
            "its inputs must be some of {allowed:?}, in this order, but are {given:?}"
        )));
    }
    Ok(given.clone())
}
