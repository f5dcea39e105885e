//! URDF, as MuJoCo 4.0 reads it.
//!
//! Links become bodies, joints their degrees of freedom, and a link without a joint is fused into its parent. Elements
//! that do not concern links and joints (transmissions, sensors, plugins, Gazebo's) are ignored, as in MuJoCo; one with
//! a name similar to a supported one is noted. Elements come from this crate's own tree, which has source locations
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

use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::ModelBuilder;
use geometry::{GeomReader, Materials};
use meshes::Meshes;
use std::path::{Path, PathBuf};
use tree::Tree;

/// Reads the robot below a root element, whose file is in a directory; `floating` frees the link fixed to the world.
///
/// # Errors
/// Returns an error if a rule of the format is broken: missing elements and attributes, duplicate or unknown names,
/// joints that form a loop, missing meshes.
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
        link::read_body(&link, &mut builder, spending)?;
    }
    // As in MuJoCo, the order of the file decides about names that several shapes or meshes have.
    for link in tree.links_as_written() {
        link::read_shapes(&link, &mut geoms, &mut builder, spending)?;
    }
    joint::read_all(&tree, &mut builder, spending)?;
    if floating {
        floating::float(root, &mut builder)?;
    }
    builder.meshes = geoms.meshes.found;
    Ok(builder)
}
