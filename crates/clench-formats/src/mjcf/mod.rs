//! MJCF, as MuJoCo 4.0 reads it.
//!
//! [`document`](crate::document) parses text into elements, [`include`] splices files together, and [`schema`] accepts
//! or rejects every element and attribute before the sections read their values, so they never see unknown names.

mod actuator;
mod appearance;
mod assets;
mod body;
mod camera;
pub(crate) mod compiler;
mod compose;
mod contact;
mod controller;
pub(crate) mod custom;
mod defaults;
mod equality;
pub(crate) mod files;
mod geom;
mod hfield;
mod include;
mod inputs;
mod joint;
pub(crate) mod keyframe;
mod light;
mod linear_map;
mod mesh;
mod never_fused;
mod omit;
pub(crate) mod option;
pub(crate) mod orientation;
mod relations;
mod rules;
mod scale;
pub(crate) mod schema;
mod sections;
mod sensor;
mod shortcut;
mod site;
mod source;
mod support;
mod targets;
mod tendon;
mod texture;
mod transmission;
mod visual;
mod write;

use sections::sections;
pub use support::{Support, supported};
pub use write::{SaveError, SaveModel};

use crate::document::{self, Element};
use crate::error::LoadError;
use crate::spending::Spending;
use body::BodyReader;
use clench_builder::ModelBuilder;
use compose::Composed;
use include::Includes;
use option::OptionReader;
use std::path::{Path, PathBuf};

/// Reads the model below a root element, which came from a file or (`None`) from text; omits unsupported elements if
/// allowed. `packages` are folders for attached URDF files.
///
/// # Errors
/// Returns an error if a rule of the format is broken or a feature is not supported yet.
pub(crate) fn read(
    mut root: Element,
    path: Option<&Path>,
    packages: &[PathBuf],
    ignore_unsupported: bool,
    spending: &mut Spending,
) -> Result<ModelBuilder, LoadError> {
    let directory = path.and_then(Path::parent).unwrap_or(Path::new(""));
    Includes::new(path, spending).expand(&mut root, directory, spending)?;
    let composed = compose::compose(root, path, packages, ignore_unsupported, spending)?;
    read_model(&composed, spending)
}

fn read_model(composed: &Composed, spending: &mut Spending) -> Result<ModelBuilder, LoadError> {
    let Composed {
        root,
        sources,
        keyframes,
        ..
    } = composed;
    let mut builder = ModelBuilder {
        budget: spending.budget,
        name: root.text("model").unwrap_or("MuJoCo Model").to_owned(),
        compiler: (*sources.main().spec).clone(),
        bodies: vec![body::world()],
        notes: composed.notes.clone(),
        omitted: composed.omitted.clone(),
        ..ModelBuilder::default()
    };
    let mut options = OptionReader::default();
    for section in sections(root, "option") {
        options.read(section, &mut builder)?;
    }
    options.finish(&mut builder);
    builder.options = builder.options.or(option::format_defaults());
    assets::read(root, sources, &mut builder, spending)?;
    visual::read(root, sources, &mut builder, spending)?;
    let palette = appearance::Palette::new(root, &builder.materials);
    let mut bodies = BodyReader::new(sources, &palette, &mut builder.bodies, spending);
    for section in sections(root, "worldbody") {
        bodies.read_world(section)?;
    }
    let (numbers, frames) = bodies.finish();
    relations::read(root, sources, &mut builder)?;
    assets::check_materials(&builder)?;
    targets::check(root, &builder.bodies)?;
    for size in sections(root, "size") {
        keyframe::pad(size, &mut builder.keyframes, keyframes.len())?;
        custom::read_widths(size, &mut builder.user_widths)?;
    }
    builder
        .keyframes
        .extend(compose::keyframes::resolve(keyframes, root, numbers));
    let shortcuts = relations::shortcuts(root, sources)?;
    frames.scale_remaining(&shortcuts, &mut builder, spending)?;
    builder.custom = custom::read(root, &mut builder.options, spending)?;
    if builder.compiler.fusestatic {
        never_fused::exclude_from_fusion(root, &mut builder.bodies);
    }
    Ok(builder)
}
