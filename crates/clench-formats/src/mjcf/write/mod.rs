//! A loaded or built model as MJCF, with every number resolved.
//!
//! The file leaves nothing to a compiler: explicit inertials, limits and ranges, poses as quaternions, angles in
//! radians, no default classes, meshes as vertices in the file. Attributes with MJCF's default value are omitted. Each
//! function destructures a record of the model field by field, so that a new field is a compile error until it is
//! handled; content that MJCF cannot express is an error that names it.

mod actuator;
mod assets;
pub(super) mod names;
mod option;
mod relations;
mod sensor;
mod tree;
pub(super) mod xml;

#[cfg(test)]
mod tests;

use super::equality;
use clench_builder::DEFAULT_ZNEAR;
use clench_dynamics::Model;
use clench_dynamics::model::{Custom, Keyframe, TupleEntry};
use clench_dynamics::options::{Mjcf, RigidOption};
pub use names::SaveError;
use xml::Xml;

/// Serialization of a model to MJCF.
///
/// ```
/// use clench_formats::{SaveModel, load_str};
///
/// let model = load_str("<mujoco><worldbody><body><freejoint/><geom size='0.1' mass='2'/></body></worldbody></mujoco>")?;
/// let text = model.to_mjcf()?;
/// assert!(text.contains("mass=\"2\""));
/// assert_eq!(load_str(&text)?.params.body_inertia, model.params.body_inertia);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait SaveModel {
    /// Returns the model as a self-contained MJCF file: it loads to the same model, here and in MuJoCo.
    ///
    /// Numbers are written to their last digit. Values computed from them at loading (unit quaternions, centres of mass
    /// of meshes, inverse inertias) may differ in the last digits.
    ///
    /// # Errors
    /// Returns an error if MJCF cannot express the model: an active floor of time constants, differing parts of a
    /// joint, bodies nested more than 500 deep.
    fn to_mjcf(&self) -> Result<String, SaveError>;
}

impl SaveModel for Model {
    fn to_mjcf(&self) -> Result<String, SaveError> {
        let mut xml = Xml::default();
        xml.tag("mujoco").text("model", &self.name).open();
        option::write(self, &mut xml)?;
        write_widths(self, &mut xml);
        write_near_distance(self, &mut xml);
        xml.section("asset", |xml| assets::write(self, xml))?;
        tree::write(self, &mut xml)?;
        xml.section("contact", |xml| relations::write_contacts(self, xml))?;
        xml.section("equality", |xml| equality::write(self, xml))?;
        xml.section("tendon", |xml| relations::write_tendons(self, xml))?;
        xml.section("actuator", |xml| actuator::write(self, xml))?;
        xml.section("sensor", |xml| sensor::write(self, xml))?;
        xml.section("custom", |xml| write_custom(self, xml))?;
        xml.section("keyframe", |xml| write_keyframes(self, xml))?;
        Ok(xml.finish())
    }
}

/// Writes the counts of user numbers of elements, if any.
fn write_widths(model: &Model, xml: &mut Xml) {
    let widths = [
        ("nuser_body", model.bodies.first().map(|e| &e.user)),
        ("nuser_jnt", model.joints.first().map(|e| &e.user)),
        ("nuser_geom", model.geoms.first().map(|e| &e.user)),
        ("nuser_site", model.sites.first().map(|e| &e.user)),
        ("nuser_cam", model.cameras.first().map(|e| &e.user)),
        ("nuser_tendon", model.tendons.first().map(|e| &e.user)),
        ("nuser_actuator", model.actuators.first().map(|e| &e.user)),
        ("nuser_sensor", model.sensors.first().map(|e| &e.user)),
    ];
    let widths = widths.map(|(name, user)| (name, user.map_or(0, |user| user.len())));
    if widths.iter().any(|(_, width)| *width > 0) {
        let mut tag = xml.tag("size");
        for (name, width) in widths {
            tag = tag.integer_unless(name, width as i64, 0);
        }
        tag.end();
    }
}

/// Writes the near clipping distance of cameras, which those with a field of view store.
fn write_near_distance(model: &Model, xml: &mut Xml) {
    let mut cameras = model.cameras.iter().zip(&model.params.cam_intrinsic);
    let stored = cameras.find(|(camera, _)| !camera.intrinsic);
    if let Some((_, &[znear, ..])) = stored
        && znear != DEFAULT_ZNEAR
    {
        xml.tag("visual").open();
        xml.tag("map").numbers("znear", &[znear]).end();
        xml.close();
    }
}

/// Writes the user data.
fn write_custom(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    let Custom {
        numerics,
        texts,
        tuples,
    } = &model.custom;
    for (name, data) in numerics {
        xml.tag("numeric")
            .text("name", name)
            .numbers("data", data)
            .end();
    }
    for (name, data) in texts {
        xml.tag("text").text("name", name).text("data", data).end();
    }
    for &option in RigidOption::ALL {
        if let (Mjcf::Text(name), Some(value)) = (option.mjcf(), model.options.get(option)) {
            let data = value.to_string();
            xml.tag("text").text("name", name).text("data", &data).end();
        }
    }
    for (name, entries) in tuples {
        xml.tag("tuple").text("name", name).open();
        for TupleEntry { kind, name, value } in entries {
            xml.tag("element")
                .text("objtype", kind)
                .text("objname", name)
                .numbers("prm", &[*value])
                .end();
        }
        xml.close();
    }
    Ok(())
}

fn write_keyframes(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for keyframe in &model.keyframes {
        let Keyframe {
            name,
            time,
            qpos,
            qvel,
            act,
            plastic,
            ctrl,
            mocap_pos,
            mocap_quat,
        } = keyframe;
        xml.tag("key")
            .name(name)
            .number_unless("time", *time, 0.0)
            .numbers_unless("qpos", qpos, &[])
            .numbers_unless("qvel", qvel, &[])
            .numbers_unless("act", act, &[])
            .numbers_unless("plastic", plastic, &[])
            .numbers_unless("ctrl", ctrl, &[])
            .numbers_unless("mpos", mocap_pos, &[])
            .numbers_unless("mquat", mocap_quat, &[])
            .end();
    }
    Ok(())
}
