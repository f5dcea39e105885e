//! What is kept of the keyframe of an attached model until the whole model is known.

use clench_builder::KeyframeSpec;

/// A keyframe in parts.
#[derive(Clone, Debug)]
pub(crate) struct AttachedKeyframe {
    /// Its name, time and place; it has no numbers of its own.
    pub(super) spec: KeyframeSpec,
    pub(super) parts: Vec<Fragment>,
}

/// What a keyframe says of an element.
#[derive(Clone, Debug)]
pub(super) struct Fragment {
    /// The number of the element.
    pub(super) number: u32,
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
    pub(super) plastic: Vec<f64>,
}
