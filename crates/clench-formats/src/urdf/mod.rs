//! URDF, as MuJoCo 4.0 reads it.
//!
//! Links become bodies, joints what moves them, and a link that no joint moves is fused into its parent. Elements that say nothing of
//! links and joints (transmissions, sensors, plugins, Gazebo's) are ignored, as in MuJoCo; one whose name is nearly that of an
//! element that is read is noted. Text keeps its place in the file, which is why our own tree of elements is read
//! ([`document`](crate::document)).

mod element;
mod floating;
mod geometry;
mod hints;
mod joint;
mod link;
mod meshes;
mod settings;
mod tree;

use crate::LoadError;
use crate::document::Element;
use crate::spending::Spending;
use clench_builder::ModelBuilder;
use geometry::{GeomReader, Materials};
use meshes::Meshes;
use std::path::{Path, PathBuf};
use tree::Tree;

/// Reads the robot below a root element, whose file is in a directory; `floating` frees the link that stands on the world.
///
/// # Errors
/// What breaks a rule of the format: missing elements and attributes, names that are taken or lead nowhere, joints that form a loop,
/// meshes that are not there.
pub(crate) fn read(
    root: &Element,
    directory: &Path,
    packages: &[PathBuf],
    floating: bool,
    spending: &mut Spending,
) -> Result<ModelBuilder, LoadError> {
    let mut builder = ModelBuilder {
        budget: spending.budget,
        name: root.text("name").unwrap_or("MuJoCo Model").to_owned(),
        ..ModelBuilder::default()
    };
    let compiler = settings::read(root, &mut builder)?;
    hints::collect(root, &mut builder.notes);
    let materials = Materials::read(root)?;
    let tree = Tree::read(root)?;
    let mut geoms = GeomReader {
        meshes: Meshes::new(directory, packages, &compiler),
        materials,
        names: Default::default(),
        discard_visual: builder.compiler.discardvisual,
    };
    for link in tree.links() {
        link::read(&link, &mut geoms, &mut builder, spending)?;
    }
    joint::read_all(&tree, &mut builder, spending)?;
    if floating {
        floating::float(root, &mut builder)?;
    }
    builder.meshes = geoms.meshes.found;
    Ok(builder)
}
