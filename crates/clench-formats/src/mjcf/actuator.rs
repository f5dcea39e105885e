//! `<actuator>`: `general` and its shortcuts.
//!
//! Mechanical attributes (ranges, gear) come from any default of the class. Dynamics, gain and bias come only from a default that was
//! written with the same shortcut, or with `general` and the shortcut's kind of gain, in the class or its nearest such
//! ancestor (MuJoCo manual, modeling chapter, "Shortcuts"); `general` takes any as they are.

use super::document::Element;
use super::shortcut::{self, ActuatorParams, Shortcut};
use crate::LoadError;
use clench_rigid::builder::{ActuatorSpec, TransmissionSpec};
use clench_rigid::model::{BiasKind, DynamicsKind, GainKind};

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
            Shortcut::Position => shortcut::read_position(element, inherited)?,
            Shortcut::IntVelocity => shortcut::read_intvelocity(element, inherited)?,
            Shortcut::Velocity => shortcut::read_velocity(element, inherited)?,
            Shortcut::Damper => shortcut::read_damper(element, inherited)?,
            Shortcut::Cylinder => shortcut::read_cylinder(element, inherited)?,
            Shortcut::Muscle => shortcut::read_muscle(element, inherited)?,
        };
        self.parameters = parameters;
        match shortcut {
            // As in MuJoCo, whatever the file says of it: an activation range limits if there is one.
            Shortcut::IntVelocity => self.actlimited = None,
            Shortcut::Damper => self.require_positive_controls(element)?,
            _ => {}
        }
        self.settle_inheritrange(element)
    }

    /// A damper is limited to positive controls.
    fn require_positive_controls(&mut self, element: &Element) -> Result<(), LoadError> {
        if self.ctrlrange.iter().any(|&end| end < 0.0) {
            return Err(element.error("the ctrlrange of a damper cannot be negative"));
        }
        self.ctrllimited = Some(true);
        Ok(())
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
        let mut lengthrange = [0.0; 2];
        element.set_range("lengthrange", &mut lengthrange)?;
        // MuJoCo keeps a damping ratio as a positive velocity coefficient of what pulls back, however written.
        let pulls_back =
            parameters.bias == BiasKind::Affine && parameters.gainprm[0] == -parameters.biasprm[1];
        let dampratio =
            (pulls_back && parameters.biasprm[2] > 0.0).then_some(parameters.biasprm[2]);
        let servo = pulls_back && parameters.gain == GainKind::Fixed;
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
            lengthrange,
            ctrlrange: self.ctrlrange,
            ctrllimited: self.ctrllimited,
            forcerange: self.forcerange,
            forcelimited: self.forcelimited,
            actrange: self.actrange,
            actlimited: self.actlimited,
            actdim: usize::try_from(parameters.actdim).ok(),
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
        ("muscle", DynamicsKind::Muscle),
        ("user", DynamicsKind::User),
    ];
    supported(element, "dyntype", &["dcmotor", "pid"])?;
    element.set_keyword("dyntype", &dynamics, &mut parameters.dynamics)?;
    supported(element, "gaintype", &["dcmotor", "so3", "pid"])?;
    let gains = [
        ("fixed", GainKind::Fixed),
        ("affine", GainKind::Affine),
        ("muscle", GainKind::Muscle),
        ("user", GainKind::User),
    ];
    element.set_keyword("gaintype", &gains, &mut parameters.gain)?;
    supported(element, "biastype", &["dcmotor", "so3"])?;
    let biases = [
        ("none", BiasKind::None),
        ("affine", BiasKind::Affine),
        ("muscle", BiasKind::Muscle),
        ("user", BiasKind::User),
    ];
    element.set_keyword("biastype", &biases, &mut parameters.bias)?;
    element.overlay("dynprm", &mut parameters.dynprm)?;
    element.overlay("gainprm", &mut parameters.gainprm)?;
    element.overlay("biasprm", &mut parameters.biasprm)?;
    element.set_number("inheritrange", &mut parameters.inheritrange)?;
    element.set_boolean("actearly", &mut parameters.actearly)?;
    element.set_integer("actdim", &mut parameters.actdim)?;
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

fn read_transmission(element: &Element) -> Result<TransmissionSpec, LoadError> {
    element.at_most_one(&["joint", "jointinparent", "tendon"])?;
    let name = |attribute| element.text(attribute).map(str::to_owned);
    name("joint")
        .map(TransmissionSpec::Joint)
        .or_else(|| name("jointinparent").map(TransmissionSpec::JointInParent))
        .or_else(|| name("tendon").map(TransmissionSpec::Tendon))
        .ok_or_else(|| element.error("one of joint, jointinparent or tendon is required"))
}
