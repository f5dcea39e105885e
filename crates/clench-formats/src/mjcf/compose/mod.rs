//! `<attach>` and `<replicate>`: composes one model of several, and many elements of one, before anything else is read.
//!
//! Both copy a part of a body tree into a frame, add a prefix or suffix to its names, and copy the elements outside the
//! tree that refer to it. The result contains bodies and frames only; elements of an attached model are still read with
//! its own settings.

mod attach;
mod attached_keyframe;
mod composer;
mod inherited;
pub(crate) mod keyframes;
mod models;
mod names;
mod relations;
mod replicate;
mod settings;
mod shared;
mod urdf;

use super::include::Includes;
use super::source::Sources;
use crate::document::{self, Element};
use crate::error::LoadError;
use crate::mjcf::sections::sections;
use crate::spending::Spending;
use attached_keyframe::AttachedKeyframe;
use composer::Composer;
use models::{Models, Part};
use names::Names;
use settings::Settings;
use shared::Shared;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A model composed of several files, and the settings for reading its elements.
#[derive(Debug)]
pub(crate) struct Composed {
    pub root: Element,
    pub sources: Sources,
    /// The keyframes of attached models.
    pub keyframes: Vec<AttachedKeyframe>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// The elements omitted because they are not supported yet.
    pub omitted: Vec<String>,
}

/// Composes a model from a document whose includes are expanded.
///
/// # Errors
/// Returns an error if an attached model is missing, invalid or attaches itself, or if the copies exceed the budget.
pub(crate) fn compose(
    mut root: Element,
    file: Option<&Path>,
    packages: &[PathBuf],
    ignore_unsupported: bool,
    spending: &mut Spending,
) -> Result<Composed, LoadError> {
    let identity = file.and_then(|path| spending.identity(path).ok());
    let directory = file.and_then(Path::parent).unwrap_or(Path::new(""));
    let mut shared = Shared {
        sources: Sources::default(),
        spending,
        packages,
        open: identity.into_iter().collect(),
        last_number: 0,
        notes: Vec::new(),
        omitted: ignore_unsupported.then(Vec::new),
    };
    shared.check(&mut root)?;
    let (_, keyframes) = compose_model(&mut root, directory, &mut shared)?;
    Ok(Composed {
        root,
        sources: shared.sources,
        keyframes,
        notes: shared.notes,
        omitted: shared.omitted.unwrap_or_default(),
    })
}

/// Replaces every attachment and replication in a model. Returns its merged options, and the keyframes of attached
/// models.
fn compose_model(
    root: &mut Element,
    directory: &Path,
    shared: &mut Shared,
) -> Result<(Settings, Vec<AttachedKeyframe>), LoadError> {
    let source = shared.sources.add(root, directory, shared.spending)?;
    let models = read_models(root, shared)?;
    let (options, others) = std::mem::take(&mut root.children)
        .into_iter()
        .partition(|section| settings::SECTIONS.contains(&&*section.tag));
    root.children = others;
    let mut composer = Composer {
        models,
        source,
        names: Names::default(),
        settings: Settings(options),
        lists: take_lists(root),
        worlds: Vec::new(),
        keyframes: Vec::new(),
        shared,
    };
    composer.add_list_names();
    let (worlds, others) = std::mem::take(&mut root.children)
        .into_iter()
        .partition(|section| section.tag == "worldbody");
    root.children = others;
    for world in worlds as Vec<Element> {
        composer.expand(world)?;
    }
    root.children.append(&mut composer.worlds);
    root.children.append(&mut composer.lists);
    let settings = composer.settings;
    root.children.extend(settings.0.iter().cloned());
    Ok((settings, composer.keyframes))
}

/// Reads the `<model>`s among the assets of a model.
///
/// # Errors
/// Returns an error if one cannot be read, is not MJCF, or is a model that this one is attached to.
fn read_models(root: &Element, shared: &mut Shared) -> Result<Models, LoadError> {
    let mut models = Models::default();
    let assets = sections(root, "asset").flat_map(|section| &section.children);
    for element in assets.filter(|asset| asset.tag == "model") {
        let model = read_model(element, shared)?;
        let name = element.text("name").or_else(|| model.root.text("model"));
        let name = name.unwrap_or("MuJoCo Model").to_owned();
        models.0.push((name, model));
    }
    Ok(models)
}

/// Takes the sections whose elements can be copied out of a model, merging those of each kind.
fn take_lists(root: &mut Element) -> Vec<Element> {
    let kinds = relations::FOLLOWING.iter().chain(&["asset", "keyframe"]);
    let mut lists = Vec::new();
    for &kind in kinds {
        let mut list = Element::with_location_of(root, kind);
        let (own, others) = std::mem::take(&mut root.children)
            .into_iter()
            .partition(|section| section.tag == kind);
        root.children = others;
        for mut section in own as Vec<Element> {
            list.children.append(&mut section.children);
        }
        lists.push(list);
    }
    lists
}

/// The maximum nesting depth of models.
pub(crate) const MAX_NESTING: usize = 50;

/// Reads the model that an element names, with all its attachments.
fn read_model(element: &Element, shared: &mut Shared) -> Result<Part, LoadError> {
    let name = element.required_text("file")?;
    check_type(element, name)?;
    let directory = &shared.sources.of(element).files.model_directory;
    let path = directory.join(name.replace('\\', "/"));
    let unreadable =
        |error: String| element.error(format!("cannot read \"{}\": {error}", path.display()));
    let identity = shared.spending.identity(&path).map_err(unreadable)?;
    if let Some(start) = shared.open.iter().position(|open| *open == identity) {
        let chain = shared.open[start..].iter().chain([&identity]);
        let chain: Vec<String> = chain.map(|file| file.display().to_string()).collect();
        return Err(element.error(format!("the model attaches itself: {}", chain.join(" -> "))));
    }
    if shared.open.len() >= MAX_NESTING {
        return Err(element.error(format!("models are nested more than {MAX_NESTING} deep")));
    }
    let bytes = shared.spending.read(&path).map_err(unreadable)?;
    let mut root = document::parse(&bytes, &Arc::from(path.to_string_lossy()), shared.spending)?;
    let directory = path.parent().unwrap_or(Path::new(""));
    if document::is_urdf(&root.tag) {
        root = urdf::as_mjcf(element, &root, directory, shared)?;
    }
    if root.tag != "mujoco" {
        return Err(root.error("the root element of a model is <mujoco> (MJCF) or <robot> (URDF)"));
    }
    Includes::new(Some(&path), shared.spending).expand(&mut root, directory, shared.spending)?;
    shared.check(&mut root)?;
    shared.open.push(identity);
    let (settings, attached) = compose_model(&mut root, directory, shared)?;
    inherited::write_assets(&mut root, shared)?;
    shared.open.pop();
    let keyframes = keyframes::split(&mut root, attached, shared)?;
    Ok(Part {
        root,
        settings,
        keyframes,
    })
}

/// Rejects a file that is MJCF neither by its content type nor by its name.
pub(crate) fn check_type(element: &Element, name: &str) -> Result<(), LoadError> {
    let media_type = element.text("content_type").unwrap_or_default();
    let is_known = |extension: &std::ffi::OsStr| {
        let mut known = ["xml", "mjcf", "urdf"].into_iter();
        known.any(|known| extension.eq_ignore_ascii_case(known))
    };
    let named = Path::new(name).extension().is_some_and(is_known);
    match named || ["text/xml", "application/xml"].contains(&media_type) {
        true => Ok(()),
        false => Err(element.error("a model's file is MJCF: \".xml\", or content_type text/xml")),
    }
}
