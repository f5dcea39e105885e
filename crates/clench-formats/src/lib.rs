//! Model files: readers that turn text into [`ModelBuilder`]s. All parsing and all file errors live here.
//!
//! MJCF, MuJoCo's own format, is read as MuJoCo 4.0 reads it: the same defaults, the same rules, the same rejections.
//! URDF is read as MuJoCo reads it, too: bodies that no joint moves become part of their parents, what is only seen is left out,
//! and a joint that mimics another is an equality constraint.
//! Meshes come from STL, OBJ, MSH, Collada and glTF files, height fields from PNG images and MuJoCo's binary grids.
//! What an MJCF file can say and this library cannot simulate yet is an error that names file, line and element, never
//! a silent skip. What has no effect on motion is accepted by an explicit list; colours, textures and lights are kept for viewers.

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

use clench_builder::ModelBuilder;
use clench_dynamics::{Budget, Model};
use std::path::Path;

/// Loads a model file, within the usual [`Budget`].
///
/// # Errors
/// [`LoadError`] where [`read`] fails or the model cannot be built: dangling names, moving bodies without mass, ...
pub fn load(path: impl AsRef<Path>) -> Result<Model, LoadError> {
    load_within(path, Budget::default())
}

/// Loads a model file that may ask for more memory and work than usual, or for less.
///
/// # Errors
/// As [`load`].
pub fn load_within(path: impl AsRef<Path>, budget: Budget) -> Result<Model, LoadError> {
    Loader::new().budget(budget).load(path)
}

/// Loads a model from text; includes are found from the working directory.
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
/// As [`load`]; the file name of an error is empty.
pub fn load_str(text: &str) -> Result<Model, LoadError> {
    load_str_within(text, Budget::default())
}

/// Loads a model from text that may ask for more memory and work than usual, or for less.
///
/// # Errors
/// As [`load_str`].
pub fn load_str_within(text: &str, budget: Budget) -> Result<Model, LoadError> {
    Loader::new().budget(budget).load_str(text)
}

/// Reads a model file into a builder, before anything is computed.
///
/// # Errors
/// [`LoadError`] where the file cannot be read, is not well-formed, breaks a rule of the format, or asks for something
/// that is not supported yet.
pub fn read(path: impl AsRef<Path>) -> Result<ModelBuilder, LoadError> {
    Loader::new().read(path)
}

/// Reads a model from text, as [`read`]; includes are found from the working directory.
///
/// # Errors
/// As [`read`]; the file name of an error is empty.
pub fn read_str(text: &str) -> Result<ModelBuilder, LoadError> {
    Loader::new().read_str(text)
}
