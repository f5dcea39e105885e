//! MJCF, as MuJoCo 4.0 reads it.
//!
//! [`document`] turns text into elements, [`include`] splices files together, [`schema`] accepts or rejects every element
//! and attribute, and only then do the sections read their values; so a section never meets what it does not know.

mod actuator;
mod assets;
mod attributes;
mod body;
mod compiler;
mod contact;
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
mod rules;
mod schema;
mod sensor;
mod site;
mod support;
mod tendon;

pub use support::{Support, supported};

use crate::LoadError;
use crate::spending::Spending;
use actuator::Shortcut;
use body::BodyReader;
use clench_rigid::Budget;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::SensorKind;
use compiler::CompilerOptions;
use defaults::{Classes, MAIN};
use document::Element;
use files::Files;
use include::Includes;
use option::OptionReader;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// Attributes that name an element of the body tree.
const REFERENCES: &[&str] = &[
    "joint",
    "jointinparent",
    "joint1",
    "joint2",
    "body1",
    "body2",
    "geom1",
    "geom2",
    "site1",
    "site2",
    "body",
    "site",
    "objname",
    "refname",
];

/// Reads the model in a file.
pub(crate) fn read_file(path: &Path, budget: Budget) -> Result<ModelBuilder, LoadError> {
    let file = Arc::from(path.to_string_lossy());
    let mut spending = Spending::new(budget);
    let unreadable = |error| LoadError::file(&file, format!("cannot read the file: {error}"));
    let bytes = spending.read(path).map_err(unreadable)?;
    let directory = path.parent().unwrap_or(Path::new(""));
    let includes = Includes::new(Some(path));
    read(&bytes, &file, includes, directory, &mut spending)
}

/// Reads a model from text.
pub(crate) fn read_text(text: &str, budget: Budget) -> Result<ModelBuilder, LoadError> {
    let (file, directory) = (Arc::from(""), Path::new(""));
    let mut spending = Spending::new(budget);
    let includes = Includes::new(None);
    read(text.as_bytes(), &file, includes, directory, &mut spending)
}

fn read(
    bytes: &[u8],
    file: &Arc<str>,
    mut includes: Includes,
    directory: &Path,
    spending: &mut Spending,
) -> Result<ModelBuilder, LoadError> {
    let mut root = document::parse(bytes, file, spending)?;
    match root.tag.as_str() {
        "mujoco" => {}
        "robot" => return Err(root.error("URDF is not supported yet")),
        _ => return Err(root.error("the root element of a model is <mujoco>")),
    }
    includes.expand(&mut root, directory, spending)?;
    schema::check(&root)?;
    assets::check_materials(&root)?;
    read_model(&root, directory, spending)
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

fn read_model(
    root: &Element,
    directory: &Path,
    spending: &mut Spending,
) -> Result<ModelBuilder, LoadError> {
    let mut builder = ModelBuilder {
        budget: spending.budget,
        name: root.text("model").unwrap_or("MuJoCo Model").to_owned(),
        bodies: vec![body::world()],
        ..ModelBuilder::default()
    };
    let mut compiler = CompilerOptions::default();
    for section in sections(root, "compiler") {
        compiler::read(section, &mut compiler, &mut builder.compiler)?;
    }
    let mut options = OptionReader::default();
    for section in sections(root, "option") {
        options.read(section, &mut builder)?;
    }
    options.finish(&mut builder);
    builder.options = builder.options.or(option::format_defaults());
    let mut classes = Classes::default();
    for section in sections(root, "default") {
        classes.read(section, spending)?;
    }
    let files = Files::new(directory, &compiler);
    for element in entries(root, "asset") {
        match element.tag.as_str() {
            "mesh" => {
                let draft = classes.of(element)?.mesh.clone();
                builder
                    .meshes
                    .push(draft.finish(element, &files, spending)?);
            }
            "hfield" => {
                let field = hfield::read(element, &files, spending)?;
                builder.height_fields.push(field);
            }
            _ => {}
        }
    }
    let visibility = assets::Visibility::read(root, &classes)?;
    let mut bodies = BodyReader::new(
        &compiler,
        &classes,
        &visibility,
        &mut builder.bodies,
        spending,
    );
    for section in sections(root, "worldbody") {
        bodies.read_world(section)?;
    }
    let replicated = bodies.replicated;
    for section in ["contact", "equality", "tendon", "actuator", "sensor"] {
        for element in entries(root, section) {
            reject_replicated(element, &replicated)?;
        }
    }
    read_references(root, &classes, &mut builder)?;
    Ok(builder)
}

/// MuJoCo repeats an element that names a replicated one, as often as that; this reader does not yet.
fn reject_replicated(element: &Element, replicated: &HashSet<String>) -> Result<(), LoadError> {
    for child in &element.children {
        reject_replicated(child, replicated)?;
    }
    for (attribute, value) in &element.attributes {
        if REFERENCES.contains(&attribute.as_str()) && replicated.contains(value) {
            let message =
                format!("{attribute} names \"{value}\", which is replicated: not supported yet");
            return Err(element.error(message));
        }
    }
    Ok(())
}

/// The sections whose elements name elements of the body tree.
fn read_references(
    root: &Element,
    classes: &Classes,
    builder: &mut ModelBuilder,
) -> Result<(), LoadError> {
    for element in entries(root, "contact") {
        if element.tag == "pair" {
            let pair = classes.of(element)?.pair.clone();
            builder.pairs.push(contact::finish_pair(element, pair)?);
        } else {
            builder.excludes.push(contact::read_exclude(element)?);
        }
    }
    for element in entries(root, "equality") {
        let draft = classes.of(element)?.equality.clone();
        builder.equalities.push(equality::read(element, draft)?);
    }
    for element in entries(root, "tendon") {
        let tendon = classes.of(element)?.tendon.clone();
        builder.tendons.push(tendon::read_fixed(element, tendon)?);
    }
    for element in entries(root, "actuator") {
        let class = classes.named_by(element, "class", MAIN)?;
        let shortcut = Shortcut::from_tag(&element.tag).unwrap_or_default();
        let mut draft = classes[class].actuator.clone();
        draft.read(element, shortcut, classes.parameters(class, shortcut))?;
        builder.actuators.push(draft.finish(element)?);
    }
    for element in entries(root, "sensor") {
        if let Some(kind) = SensorKind::find(&element.tag) {
            builder.sensors.push(sensor::read(element, kind)?);
        }
    }
    for element in entries(root, "keyframe") {
        builder.keyframes.push(keyframe::read(element)?);
    }
    for size in sections(root, "size") {
        keyframe::pad(size, &mut builder.keyframes)?;
    }
    Ok(())
}
