//! URDF, as MuJoCo 4.0 reads it.
//!
//! Links become bodies, joints what moves them, and a link that no joint moves is fused into its parent. Elements that say nothing of
//! links and joints (transmissions, sensors, plugins, Gazebo's) are ignored, as in MuJoCo; one whose name is nearly that of an
//! element that is read is noted. Text keeps its place in the file, which is why our own tree of elements is read
//! ([`document`](crate::document)).

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
use clench_rigid::builder::ModelBuilder;
use geometry::{GeomReader, Materials};
use meshes::Meshes;
use std::path::{Path, PathBuf};
use tree::Tree;

/// Reads the robot below a root element, whose file is in a directory.
///
/// # Errors
/// What breaks a rule of the format: missing elements and attributes, names that are taken or lead nowhere, joints that form a loop,
/// meshes that are not there.
pub(crate) fn read(
    root: &Element,
    directory: &Path,
    packages: &[PathBuf],
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
    builder.meshes = geoms.meshes.found;
    Ok(builder)
}

impl Element {
    /// The only child of that name.
    ///
    /// # Errors
    /// More than one.
    fn child(&self, tag: &str) -> Result<Option<&Element>, LoadError> {
        let mut found = self.children.iter().filter(|child| child.tag == tag);
        let first = found.next();
        match found.next() {
            Some(second) => Err(second.error(format!("there can be only one in {}", self.label()))),
            None => Ok(first),
        }
    }

    /// The only child of that name, which must be there.
    fn required_child(&self, tag: &str) -> Result<&Element, LoadError> {
        self.child(tag)?
            .ok_or_else(|| self.error(format!("the element <{tag}> is required")))
    }
}

/// An error inside of a link or joint, which says so.
fn inside(outer: &Element) -> impl Fn(LoadError) -> LoadError {
    let label = outer.label();
    move |mut error| {
        error.element = error.element.map(|element| match element == label {
            true => element,
            false => format!("{element} of {label}"),
        });
        error
    }
}

/// Takes the memory of an element of this size with these texts.
fn charge(
    element: &Element,
    size: usize,
    texts: &[&str],
    spending: &mut Spending,
) -> Result<(), LoadError> {
    /// What is read stands in the builder, in that of the fused bodies, then in the model.
    const COPIES: usize = 4;
    let texts: usize = texts.iter().map(|text| text.len()).sum();
    let charged = spending.bytes((COPIES * (size + texts)) as u64);
    charged.map_err(|excess| element.error(excess))
}
