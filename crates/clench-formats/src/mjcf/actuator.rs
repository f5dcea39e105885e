//! `<actuator>`: `general` and its shortcuts.
//!
//! A shortcut is an actuator whose dynamics, gain and bias follow from parameters of its own: `kp`, `kv`, `area`.
//! Mechanical attributes (ranges, gear) come from any default of the class. Dynamics, gain and bias come only from a default that was
//! written with the same shortcut, or with `general` and the shortcut's kind of gain, in the class or its nearest such
//! ancestor (MuJoCo manual, modeling chapter, "Shortcuts"); `general` takes any as they are.

use super::document::Element;
use crate::LoadError;
use clench_rigid::builder::{ActuatorSpec, TransmissionSpec};
use clench_rigid::model::{BiasKind, DynamicsKind, GainKind};

/// Which element an actuator is written with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Shortcut {
    #[default]
    General,
    Motor,
    Position,
    Velocity,
    IntVelocity,
    Damper,
    Cylinder,
}

impl Shortcut {
    /// The shortcut of an element name.
    pub fn from_tag(tag: &str) -> Option<Shortcut> {
        Some(match tag {
            "general" => Shortcut::General,
            "motor" => Shortcut::Motor,
            "position" => Shortcut::Position,
            "velocity" => Shortcut::Velocity,
            "intvelocity" => Shortcut::IntVelocity,
            "damper" => Shortcut::Damper,
            "cylinder" => Shortcut::Cylinder,
            _ => return None,
        })
    }

    fn gain(self) -> GainKind {
        match self {
            Shortcut::Damper => GainKind::Affine,
            _ => GainKind::Fixed,
        }
    }
}

/// How control becomes force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorParams {
    dynamics: DynamicsKind,
    dynprm: [f64; 10],
    gain: GainKind,
    gainprm: [f64; 10],
    bias: BiasKind,
    biasprm: [f64; 10],
    inheritrange: f64,
    actearly: bool,
    actdim: i32,
}

/// Leading entries, then zeros.
fn params<const N: usize>(leading: [f64; N]) -> [f64; 10] {
    let mut all = [0.0; 10];
    all[..N].copy_from_slice(&leading);
    all
}

impl Default for ActuatorParams {
    fn default() -> Self {
        ActuatorParams {
            dynamics: DynamicsKind::None,
            dynprm: params([1.0]),
            gain: GainKind::Fixed,
            gainprm: params([1.0]),
            bias: BiasKind::None,
            biasprm: [0.0; 10],
            inheritrange: 0.0,
            actearly: false,
            actdim: -1,
        }
    }
}

/// An actuator as it is written, or as a default class has it.
#[derive(Clone, Debug)]
pub(crate) struct ActuatorDraft {
    pub shortcut: Shortcut,
    pub parameters: ActuatorParams,
    gear: [f64; 6],
    ctrlrange: [f64; 2],
    ctrllimited: Option<bool>,
    forcerange: [f64; 2],
    forcelimited: Option<bool>,
    actrange: [f64; 2],
    actlimited: Option<bool>,
    group: i32,
}

impl Default for ActuatorDraft {
    fn default() -> Self {
        ActuatorDraft {
            shortcut: Shortcut::General,
            parameters: ActuatorParams::default(),
            gear: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ctrlrange: [0.0; 2],
            ctrllimited: None,
            forcerange: [0.0; 2],
            forcelimited: None,
            actrange: [0.0; 2],
            actlimited: None,
            group: 0,
        }
    }
}

impl ActuatorDraft {
    /// Whether a shortcut may read its parameters from this default.
    pub fn lends_parameters_to(&self, shortcut: Shortcut) -> bool {
        self.shortcut == shortcut
            || (self.shortcut == Shortcut::General && self.parameters.gain == shortcut.gain())
    }

    /// Overwrites what the element gives; `inherited` are the parameters that its class lends to `shortcut`.
    pub fn read(
        &mut self,
        element: &Element,
        shortcut: Shortcut,
        inherited: ActuatorParams,
    ) -> Result<(), LoadError> {
        self.shortcut = shortcut;
        element.set_range("ctrlrange", &mut self.ctrlrange)?;
        element.set_tristate("ctrllimited", &mut self.ctrllimited)?;
        element.set_range("forcerange", &mut self.forcerange)?;
        element.set_tristate("forcelimited", &mut self.forcelimited)?;
        element.set_range("actrange", &mut self.actrange)?;
        element.set_tristate("actlimited", &mut self.actlimited)?;
        element.overlay("gear", &mut self.gear)?;
        element.set_integer("group", &mut self.group)?;
        let parameters = match shortcut {
            Shortcut::General => read_general(element, self.parameters)?,
            Shortcut::Motor => ActuatorParams::default(),
            Shortcut::Position | Shortcut::IntVelocity => self.read_servo(element, inherited)?,
            Shortcut::Velocity => read_velocity(element, inherited)?,
            Shortcut::Damper => self.read_damper(element, inherited)?,
            Shortcut::Cylinder => read_cylinder(element, inherited)?,
        };
        self.parameters = parameters;
        self.settle_inheritrange(element)
    }

    /// `position` and `intvelocity`: force = kp (target − length) − kv velocity.
    fn read_servo(
        &mut self,
        element: &Element,
        inherited: ActuatorParams,
    ) -> Result<ActuatorParams, LoadError> {
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
        if self.shortcut == Shortcut::IntVelocity {
            parameters.dynamics = DynamicsKind::Integrator;
            // As in MuJoCo, whatever the file says of it: an activation range limits if there is one.
            self.actlimited = None;
            return Ok(parameters);
        }
        if inherited.dynamics == DynamicsKind::FilterExact {
            (parameters.dynamics, parameters.dynprm) =
                (DynamicsKind::FilterExact, inherited.dynprm);
        }
        if let Some(timeconst) = not_negative(element, "timeconst")? {
            let filters = timeconst > 0.0;
            parameters.dynamics = if filters {
                DynamicsKind::FilterExact
            } else {
                DynamicsKind::None
            };
            parameters.dynprm = params([timeconst]);
        }
        Ok(parameters)
    }

    /// `damper`: force = −kv velocity · control, control limited to positive values.
    fn read_damper(
        &mut self,
        element: &Element,
        inherited: ActuatorParams,
    ) -> Result<ActuatorParams, LoadError> {
        let mut kv = match inherited.gain {
            GainKind::Affine => -inherited.gainprm[2],
            GainKind::Fixed => 0.0,
        };
        element.set_number("kv", &mut kv)?;
        if kv < 0.0 {
            return Err(element.error("kv cannot be negative"));
        }
        if self.ctrlrange.iter().any(|&end| end < 0.0) {
            return Err(element.error("the ctrlrange of a damper cannot be negative"));
        }
        self.ctrllimited = Some(true);
        Ok(ActuatorParams {
            gain: GainKind::Affine,
            gainprm: params([0.0, 0.0, -kv]),
            ..ActuatorParams::default()
        })
    }

    /// Of an inherited and a written one of `inheritrange` and the range that it stands for, the written one counts.
    fn settle_inheritrange(&mut self, element: &Element) -> Result<(), LoadError> {
        if self.parameters.inheritrange == 0.0 {
            return Ok(());
        }
        let integrates = self.parameters.dynamics == DynamicsKind::Integrator;
        let name = if integrates { "actrange" } else { "ctrlrange" };
        match (
            element.text(name).is_some(),
            element.text("inheritrange").is_some(),
        ) {
            (true, true) if self.shortcut != Shortcut::General => {
                return Err(element.error(format!("{name} and inheritrange cannot both be given")));
            }
            (true, false) => self.parameters.inheritrange = 0.0,
            (_, true) if integrates => self.actrange = [0.0; 2],
            (_, true) => self.ctrlrange = [0.0; 2],
            (false, false) => {}
        }
        Ok(())
    }

    /// The actuator of the model.
    pub fn finish(self, element: &Element) -> Result<ActuatorSpec, LoadError> {
        let mut parameters = self.parameters;
        check_actdim(element, &parameters)?;
        // MuJoCo keeps a damping ratio as a positive velocity coefficient of a position-like actuator, however written.
        let servo = parameters.gain == GainKind::Fixed
            && parameters.bias == BiasKind::Affine
            && parameters.gainprm[0] == -parameters.biasprm[1];
        let dampratio = (servo && parameters.biasprm[2] > 0.0).then_some(parameters.biasprm[2]);
        if dampratio.is_some() {
            parameters.biasprm[2] = 0.0;
        }
        Ok(ActuatorSpec {
            name: element.string("name"),
            transmission: read_transmission(element)?,
            dynamics: parameters.dynamics,
            dynprm: parameters.dynprm,
            gain: parameters.gain,
            gainprm: parameters.gainprm,
            bias: parameters.bias,
            biasprm: parameters.biasprm,
            dampratio,
            inheritrange: if servo { parameters.inheritrange } else { 0.0 },
            gear: self.gear,
            ctrlrange: self.ctrlrange,
            ctrllimited: self.ctrllimited,
            forcerange: self.forcerange,
            forcelimited: self.forcelimited,
            actrange: self.actrange,
            actlimited: self.actlimited,
            actearly: parameters.actearly,
            group: self.group,
            origin: Some(element.origin.clone()),
        })
    }
}

/// `general`: every parameter by its own attribute.
fn read_general(
    element: &Element,
    mut parameters: ActuatorParams,
) -> Result<ActuatorParams, LoadError> {
    let dynamics = [
        ("none", DynamicsKind::None),
        ("integrator", DynamicsKind::Integrator),
        ("filter", DynamicsKind::Filter),
        ("filterexact", DynamicsKind::FilterExact),
    ];
    supported(element, "dyntype", &["muscle", "dcmotor", "pid", "user"])?;
    element.set_keyword("dyntype", &dynamics, &mut parameters.dynamics)?;
    let unsupported = ["muscle", "dcmotor", "so3", "pid", "user"];
    supported(element, "gaintype", &unsupported)?;
    let gains = [("fixed", GainKind::Fixed), ("affine", GainKind::Affine)];
    element.set_keyword("gaintype", &gains, &mut parameters.gain)?;
    supported(element, "biastype", &unsupported)?;
    let biases = [("none", BiasKind::None), ("affine", BiasKind::Affine)];
    element.set_keyword("biastype", &biases, &mut parameters.bias)?;
    element.overlay("dynprm", &mut parameters.dynprm)?;
    element.overlay("gainprm", &mut parameters.gainprm)?;
    element.overlay("biasprm", &mut parameters.biasprm)?;
    element.set_number("inheritrange", &mut parameters.inheritrange)?;
    element.set_boolean("actearly", &mut parameters.actearly)?;
    element.set_integer("actdim", &mut parameters.actdim)?;
    Ok(parameters)
}

/// `velocity`: force = kv (target − velocity).
fn read_velocity(
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

/// `cylinder`: force = area · filtered pressure + bias.
fn read_cylinder(
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

fn supported(element: &Element, name: &str, unsupported: &[&str]) -> Result<(), LoadError> {
    match element.text(name) {
        Some(value) if unsupported.contains(&value) => {
            Err(element.error(format!("{name}=\"{value}\" is not supported yet")))
        }
        _ => Ok(()),
    }
}

fn not_negative(element: &Element, name: &str) -> Result<Option<f64>, LoadError> {
    match element.numbers(name)? {
        Some([value]) if value < 0.0 => Err(element.error(format!("{name} cannot be negative"))),
        value => Ok(value.map(|[value]| value)),
    }
}

/// The number of activations must be what the dynamics has.
fn check_actdim(element: &Element, parameters: &ActuatorParams) -> Result<(), LoadError> {
    let has = i32::from(parameters.dynamics != DynamicsKind::None);
    if parameters.actdim >= 0 && parameters.actdim != has {
        let message = format!(
            "actdim is {}, but these dynamics have {has} activations",
            parameters.actdim
        );
        return Err(element.error(message));
    }
    Ok(())
}

fn read_transmission(element: &Element) -> Result<TransmissionSpec, LoadError> {
    element.at_most_one(&["joint", "jointinparent", "tendon"])?;
    let name = |attribute| element.text(attribute).map(str::to_owned);
    name("joint")
        .map(TransmissionSpec::Joint)
        .or_else(|| name("jointinparent").map(TransmissionSpec::JointInParent))
        .or_else(|| name("tendon").map(TransmissionSpec::Tendon))
        .ok_or_else(|| element.error("one of joint, jointinparent or tendon is required"))
}
