//! `<mujoco>`, MuJoCo's extension of URDF: settings for deriving omitted values, and the physics of the world.

use crate::document::Element;
use crate::error::LoadError;
use crate::mjcf::compiler::{self, CompilerOptions};
use crate::mjcf::option::OptionReader;
use crate::mjcf::{custom, keyframe, schema};
use clench_builder::{CompilerSpec, ModelBuilder};

/// The sections of MJCF that are permitted in `<mujoco>`.
const SECTIONS: [&str; 3] = ["compiler", "option", "size"];

/// Reads the settings over MuJoCo's defaults for URDF: static bodies are fused, visual geometry is omitted.
///
/// # Errors
/// Returns an error if a section is invalid.
pub(super) fn read(
    root: &Element,
    builder: &mut ModelBuilder,
) -> Result<CompilerOptions, LoadError> {
    builder.compiler = CompilerSpec {
        fusestatic: true,
        discardvisual: true,
        ..CompilerSpec::default()
    };
    let mut notation = CompilerOptions::default();
    let Some(extension) = root.child("mujoco")? else {
        return Ok(notation);
    };
    for section in &extension.children {
        match SECTIONS.contains(&section.tag.as_str()) {
            true => schema::check_section(section)?,
            false => builder.notes.push(format!(
                "<{}> in <mujoco> is ignored: of MJCF, a URDF file has compiler, option and size alone",
                section.tag
            )),
        }
    }
    if let Some(section) = extension.child("compiler")? {
        compiler::read(section, &mut notation, &mut builder.compiler)?;
    }
    let mut options = OptionReader::default();
    if let Some(section) = extension.child("option")? {
        options.read(section, builder)?;
    }
    options.finish(builder);
    if let Some(section) = extension.child("size")? {
        keyframe::pad(section, &mut builder.keyframes, 0)?;
        custom::read_widths(section, &mut builder.user_widths)?;
    }
    Ok(notation)
}
