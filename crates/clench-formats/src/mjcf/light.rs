//! `<light>` and the headlight: used only by viewers.

use super::camera::{Mode, tracking};
use super::orientation::Pose;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::LightSpec;
use clench_dynamics::model::{Headlight, LightKind, LightProperties};
use clench_math::{Quat, Vec3};

/// A light as written in an element or a default class.
#[derive(Clone, Debug)]
pub(crate) struct LightDraft {
    mode: Mode,
    pos: [f64; 3],
    dir: [f64; 3],
    /// `None` for an image-based light, which is not drawn.
    kind: Option<LightKind>,
    properties: LightProperties,
}

impl Default for LightDraft {
    fn default() -> Self {
        LightDraft {
            mode: Mode::Fixed,
            pos: [0.0; 3],
            dir: [0.0, 0.0, -1.0],
            kind: Some(LightKind::Spot),
            properties: LightProperties::default(),
        }
    }
}

impl LightDraft {
    /// Overwrites the values that the element has.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        self.mode.read(element)?;
        element.set_numbers("pos", &mut self.pos)?;
        element.set_numbers("dir", &mut self.dir)?;
        element.at_most_one(&["type", "directional"])?;
        let kinds = [
            ("spot", Some(LightKind::Spot)),
            ("directional", Some(LightKind::Directional)),
            ("point", Some(LightKind::Point)),
            ("image", None),
        ];
        element.set_keyword("type", &kinds, &mut self.kind)?;
        let directional = [
            ("false", Some(LightKind::Spot)),
            ("true", Some(LightKind::Directional)),
        ];
        element.set_keyword("directional", &directional, &mut self.kind)?;
        let properties = &mut self.properties;
        element.set_boolean("active", &mut properties.active)?;
        element.set_boolean("castshadow", &mut properties.castshadow)?;
        element.set_numbers("attenuation", &mut properties.attenuation)?;
        element.set_number("cutoff", &mut properties.cutoff)?;
        element.set_number("exponent", &mut properties.exponent)?;
        element.set_numbers("ambient", &mut properties.ambient)?;
        element.set_numbers("diffuse", &mut properties.diffuse)?;
        element.set_numbers("specular", &mut properties.specular)
    }

    /// Returns the light in its body, transformed by the enclosing frame.
    pub(super) fn finish(self, element: &Element, frame: &Pose) -> LightSpec {
        let pose = frame.then(Pose {
            pos: Vec3::from_array(self.pos),
            quat: Quat::IDENTITY,
            ..Pose::IDENTITY
        });
        LightSpec {
            name: element.string("name"),
            pos: pose.pos,
            dir: pose.quat.rotate(Vec3::from_array(self.dir)),
            tracking: tracking(self.mode, element),
            properties: LightProperties {
                kind: self.kind.unwrap_or(LightKind::Point),
                active: self.properties.active && self.kind.is_some(),
                ..self.properties
            },
            origin: Some(element.origin.clone()),
        }
    }
}

/// Overwrites the properties that a `<headlight>` gives.
pub(super) fn read_headlight(
    element: &Element,
    headlight: &mut Headlight,
) -> Result<(), LoadError> {
    element.set_numbers("ambient", &mut headlight.ambient)?;
    element.set_numbers("diffuse", &mut headlight.diffuse)?;
    element.set_numbers("specular", &mut headlight.specular)?;
    if let Some(active) = element.integer("active")? {
        headlight.active = active != 0;
    }
    Ok(())
}
