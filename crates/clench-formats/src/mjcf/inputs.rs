//! `input`: the meaning of an actuator's controls.

use crate::document::Element;
use crate::error::LoadError;
use clench_dynamics::model::{ControlInput, GainKind};

/// The inputs that an actuator can name, in the required order.
const INPUTS: [(&str, &[ControlInput]); 7] = [
    ("pos", &[ControlInput::Position]),
    ("vel", &[ControlInput::Velocity]),
    ("ff", &[ControlInput::Feedforward]),
    ("voltage", &[ControlInput::Voltage]),
    ("pressure", &[]),
    ("expmap", &[ControlInput::RotationVector; 3]),
    ("quat", &[ControlInput::Quaternion; 4]),
];

/// The index of the first input that represents an orientation.
const ROTATIONS: u8 = 5;

fn names() -> String {
    INPUTS.map(|(name, _)| name).join(", ")
}

/// A set of [`INPUTS`], one per bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inputs(u8);

impl Inputs {
    /// Returns their controls.
    pub(super) fn controls(self) -> Vec<ControlInput> {
        let named = |k: &usize| self.0 & (1 << k) != 0;
        (0..INPUTS.len())
            .filter(named)
            .flat_map(|k| INPUTS[k].1)
            .copied()
            .collect()
    }

    /// Rejects inputs that an actuator with this gain cannot have. A default class may name any, since it may have no
    /// actuators.
    pub(super) fn check(self, gain: GainKind, element: &Element) -> Result<(), LoadError> {
        let single = self
            .0
            .is_power_of_two()
            .then(|| INPUTS[self.0.trailing_zeros() as usize].0);
        let is = |names: &[&str]| single.is_some_and(|name| names.contains(&name));
        let possible = match gain {
            GainKind::Fixed | GainKind::Affine => is(&["pos", "vel", "pressure"]),
            GainKind::So3 => is(&["expmap", "quat"]),
            GainKind::Muscle | GainKind::User => false,
            GainKind::Pid => self.0 != 0 && self.0 < 1 << ROTATIONS,
            GainKind::DcMotor => self.0 < 1 << ROTATIONS,
        };
        match possible {
            true => Ok(()),
            false => {
                let named = |k: &usize| self.0 & (1 << k) != 0;
                let named: Vec<&str> = (0..INPUTS.len())
                    .filter(named)
                    .map(|k| INPUTS[k].0)
                    .collect();
                let text = if named.is_empty() {
                    "none".to_owned()
                } else {
                    named.join(" ")
                };
                Err(element.error(format!("input \"{text}\" is incompatible with this gain")))
            }
        }
    }
}

/// Overwrites the inputs if the element names them. For an actuator whose gain scales its control they are only
/// descriptive.
pub(crate) fn read_inputs(element: &Element, inputs: &mut Option<Inputs>) -> Result<(), LoadError> {
    let Some(text) = element.text("input") else {
        return Ok(());
    };
    let mut found = Inputs(0);
    for word in text.split_ascii_whitespace().filter(|_| text != "none") {
        let index = INPUTS.iter().position(|(name, _)| *name == word);
        let Some(index) = index else {
            return Err(element.error(format!("input has \"{word}\", not one of {}", names())));
        };
        if found.0 >> index != 0 {
            return Err(element.error(format!("input must name {} in this order", names())));
        }
        found.0 |= 1 << index;
    }
    let is_present = !text.trim().is_empty();
    *inputs = is_present.then_some(found);
    Ok(())
}
