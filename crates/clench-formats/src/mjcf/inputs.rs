//! `input`: what the controls of an actuator are.

use super::document::Element;
use crate::LoadError;
use clench_rigid::model::{ControlInput, GainKind};

/// The inputs that an actuator names, in the order in which they must be named.
const INPUTS: [(&str, &[ControlInput]); 7] = [
    ("pos", &[ControlInput::Position]),
    ("vel", &[ControlInput::Velocity]),
    ("ff", &[ControlInput::Feedforward]),
    ("voltage", &[ControlInput::Voltage]),
    ("pressure", &[]),
    ("expmap", &[ControlInput::RotationVector; 3]),
    ("quat", &[ControlInput::Quaternion; 4]),
];

/// The first of them that is a way to write an orientation.
const ROTATIONS: u8 = 5;

fn names() -> String {
    INPUTS.map(|(name, _)| name).join(", ")
}

/// Some of [`INPUTS`], one a bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inputs(u8);

impl Inputs {
    /// What controls they are.
    pub(super) fn controls(self) -> Vec<ControlInput> {
        let named = |k: &usize| self.0 & (1 << k) != 0;
        (0..INPUTS.len())
            .filter(named)
            .flat_map(|k| INPUTS[k].1)
            .copied()
            .collect()
    }
}

/// Overwrites the inputs if the element names them. Of an actuator whose control is scaled by its gain they only say what it is.
pub(crate) fn read_inputs(
    element: &Element,
    gain: GainKind,
    inputs: &mut Option<Inputs>,
) -> Result<(), LoadError> {
    let Some(text) = element.text("input") else {
        return Ok(());
    };
    let mut found = Inputs(0);
    for word in text.split_ascii_whitespace().filter(|_| text != "none") {
        let place = INPUTS.iter().position(|(name, _)| *name == word);
        let Some(place) = place else {
            return Err(element.error(format!("input has \"{word}\", not one of {}", names())));
        };
        if found.0 >> place != 0 {
            return Err(element.error(format!("input must name {} in this order", names())));
        }
        found.0 |= 1 << place;
    }
    let given = !text.trim().is_empty();
    let possible = match gain {
        _ if !given => true,
        GainKind::Fixed | GainKind::Affine => ["pos", "vel", "pressure"].contains(&text.trim()),
        GainKind::So3 => ["expmap", "quat"].contains(&text.trim()),
        _ if found.0 >= 1 << ROTATIONS => false,
        GainKind::Muscle | GainKind::User => false,
        GainKind::Pid => found.0 != 0,
        GainKind::DcMotor => found.0 != 0 || text == "none",
    };
    if !possible {
        return Err(element.error(format!("input \"{text}\" does not go with this gain")));
    }
    *inputs = given.then_some(found);
    Ok(())
}
