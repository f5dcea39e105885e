//! `<keyframe>`: stored states.

use super::document::Element;
use crate::LoadError;
use clench_rigid::builder::KeyframeSpec;

/// The state that a `<key>` describes; lengths are checked against the model when it is built.
pub(crate) fn read(element: &Element) -> Result<KeyframeSpec, LoadError> {
    let mut key = KeyframeSpec {
        name: element.string("name"),
        qpos: element.list("qpos")?,
        qvel: element.list("qvel")?,
        act: element.list("act")?,
        ctrl: element.list("ctrl")?,
        mocap_pos: element.list("mpos")?,
        mocap_quat: element.list("mquat")?,
        origin: Some(element.origin.clone()),
        ..KeyframeSpec::default()
    };
    element.set_number("time", &mut key.time)?;
    Ok(key)
}
