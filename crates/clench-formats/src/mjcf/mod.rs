//! MJCF, as MuJoCo 4.0 reads it.
//!
//! [`document`] turns text into elements, [`include`] splices files together, [`schema`] accepts or rejects every element
//! and attribute, and only then do the sections read their values; so a section never meets what it does not know.

mod actuator;
mod assets;
mod attributes;
mod body;
mod camera;
mod compiler;
mod compose;
mod contact;
mod controller;
mod defaults;
mod document;
mod equality;
mod files;
mod geom;
mod hfield;
mod include;
mod joint;
mod keyframe;
mod mesh;
mod option;
mod orientation;
mod relations;
mod rules;
mod schema;
mod sensor;
mod shortcut;
mod site;
mod source;
mod support;
mod tendon;

pub use support::{Support, supported};

use crate::LoadError;
use crate::spending::Spending;
use body::BodyReader;
use clench_rigid::Budget;
use clench_rigid::builder::ModelBuilder;
use compose::Composed;
use document::Element;
use include::Includes;
use option::OptionReader;
use std::path::Path;
use std::sync::Arc;

/// Reads the model in a file.
pub(crate) fn read_file(path: &Path, budget: Budget) -> Result<ModelBuilder, LoadError> {
    let file = Arc::from(path.to_string_lossy());
    let mut spending = Spending::new(budget);
    let unreadable = |error| LoadError::file(&file, format!("cannot read the file: {error}"));
    let bytes = spending.read(path).map_err(unreadable)?;
    let directory = path.parent().unwrap_or(Path::new(""));
    read(&bytes, &file, Some(path), directory, &mut spending)
}

/// Reads a model from text.
pub(crate) fn read_text(text: &str, budget: Budget) -> Result<ModelBuilder, LoadError> {
    let (file, directory) = (Arc::from(""), Path::new(""));
    let mut spending = Spending::new(budget);
    read(text.as_bytes(), &file, None, directory, &mut spending)
}

fn read(
    bytes: &[u8],
    file: &Arc<str>,
    path: Option<&Path>,
    directory: &Path,
    spending: &mut Spending,
) -> Result<ModelBuilder, LoadError> {
    let mut root = document::parse(bytes, file, spending)?;
    match root.tag.as_str() {
        "mujoco" => {}
        "robot" => return Err(root.error("URDF is not supported yet")),
        _ => return Err(root.error("the root element of a model is <mujoco>")),
    }
    Includes::new(path).expand(&mut root, directory, spending)?;
    let composed = compose::compose(root, path, directory, spending)?;
    assets::check_materials(&composed.root)?;
    read_model(&composed, spending)
}

/// The sections of a kind, in order.
fn sections<'a>(root: &'a Element, tag: &str) -> impl Iterator<Item = &'a Element> {
    root.children
        .iter()
        .filter(move |section| section.tag == tag)
}

/// The elements in all sections of a kind.
fn entries<'a>(root: &'a Element, tag: &str) -> impl Iterator<Item = &'a Element> {
    sections(root, tag).flat_map(|section| &section.children)
}

fn read_model(composed: &Composed, spending: &mut Spending) -> Result<ModelBuilder, LoadError> {
    let Composed { root, sources, .. } = composed;
    let mut builder = ModelBuilder {
        budget: spending.budget,
        name: root.text("model").unwrap_or("MuJoCo Model").to_owned(),
        compiler: (*sources.main().spec).clone(),
        bodies: vec![body::world()],
        notes: composed.notes.clone(),
        ..ModelBuilder::default()
    };
    let mut options = OptionReader::default();
    for section in sections(root, "option") {
        options.read(section, &mut builder)?;
    }
    options.finish(&mut builder);
    builder.options = builder.options.or(option::format_defaults());
    assets::read(root, sources, &mut builder, spending)?;
    let visibility = assets::Visibility::read(root, sources)?;
    let mut bodies = BodyReader::new(sources, &visibility, &mut builder.bodies, spending);
    for section in sections(root, "worldbody") {
        bodies.read_world(section)?;
    }
    relations::read(root, sources, &mut builder)?;
    Ok(builder)
}
