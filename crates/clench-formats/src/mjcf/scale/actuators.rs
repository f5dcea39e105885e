//! Scaling of actuators: the quantity that a control measures determines the factor of its gains.

use super::{Along, Coordinate, Frames, located};
use crate::error::LoadError;
use crate::mjcf::shortcut::Shortcut;
use clench_builder::{ActuatorSpec, BuildError, ModelBuilder, SensorSubject, TransmissionSpec};
use clench_dynamics::model::{Attachment, BiasKind, ControlInput, DynamicsKind, GainKind};
use std::collections::BTreeMap;

/// The factors of the controls and the activations of an actuator, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct States {
    pub controls: Vec<f64>,
    pub activations: Vec<f64>,
}

impl Frames {
    /// Scales the actuators, and returns the factors of their controls and activations.
    ///
    /// # Errors
    /// Returns an error if the parameters of an actuator cannot be scaled.
    pub(super) fn scale_actuators(
        &self,
        shortcuts: &[Shortcut],
        builder: &mut ModelBuilder,
    ) -> Result<Vec<States>, LoadError> {
        let mut states = Vec::with_capacity(shortcuts.len());
        let mut transmissions = BTreeMap::new();
        for (actuator, &written) in builder.actuators.iter_mut().zip(shortcuts) {
            let along = self.along_transmission(actuator);
            states.push(scale_actuator(actuator, written, along)?);
            transmissions.insert(actuator.name.as_str(), along);
        }
        for sensor in &mut builder.sensors {
            let along = match &sensor.subject {
                SensorSubject::Element(name) => transmissions.get(name.as_str()),
                _ => None,
            };
            let of_actuator = sensor.kind.attachment() == Attachment::Actuator;
            let along = along.filter(|_| of_actuator);
            let factor = along.map_or(1.0, |along| along.of_dimension(sensor.kind.dimension()));
            sensor.cutoff *= factor;
            sensor.noise *= factor;
        }
        Ok(states)
    }

    /// Returns the scale along a transmission; rotational gears next to translational ones scale as lengths.
    fn along_transmission(&self, actuator: &mut ActuatorSpec) -> Along {
        let (scale, free) = match &actuator.transmission {
            TransmissionSpec::Joint(joint) | TransmissionSpec::JointInParent(joint) => {
                match self.of_free_joint(joint) {
                    Some(scale) => (scale, true),
                    None => return self.of_joint(joint),
                }
            }
            TransmissionSpec::Tendon(tendon) => return self.of_tendon(tendon),
            TransmissionSpec::Site(site) | TransmissionSpec::SiteInFrame { site, .. } => {
                (self.of_site(site), true)
            }
            TransmissionSpec::SliderCrank { crank, slider } => {
                (self.of_site(crank).mean(self.of_site(slider)), false)
            }
            TransmissionSpec::Body(body) => (self.of_body(body), false),
        };
        let [x, y, z, rotational @ ..] = &mut actuator.gear;
        let pulls = [x, y, z].into_iter().any(|gear| *gear != 0.0);
        match (free, pulls) {
            (true, false) => scale.along(Coordinate::Angle),
            (true, true) => {
                rotational.iter_mut().for_each(|gear| *gear *= scale.length);
                scale.along(Coordinate::Length)
            }
            (false, _) => {
                actuator.cranklength *= scale.length;
                scale.along(Coordinate::Length)
            }
        }
    }
}

fn scale_actuator(
    actuator: &mut ActuatorSpec,
    written: Shortcut,
    along: Along,
) -> Result<States, LoadError> {
    let refuse = |message: &str| {
        Err(located(
            &actuator.origin,
            "actuator",
            &actuator.name,
            message,
        ))
    };
    let follows = along.force != 1.0 || along.unit != 1.0;
    let unknown = [GainKind::User, GainKind::DcMotor].contains(&actuator.gain)
        || [BiasKind::User, BiasKind::DcMotor].contains(&actuator.bias)
        || actuator.dynamics == DynamicsKind::User;
    if unknown && follows {
        return refuse("its parameters cannot be scaled; use scaling \"geometry\"");
    }
    let command = Command::new(actuator, written);
    // An invalid count is rejected when the model is built.
    let states = command.states(actuator, written, along).unwrap_or_default();
    let is_servo = |actuator: &ActuatorSpec| actuator.gainprm[0] == -actuator.biasprm[1];
    let was_servo = actuator.gain == GainKind::Fixed && is_servo(actuator);
    scale_gain(actuator, command, along);
    scale_bias(actuator, along);
    scale_setpoints(actuator, along);
    let first = states.controls.first().copied().unwrap_or(1.0);
    let activation = states.activations.first().copied().unwrap_or(1.0);
    // As in MuJoCo, a servo that is no longer one after scaling inherits no range.
    if was_servo && !is_servo(actuator) {
        actuator.inheritrange = 0.0;
    }
    actuator.ctrlrange = match actuator.gain {
        GainKind::Pid => actuator.ctrlrange.map(|end| end * along.coordinate),
        _ => actuator.ctrlrange.map(|end| end * first),
    };
    actuator.velrange = actuator.velrange.map(|end| end * along.coordinate);
    actuator.ffrange = actuator.ffrange.map(|end| end * along.force);
    actuator.actrange = actuator.actrange.map(|end| end * activation);
    actuator.forcerange = actuator.forcerange.map(|end| end * along.force);
    actuator.lengthrange = actuator.lengthrange.map(|end| end * along.coordinate);
    actuator.armature *= along.gain();
    along.polynomial(&mut actuator.damping);
    Ok(states)
}

/// The quantity of an actuator's only control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Command {
    /// A position or velocity along the transmission.
    Coordinate,
    /// A pressure in a cylinder.
    Pressure,
    /// A dimensionless number.
    Number,
}

impl Command {
    fn new(actuator: &ActuatorSpec, written: Shortcut) -> Self {
        use ControlInput::{Position, Velocity};
        let single = [GainKind::Fixed, GainKind::Affine].contains(&actuator.gain);
        match (actuator.inputs.as_deref(), written) {
            _ if !single => Command::Number,
            (Some([Position | Velocity]), _) => Command::Coordinate,
            // A pressure is an input without its own term of the force.
            (Some([]), _) => Command::Pressure,
            (Some(_), _) => Command::Number,
            (None, Shortcut::Position | Shortcut::Velocity | Shortcut::IntVelocity) => {
                Command::Coordinate
            }
            (None, Shortcut::Cylinder) => Command::Pressure,
            (None, _) => Command::Number,
        }
    }

    /// Returns its factor.
    fn scale(self, along: Along) -> f64 {
        match self {
            Command::Coordinate => along.coordinate,
            Command::Pressure => along.pressure,
            Command::Number => 1.0,
        }
    }

    /// Returns its factor for forces.
    fn unit(self, along: Along) -> f64 {
        match self {
            Command::Coordinate => along.unit,
            Command::Pressure => along.pressure,
            Command::Number => 1.0,
        }
    }

    /// Returns the factors of all controls and activations.
    fn states(
        self,
        actuator: &ActuatorSpec,
        written: Shortcut,
        along: Along,
    ) -> Result<States, BuildError> {
        let of_input = |input: &ControlInput| match input {
            ControlInput::Position | ControlInput::Velocity => along.coordinate,
            ControlInput::Feedforward => along.force,
            ControlInput::Command => self.scale(along),
            ControlInput::Voltage | ControlInput::RotationVector | ControlInput::Quaternion => 1.0,
        };
        let activation = match (actuator.dynamics, written) {
            (DynamicsKind::Pid, _) | (_, Shortcut::IntVelocity) => along.coordinate,
            _ => self.scale(along),
        };
        Ok(States {
            controls: actuator.controls()?.iter().map(of_input).collect(),
            activations: vec![activation; actuator.activations()?],
        })
    }
}

fn scale_gain(actuator: &mut ActuatorSpec, command: Command, along: Along) {
    let [first, length, velocity, ..] = &mut actuator.gainprm;
    match actuator.gain {
        GainKind::Fixed => *first *= along.force / command.unit(along),
        GainKind::Affine => {
            *first *= along.force / command.unit(along);
            *length *= along.gain() / command.unit(along);
            *velocity *= along.gain() / command.unit(along);
        }
        GainKind::So3 => *first *= along.turning(),
        GainKind::Pid => *first *= along.gain(),
        GainKind::Muscle => scale_muscle(&mut actuator.gainprm, along.force),
        GainKind::DcMotor | GainKind::User => {}
    }
}

/// Scales the bias. As in MuJoCo, it is unchanged if only one of gain and bias is a muscle's.
fn scale_bias(actuator: &mut ActuatorSpec, along: Along) {
    if (actuator.gain == GainKind::Muscle) != (actuator.bias == BiasKind::Muscle) {
        return;
    }
    let gain = match actuator.bias {
        BiasKind::So3 => along.turning(),
        _ => along.gain(),
    };
    match actuator.bias {
        BiasKind::Affine | BiasKind::So3 => {
            actuator.biasprm[0] *= along.force;
            actuator.biasprm[1] *= gain;
            // A positive value is a damping ratio.
            if actuator.biasprm[2] < 0.0 {
                actuator.biasprm[2] *= gain;
            }
        }
        BiasKind::Muscle => scale_muscle(&mut actuator.biasprm, along.force),
        BiasKind::DcMotor => {
            let [_, poles, _, _, _, stribeck_velocity, ..] = &mut actuator.biasprm;
            *poles /= along.coordinate;
            *stribeck_velocity *= along.coordinate;
        }
        BiasKind::None | BiasKind::User => {}
    }
}

/// Scales the limit of the integral of a position error, and the maximum rate of a setpoint.
fn scale_setpoints(actuator: &mut ActuatorSpec, along: Along) {
    let limits = match (actuator.dynamics, &mut actuator.dynprm) {
        (DynamicsKind::Pid, [integral, rate, ..]) => [integral, rate],
        (DynamicsKind::DcMotor, [.., rate, integral, _]) => [integral, rate],
        _ => return,
    };
    for limit in limits {
        *limit *= along.coordinate;
    }
}

/// Scales the peak force of a muscle; a negative one is derived from its acceleration.
fn scale_muscle(parameters: &mut [f64; 10], force: f64) {
    if parameters[2] >= 0.0 {
        parameters[2] *= force;
    }
}
