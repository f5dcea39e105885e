//! The keyframes of attached models, until the whole model is read.

use clench_builder::KeyframeSpec;

/// A keyframe in parts.
#[derive(Clone, Debug)]
pub(crate) struct AttachedKeyframe {
    /// Its name, time and location; it has no numbers of its own.
    pub(super) spec: KeyframeSpec,
    pub(super) parts: Vec<Fragment>,
}

/// The part of a keyframe that concerns one element.
#[derive(Clone, Debug)]
pub(super) struct Fragment {
    /// The number of the element.
    pub(super) number: u32,
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
    pub(super) plastic: Vec<f64>,
}
