//! Model file readers: they turn text into [`ModelBuilder`]s. All parsing and all file errors live here.
//!
//! MJCF, MuJoCo's own format, is read as MuJoCo 4.0 reads it, with the same defaults, rules and rejections. URDF is
//! also read as MuJoCo reads it: bodies without a joint are merged into their parents, visual geometry is omitted, and
//! a mimic joint becomes an equality constraint. Meshes come from STL, OBJ, MSH, Collada and glTF files, height fields
//! from PNG images and MuJoCo's binary grids. An MJCF feature that this library cannot simulate yet is an error that
//! names file, line and element, never a silent skip. Elements without effect on motion are accepted by an explicit
//! list; colours, textures and lights are stored for viewers.

#![deny(unreachable_pub)]

mod attributes;
pub mod base64;
mod document;
mod elevation;
mod error;
mod image;
mod loader;
mod mesh;
mod mjcf;
mod spending;
mod tolerant;
mod urdf;

pub use error::LoadError;
pub use loader::Loader;
pub use mjcf::{SaveError, SaveModel, Support, supported};
// For `ModelSpec` in Python.
#[doc(hidden)]
pub use tolerant::strict as strict_xml;

use clench_builder::ModelBuilder;
use clench_dynamics::{Budget, Model};
use std::path::Path;

/// Loads a model file with the default [`Budget`].
///
/// # Errors
/// Returns a [`LoadError`] if [`read`] fails or the model cannot be built, as with dangling names or massless moving
/// bodies.
pub fn load(path: impl AsRef<Path>) -> Result<Model, LoadError> {
    load_within(path, Budget::default())
}

/// Loads a model file with a custom limit on memory and work.
///
/// # Errors
/// See [`load`].
pub fn load_within(path: impl AsRef<Path>, budget: Budget) -> Result<Model, LoadError> {
    Loader::new().budget(budget).load(path)
}

/// Loads a model from text; includes are resolved from the working directory.
///
/// ```
/// let model = clench_formats::load_str(
///     "<mujoco>
///        <worldbody>
///          <body name='ball' pos='0 0 1'>
///            <freejoint/>
///            <geom size='0.1'/>
///          </body>
///        </worldbody>
///      </mujoco>",
/// )?;
/// assert_eq!((model.nq, model.nv), (7, 6));
/// # Ok::<(), clench_formats::LoadError>(())
/// ```
///
/// # Errors
/// See [`load`]; the file name of an error is empty.
pub fn load_str(text: &str) -> Result<Model, LoadError> {
    load_str_within(text, Budget::default())
}

/// Loads a model from text with a custom limit on memory and work.
///
/// # Errors
/// See [`load_str`].
pub fn load_str_within(text: &str, budget: Budget) -> Result<Model, LoadError> {
    Loader::new().budget(budget).load_str(text)
}

/// Reads a model file into a builder, before anything is computed.
///
/// # Errors
/// Returns a [`LoadError`] if the file cannot be read, is not well-formed, breaks a rule of the format, or uses an
/// unsupported feature.
pub fn read(path: impl AsRef<Path>) -> Result<ModelBuilder, LoadError> {
    Loader::new().read(path)
}

/// Reads a model from text, like [`read`]; includes are resolved from the working directory.
///
/// # Errors
/// See [`read`]; the file name of an error is empty.
pub fn read_str(text: &str) -> Result<ModelBuilder, LoadError> {
    Loader::new().read_str(text)
}
