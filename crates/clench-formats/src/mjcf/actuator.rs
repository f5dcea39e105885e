//! `<actuator>`: `general` and its shortcuts.
//!
//! Mechanical attributes (ranges, gear) come from any default of the class. Dynamics, gain and bias come only from a
//! default that was written with the same shortcut, or with `general` and the shortcut's kind of gain, in the class or
//! its nearest such ancestor (MuJoCo manual, modeling chapter, "Shortcuts"); `general` inherits from any default.

use super::controller::{self, Saturation};
use super::inputs;
use super::shortcut::{self, ActuatorParams, Shortcut};
use super::transmission;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{ActuatorSpec, HistorySpec, TransmissionSpec};
use clench_dynamics::model::{BiasKind, DynamicsKind, GainKind, Interpolation};

/// Overwrites the history settings that the element gives; a negative number of samples is none, as in MuJoCo.
pub(crate) fn read_history(element: &Element, history: &mut HistorySpec) -> Result<(), LoadError> {
    if let Some(samples) = element.integer("nsample")? {
        history.nsample = usize::try_from(samples).unwrap_or(0);
    }
    let ways = [
        ("zoh", Interpolation::Hold),
        ("linear", Interpolation::Linear),
        ("cubic", Interpolation::Cubic),
    ];
    element.set_keyword("interp", &ways, &mut history.interp)?;
    element.set_number("delay", &mut history.delay)
}

/// An actuator as written in an element or a default class.
#[derive(Clone, Debug)]
pub(crate) struct ActuatorDraft {
    pub shortcut: Shortcut,
    pub parameters: ActuatorParams,
    /// All other attributes that a default class can set.
    spec: ActuatorSpec,
}

impl Default for ActuatorDraft {
    fn default() -> Self {
        ActuatorDraft {
            shortcut: Shortcut::General,
            parameters: ActuatorParams::default(),
            spec: ActuatorSpec::general("", TransmissionSpec::Joint(String::new())),
        }
    }
}

impl ActuatorDraft {
    /// Returns true if a shortcut may inherit its parameters from this default.
    pub(super) fn lends_parameters_to(&self, shortcut: Shortcut) -> bool {
        self.shortcut == shortcut
            || (self.shortcut == Shortcut::General && self.parameters.gain == shortcut.gain())
    }

    /// Overwrites the values that the element has; `inherited` are the parameters that `shortcut` inherits from its
    /// class.
    pub(super) fn read(
        &mut self,
        element: &Element,
        shortcut: Shortcut,
        inherited: ActuatorParams,
    ) -> Result<(), LoadError> {
        self.shortcut = shortcut;
        let spec = &mut self.spec;
        element.set_range("ctrlrange", &mut spec.ctrlrange)?;
        element.set_tristate("ctrllimited", &mut spec.ctrllimited)?;
        element.set_range("forcerange", &mut spec.forcerange)?;
        element.set_tristate("forcelimited", &mut spec.forcelimited)?;
        element.set_range("actrange", &mut spec.actrange)?;
        element.set_tristate("actlimited", &mut spec.actlimited)?;
        element.overlay("gear", &mut spec.gear)?;
        read_history(element, &mut spec.history)?;
        element.overlay("damping", &mut spec.damping)?;
        element.set_number("armature", &mut spec.armature)?;
        element.set_number("cranklength", &mut spec.cranklength)?;
        element.set_integer("group", &mut spec.group)?;
        element.set_user(&mut spec.user)?;
        if matches!(shortcut, Shortcut::General | Shortcut::Pid) {
            element.set_range("posrange", &mut spec.ctrlrange)?;
            element.set_range("velrange", &mut spec.velrange)?;
            element.set_range("ffrange", &mut spec.ffrange)?;
        }
        let parameters = match shortcut {
            Shortcut::General => read_general(element, self.parameters)?,
            Shortcut::Motor => ActuatorParams::default(),
            Shortcut::Position => shortcut::read_position(element, inherited)?,
            Shortcut::IntVelocity => shortcut::read_intvelocity(element, inherited)?,
            Shortcut::Orientation => shortcut::read_orientation(element, inherited)?,
            Shortcut::Velocity => shortcut::read_velocity(element, inherited)?,
            Shortcut::Damper => shortcut::read_damper(element, inherited)?,
            Shortcut::Cylinder => shortcut::read_cylinder(element, inherited)?,
            Shortcut::Muscle => shortcut::read_muscle(element, inherited)?,
            Shortcut::Pid => controller::read_pid(element, inherited)?,
            Shortcut::DcMotor => self.read_dc_motor(element, inherited)?,
            Shortcut::Adhesion => shortcut::read_adhesion(element, inherited)?,
        };
        self.parameters = match shortcut {
            // It overwrites the parameters of its class individually.
            Shortcut::General => ActuatorParams {
                saturation: (parameters.saturation)
                    .map(|_| (self.spec.forcerange, self.spec.forcelimited)),
                ..parameters
            },
            _ => ActuatorParams {
                shortcut,
                ..parameters
            },
        };
        match shortcut {
            Shortcut::Damper | Shortcut::Adhesion => self.require_positive_controls(element)?,
            _ => {}
        }
        self.spec.actlimited = match shortcut {
            Shortcut::General => self.spec.actlimited,
            // Its activations are of several kinds, which no range limits.
            Shortcut::DcMotor => Some(false),
            // As in MuJoCo, the attribute is ignored: an activation range limits if there is one.
            _ => None,
        };
        self.resolve_inheritrange(element)
    }

    /// Reads `dcmotor`: its saturation is a force limit, inherited with the other parameters. It takes precedence over
    /// other limits of the class.
    fn read_dc_motor(
        &mut self,
        element: &Element,
        inherited: ActuatorParams,
    ) -> Result<ActuatorParams, LoadError> {
        let damping = self.spec.damping[0];
        let (mut parameters, saturation) = controller::read_dc_motor(element, inherited, damping)?;
        parameters.saturation = match saturation {
            Saturation::Inherited => inherited.saturation,
            Saturation::None => {
                (self.spec.forcerange, self.spec.forcelimited) = ([0.0; 2], None);
                None
            }
            Saturation::Torque(torque) => Some(([-torque, torque], Some(true))),
        };
        if let Some(limit) = parameters.saturation {
            (self.spec.forcerange, self.spec.forcelimited) = limit;
        }
        Ok(parameters)
    }

    /// Limits dampers and adhesions to nonnegative controls.
    fn require_positive_controls(&mut self, element: &Element) -> Result<(), LoadError> {
        if self.spec.ctrlrange.iter().any(|&end| end < 0.0) {
            return Err(element.error(format!(
                "the ctrlrange of <{}> cannot be negative",
                element.tag
            )));
        }
        self.spec.ctrllimited = Some(true);
        Ok(())
    }

    /// Resolves a conflict of a shortcut's `inheritrange` with the range that it sets: one written in the element
    /// overrides an inherited one. A `general` keeps both, as in MuJoCo: its own range counts unless it is a servo.
    fn resolve_inheritrange(&mut self, element: &Element) -> Result<(), LoadError> {
        if self.parameters.inheritrange == 0.0 || self.shortcut == Shortcut::General {
            return Ok(());
        }
        let integrates = self.parameters.dynamics == DynamicsKind::Integrator;
        let (name, range) = match integrates {
            true => ("actrange", &mut self.spec.actrange),
            false => ("ctrlrange", &mut self.spec.ctrlrange),
        };
        let of_position = self.shortcut == Shortcut::Pid && element.text("posrange").is_some();
        match (
            element.text(name).is_some() || of_position,
            element.text("inheritrange").is_some(),
        ) {
            (true, false) => self.parameters.inheritrange = 0.0,
            (false, true) => *range = [0.0; 2],
            // A class with `general` may give both.
            (both, _) if both || *range != [0.0; 2] => {
                return Err(element.error(format!("{name} and inheritrange cannot both be given")));
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the actuator of the model.
    pub(super) fn finish(self, element: &Element) -> Result<ActuatorSpec, LoadError> {
        let mut parameters = self.parameters;
        if let Some(inputs) = parameters.inputs {
            inputs.check(parameters.gain, element)?;
        }
        let mut lengthrange = [0.0; 2];
        element.set_range("lengthrange", &mut lengthrange)?;
        // MuJoCo stores a damping ratio as a positive velocity coefficient of a restoring bias, however it is written.
        let pulls_back =
            (parameters.bias).pulls_back(parameters.gain, &parameters.gainprm, &parameters.biasprm);
        let dampratio =
            (pulls_back && parameters.biasprm[2] > 0.0).then_some(parameters.biasprm[2]);
        let servo = pulls_back && matches!(parameters.gain, GainKind::Fixed | GainKind::Pid);
        if dampratio.is_some() {
            parameters.biasprm[2] = 0.0;
        }
        // A PID controller has the activations that it needs even if its class says that there are none.
        let counts = parameters.dynamics != DynamicsKind::Pid || parameters.actdim > 0;
        Ok(ActuatorSpec {
            name: element.string("name"),
            transmission: transmission::read(element)?,
            dynamics: parameters.dynamics,
            dynprm: parameters.dynprm,
            gain: parameters.gain,
            gainprm: parameters.gainprm,
            bias: parameters.bias,
            biasprm: parameters.biasprm,
            dampratio,
            inheritrange: if servo { parameters.inheritrange } else { 0.0 },
            lengthrange,
            inputs: parameters.inputs.map(|inputs| inputs.controls()),
            actdim: usize::try_from(parameters.actdim).ok().filter(|_| counts),
            actearly: parameters.actearly,
            origin: Some(element.origin.clone()),
            ..self.spec
        })
    }
}

/// Returns each kind with its keyword.
fn keywords<K: Copy>(all: &[K], name: fn(K) -> &'static str) -> Vec<(&'static str, K)> {
    all.iter().map(|&kind| (name(kind), kind)).collect()
}

/// Reads `general`: each parameter from its own attribute.
fn read_general(
    element: &Element,
    mut parameters: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let dynamics = keywords(DynamicsKind::ALL, DynamicsKind::name);
    element.set_keyword("dyntype", &dynamics, &mut parameters.dynamics)?;
    let gains = keywords(GainKind::ALL, GainKind::name);
    let inherited = parameters.gain;
    element.set_keyword("gaintype", &gains, &mut parameters.gain)?;
    if parameters.gain != inherited {
        parameters.inputs = None;
    }
    inputs::read_inputs(element, &mut parameters.inputs)?;
    let biases = keywords(BiasKind::ALL, BiasKind::name);
    element.set_keyword("biastype", &biases, &mut parameters.bias)?;
    element.overlay("dynprm", &mut parameters.dynprm)?;
    element.overlay("gainprm", &mut parameters.gainprm)?;
    element.overlay("biasprm", &mut parameters.biasprm)?;
    element.set_number("inheritrange", &mut parameters.inheritrange)?;
    element.set_boolean("actearly", &mut parameters.actearly)?;
    element.set_integer("actdim", &mut parameters.actdim)?;
    Ok(parameters)
}
