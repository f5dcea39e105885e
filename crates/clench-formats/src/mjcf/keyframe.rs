//! `<keyframe>`: stored states, and `<size nkey="..."/>`, which can request more of them.

use crate::document::Element;
use crate::error::LoadError;
use clench_builder::KeyframeSpec;

/// Reads the state of a `<key>`; vector lengths are checked when the model is built.
pub(crate) fn read(element: &Element) -> Result<KeyframeSpec, LoadError> {
    let mut key = KeyframeSpec {
        name: element.string("name"),
        qpos: element.list("qpos")?,
        qvel: element.list("qvel")?,
        act: element.list("act")?,
        plastic: element.list("plastic")?,
        ctrl: element.list("ctrl")?,
        mocap_pos: element.list("mpos")?,
        mocap_quat: element.list("mquat")?,
        origin: Some(element.origin.clone()),
        ..KeyframeSpec::default()
    };
    element.set_number("time", &mut key.time)?;
    Ok(key)
}

/// The maximum number of keyframes.
const MAX_KEYFRAMES: usize = 10_000;

/// Adds keyframes in the initial state until they and those of attached models, which follow, are as many as a `<size>`
/// requests.
pub(crate) fn pad(
    size: &Element,
    keyframes: &mut Vec<KeyframeSpec>,
    attached: usize,
) -> Result<(), LoadError> {
    // MuJoCo writes -1 for "as many as there are".
    let requested = size.integer("nkey")?.unwrap_or(-1).max(-1);
    let requested = usize::try_from(requested).unwrap_or(0);
    if requested > MAX_KEYFRAMES {
        return Err(size.error(format!("nkey is more than {MAX_KEYFRAMES}")));
    }
    let own = requested.saturating_sub(attached);
    if keyframes.len() < own {
        keyframes.resize_with(own, KeyframeSpec::default);
    }
    Ok(())
}
