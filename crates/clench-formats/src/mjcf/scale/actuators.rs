//! Actuators: what their controls measure decides what their gains are multiplied by.

use super::{Along, Coordinate, Frames, located};
use crate::LoadError;
use crate::mjcf::shortcut::Shortcut;
use clench_rigid::builder::{ActuatorSpec, ModelBuilder, SensorSubject, TransmissionSpec};
use clench_rigid::model::{BiasKind, ControlInput, DynamicsKind, GainKind, SensorKind};
use std::collections::BTreeMap;

/// By what the control and the activation of an actuator are multiplied.
#[derive(Clone, Copy, Debug)]
pub(super) struct States {
    pub control: f64,
    pub activation: f64,
}

impl Frames {
    /// Scales the actuators, and tells of each what becomes of its control and its activation.
    ///
    /// # Errors
    /// An actuator whose parameters cannot be scaled.
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
            let factor = along.map_or(1.0, |along| match sensor.kind {
                SensorKind::ActuatorPos | SensorKind::ActuatorVel => along.coordinate,
                SensorKind::ActuatorFrc => along.force,
                _ => 1.0,
            });
            sensor.cutoff *= factor;
            sensor.noise *= factor;
        }
        Ok(states)
    }

    /// The scale along what an actuator pulls on; gears that turn where others pull get lengths.
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
        let [x, y, z, turns @ ..] = &mut actuator.gear;
        let pulls = [x, y, z].into_iter().any(|gear| *gear != 0.0);
        match (free, pulls) {
            (true, false) => scale.along(Coordinate::Angle),
            (true, true) => {
                turns.iter_mut().for_each(|gear| *gear *= scale.length);
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
    let pid = actuator.gain == GainKind::Pid || actuator.dynamics == DynamicsKind::Pid;
    if pid && (along.coordinate != 1.0 || along.unit != 1.0) {
        return refuse("a pid along a length in a frame with a scale is not supported yet");
    }
    let is_coordinate = commands_coordinate(actuator, written);
    let control = if is_coordinate { along.coordinate } else { 1.0 };
    let activation = match is_coordinate || written == Shortcut::IntVelocity {
        true => along.coordinate,
        false => 1.0,
    };
    scale_parameters(actuator, written, is_coordinate, along);
    actuator.ctrlrange = actuator.ctrlrange.map(|end| end * control);
    actuator.actrange = actuator.actrange.map(|end| end * activation);
    actuator.forcerange = actuator.forcerange.map(|end| end * along.force);
    actuator.lengthrange = actuator.lengthrange.map(|end| end * along.coordinate);
    actuator.armature *= along.gain();
    along.polynomial(&mut actuator.damping);
    Ok(States {
        control,
        activation,
    })
}

/// Whether the control is a position or velocity of what the actuator pulls on.
fn commands_coordinate(actuator: &ActuatorSpec, written: Shortcut) -> bool {
    match written {
        Shortcut::Position | Shortcut::Velocity | Shortcut::IntVelocity => true,
        _ => matches!(
            actuator.inputs.as_deref(),
            Some([ControlInput::Position | ControlInput::Velocity])
        ),
    }
}

fn scale_parameters(
    actuator: &mut ActuatorSpec,
    written: Shortcut,
    is_coordinate: bool,
    along: Along,
) {
    let (force, gain) = (along.force, along.gain());
    match (actuator.gain, written) {
        (GainKind::Fixed, Shortcut::Cylinder) => {
            // Its control is a pressure, so that the gain is an area, or a volume for a torque.
            actuator.gainprm[0] *= force / along.pressure;
        }
        (GainKind::Fixed, _) => {
            actuator.gainprm[0] *= if is_coordinate { gain } else { force };
        }
        (GainKind::Affine, _) => {
            actuator.gainprm[0] *= if is_coordinate { gain } else { force };
            actuator.gainprm[1] *= gain;
            actuator.gainprm[2] *= gain;
        }
        (GainKind::So3 | GainKind::Pid, _) => actuator.gainprm[0] *= gain,
        (GainKind::Muscle, _) => scale_muscle(&mut actuator.gainprm, force),
        (GainKind::DcMotor | GainKind::User, _) => {}
    }
    match actuator.bias {
        BiasKind::Affine | BiasKind::So3 => {
            actuator.biasprm[0] *= force;
            actuator.biasprm[1] *= gain;
            // Above zero it is a damping ratio.
            if actuator.biasprm[2] < 0.0 {
                actuator.biasprm[2] *= gain;
            }
        }
        BiasKind::Muscle => scale_muscle(&mut actuator.biasprm, force),
        BiasKind::None | BiasKind::DcMotor | BiasKind::User => {}
    }
}

/// The peak force of a muscle; a negative one stands for what follows from its acceleration.
fn scale_muscle(parameters: &mut [f64; 10], force: f64) {
    if parameters[2] >= 0.0 {
        parameters[2] *= force;
    }
}
