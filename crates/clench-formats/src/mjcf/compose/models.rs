//! The models that a model can attach.

use super::attached_keyframe::AttachedKeyframe;
use super::settings::Settings;
use crate::mjcf::document::Element;

/// A model that can be attached: its elements, its options, and its split keyframes.
pub(super) struct Part {
    pub root: Element,
    pub settings: Settings,
    pub keyframes: Vec<AttachedKeyframe>,
}

/// The models that a model can attach, by name, in file order.
#[derive(Default)]
pub(super) struct Models(pub(super) Vec<(String, Part)>);

impl Models {
    pub(super) fn find(&self, name: &str) -> Option<&Part> {
        let found = self.0.iter().find(|(known, _)| known == name);
        found.map(|(_, model)| model)
    }
}
