//! `<actuator>`: `general` and its shortcuts.
//!
//! A shortcut is an actuator whose law (dynamics, gain, bias) follows from parameters of its own: `kp`, `kv`, `area`.
//! Mechanical attributes (ranges, gear) come from any default of the class. A law comes only from a default that was
//! written with the same shortcut, or with `general` and the shortcut's kind of gain, in the class or its nearest such
//! ancestor (MuJoCo manual, modeling chapter, "Shortcuts"); `general` takes any law as it is.

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
pub(crate) struct Law {
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

impl Default for Law {
    fn default() -> Self {
        Law {
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
    pub law: Law,
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
            law: Law::default(),
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
    /// Whether a shortcut may read its parameters from this default's law.
    pub fn lends_law_to(&self, shortcut: Shortcut) -> bool {
        self.shortcut == shortcut
            || (self.shortcut == Shortcut::General && self.law.gain == shortcut.gain())
    }

    /// Overwrites what the element gives; `inherited` is the law that its class lends to `shortcut`.
    pub fn read(
        &mut self,
        element: &Element,
        shortcut: Shortcut,
        inherited: Law,
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
        let law = match shortcut {
            Shortcut::General => read_general(element, self.law)?,
            Shortcut::Motor => Law::default(),
            Shortcut::Position | Shortcut::IntVelocity => self.read_servo(element, inherited)?,
            Shortcut::Velocity => read_velocity(element, inherited)?,
            Shortcut::Damper => self.read_damper(element, inherited)?,
            Shortcut::Cylinder => read_cylinder(element, inherited)?,
        };
        self.law = law;
        self.settle_inheritrange(element)
    }

    /// `position` and `intvelocity`: force = kp (target − length) − kv velocity.
    fn read_servo(&mut self, element: &Element, inherited: Law) -> Result<Law, LoadError> {
        element.at_most_one(&["kv", "dampratio"])?;
        let mut kp = inherited.gainprm[0];
        element.set_number("kp", &mut kp)?;
        let mut law = Law {
            gainprm: params([kp]),
            bias: BiasKind::Affine,
            biasprm: params([0.0, -kp, inherited.biasprm[2]]),
            inheritrange: inherited.inheritrange,
            ..Law::default()
        };
        if let Some(kv) = not_negative(element, "kv")? {
            law.biasprm[2] = -kv;
        }
        if let Some(dampratio) = not_negative(element, "dampratio")? {
            law.biasprm[2] = dampratio;
        }
        element.set_number("inheritrange", &mut law.inheritrange)?;
        if self.shortcut == Shortcut::IntVelocity {
            law.dynamics = DynamicsKind::Integrator;
            return Ok(law);
        }
        if inherited.dynamics == DynamicsKind::FilterExact {
            (law.dynamics, law.dynprm) = (DynamicsKind::FilterExact, inherited.dynprm);
        }
        if let Some(timeconst) = not_negative(element, "timeconst")? {
            let filters = timeconst > 0.0;
            law.dynamics = if filters {
                DynamicsKind::FilterExact
            } else {
                DynamicsKind::None
            };
            law.dynprm = params([timeconst]);
        }
        Ok(law)
    }

    /// `damper`: force = −kv velocity · control, control limited to positive values.
    fn read_damper(&mut self, element: &Element, inherited: Law) -> Result<Law, LoadError> {
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
        Ok(Law {
            gain: GainKind::Affine,
            gainprm: params([0.0, 0.0, -kv]),
            ..Law::default()
        })
    }

    /// Of an inherited and a written one of `inheritrange` and the range that it stands for, the written one counts.
    fn settle_inheritrange(&mut self, element: &Element) -> Result<(), LoadError> {
        if self.law.inheritrange == 0.0 {
            return Ok(());
        }
        let integrates = self.law.dynamics == DynamicsKind::Integrator;
        let name = if integrates { "actrange" } else { "ctrlrange" };
        match (
            element.text(name).is_some(),
            element.text("inheritrange").is_some(),
        ) {
            (true, true) if self.shortcut != Shortcut::General => {
                return Err(element.error(format!("{name} and inheritrange cannot both be given")));
            }
            (true, false) => self.law.inheritrange = 0.0,
            (_, true) if integrates => self.actrange = [0.0; 2],
            (_, true) => self.ctrlrange = [0.0; 2],
            (false, false) => {}
        }
        Ok(())
    }

    /// The actuator of the model.
    pub fn finish(self, element: &Element) -> Result<ActuatorSpec, LoadError> {
        let mut law = self.law;
        check_actdim(element, &law)?;
        // MuJoCo keeps a damping ratio as a positive velocity coefficient of a position-like law, however written.
        let servo = law.gain == GainKind::Fixed
            && law.bias == BiasKind::Affine
            && law.gainprm[0] == -law.biasprm[1];
        let dampratio = (servo && law.biasprm[2] > 0.0).then_some(law.biasprm[2]);
        if dampratio.is_some() {
            law.biasprm[2] = 0.0;
        }
        Ok(ActuatorSpec {
            name: element.string("name"),
            transmission: read_transmission(element)?,
            dynamics: law.dynamics,
            dynprm: law.dynprm,
            gain: law.gain,
            gainprm: law.gainprm,
            bias: law.bias,
            biasprm: law.biasprm,
            dampratio,
            inheritrange: if servo { law.inheritrange } else { 0.0 },
            gear: self.gear,
            ctrlrange: self.ctrlrange,
            ctrllimited: self.ctrllimited,
            forcerange: self.forcerange,
            forcelimited: self.forcelimited,
            actrange: self.actrange,
            actlimited: self.actlimited,
            actearly: law.actearly,
            group: self.group,
            origin: Some(element.origin.clone()),
        })
    }
}

/// `general`: every parameter of the law by its own attribute.
fn read_general(element: &Element, mut law: Law) -> Result<Law, LoadError> {
    let dynamics = [
        ("none", DynamicsKind::None),
        ("integrator", DynamicsKind::Integrator),
        ("filter", DynamicsKind::Filter),
        ("filterexact", DynamicsKind::FilterExact),
    ];
    supported(element, "dyntype", &["muscle", "dcmotor", "pid", "user"])?;
    element.set_keyword("dyntype", &dynamics, &mut law.dynamics)?;
    let unsupported = ["muscle", "dcmotor", "so3", "pid", "user"];
    supported(element, "gaintype", &unsupported)?;
    let gains = [("fixed", GainKind::Fixed), ("affine", GainKind::Affine)];
    element.set_keyword("gaintype", &gains, &mut law.gain)?;
    supported(element, "biastype", &unsupported)?;
    let biases = [("none", BiasKind::None), ("affine", BiasKind::Affine)];
    element.set_keyword("biastype", &biases, &mut law.bias)?;
    element.overlay("dynprm", &mut law.dynprm)?;
    element.overlay("gainprm", &mut law.gainprm)?;
    element.overlay("biasprm", &mut law.biasprm)?;
    element.set_number("inheritrange", &mut law.inheritrange)?;
    element.set_boolean("actearly", &mut law.actearly)?;
    element.set_integer("actdim", &mut law.actdim)?;
    Ok(law)
}

/// `velocity`: force = kv (target − velocity).
fn read_velocity(element: &Element, inherited: Law) -> Result<Law, LoadError> {
    let mut kv = inherited.gainprm[0];
    element.set_number("kv", &mut kv)?;
    Ok(Law {
        gainprm: params([kv]),
        bias: BiasKind::Affine,
        biasprm: params([0.0, 0.0, -kv]),
        ..Law::default()
    })
}

/// `cylinder`: force = area · filtered pressure + bias.
fn read_cylinder(element: &Element, inherited: Law) -> Result<Law, LoadError> {
    let mut law = Law {
        dynamics: DynamicsKind::Filter,
        dynprm: params([inherited.dynprm[0]]),
        gainprm: params([inherited.gainprm[0]]),
        bias: BiasKind::Affine,
        biasprm: inherited.biasprm,
        ..Law::default()
    };
    element.set_number("timeconst", &mut law.dynprm[0])?;
    element.set_number("area", &mut law.gainprm[0])?;
    if let Some([diameter]) = element.numbers("diameter")?.filter(|[d]| *d >= 0.0) {
        law.gainprm[0] = std::f64::consts::FRAC_PI_4 * diameter * diameter;
    }
    if let Some(bias) = element.numbers::<3>("bias")? {
        law.biasprm[..3].copy_from_slice(&bias);
    }
    Ok(law)
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
fn check_actdim(element: &Element, law: &Law) -> Result<(), LoadError> {
    let has = i32::from(law.dynamics != DynamicsKind::None);
    if law.actdim >= 0 && law.actdim != has {
        let message = format!(
            "actdim is {}, but these dynamics have {has} activations",
            law.actdim
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
