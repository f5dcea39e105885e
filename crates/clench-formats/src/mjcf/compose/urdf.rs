//! Attached URDF files: read as a model, and converted to equivalent MJCF.

use super::shared::Shared;
use crate::document::{self, Element};
use crate::error::LoadError;
use crate::mjcf::SaveModel;
use crate::mjcf::sections::entries;
use std::path::Path;
use std::sync::Arc;

/// Returns the MJCF document equivalent to a URDF file in a directory.
///
/// As in MuJoCo 4.0, the model that it is attached to decides whether static links are fused, and the file itself
/// whether visual geometry is omitted. Options are those that the file gives: a saved model has all of them.
///
/// # Errors
/// Returns an error if the file cannot be read, built or expressed in MJCF.
pub(super) fn as_mjcf(
    element: &Element,
    root: &Element,
    directory: &Path,
    shared: &mut Shared,
) -> Result<Element, LoadError> {
    let mut builder = crate::urdf::read(root, directory, shared.packages, false, shared.spending)?;
    builder.compiler.fusestatic = false;
    shared.notes.append(&mut builder.notes);
    let text = builder.build()?.to_mjcf();
    let text = text.map_err(|error| element.error(error.to_string()))?;
    let file: Arc<str> = format!("{}, written as MJCF", root.origin.file).into();
    let mut written = document::parse(text.as_bytes(), &file, shared.spending)?;
    let has_options = entries(root, "mujoco").any(|section| section.tag == "option");
    if !has_options {
        written.children.retain(|section| section.tag != "option");
    }
    Ok(written)
}
