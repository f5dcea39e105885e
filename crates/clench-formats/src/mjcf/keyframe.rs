//! `<keyframe>`: stored states, and `<size nkey="..."/>`, which asks for more of them.

use super::document::Element;
use crate::LoadError;
use clench_builder::KeyframeSpec;

/// The state that a `<key>` describes; lengths are checked against the model when it is built.
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

/// More keyframes than a file can mean to have.
const MAX_KEYFRAMES: usize = 10_000;

/// Adds keyframes in the initial state until there are as many as a `<size>` asks for.
pub(crate) fn pad(size: &Element, keyframes: &mut Vec<KeyframeSpec>) -> Result<(), LoadError> {
    // -1 is how MuJoCo writes "as many as there are".
    let wanted = size.integer("nkey")?.unwrap_or(-1).max(-1);
    let wanted = usize::try_from(wanted).unwrap_or(0);
    if wanted > MAX_KEYFRAMES {
        return Err(size.error(format!("nkey is more than {MAX_KEYFRAMES}")));
    }
    if keyframes.len() < wanted {
        keyframes.resize_with(wanted, KeyframeSpec::default);
    }
    Ok(())
}
