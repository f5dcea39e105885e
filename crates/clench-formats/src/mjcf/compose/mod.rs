//! `<attach>` and `<replicate>`: makes one model of several, and many elements of one, before anything else is read.
//!
//! Both copy a part of a body tree into a frame, put a prefix or suffix to its names, and copy the elements outside the tree that
//! refer to it. What is left holds bodies and frames only; the elements of an attached model go on being read with that model's own
//! settings.

mod attach;
mod names;
mod relations;
mod replicate;
mod settings;

use super::document::{self, Element, MAX_DEPTH};
use super::leave_out::leave_out;
use super::schema;
use super::source::Sources;
use crate::LoadError;
use crate::spending::Spending;
use attach::Models;
use names::Names;
use settings::Settings;
use std::path::{Path, PathBuf};

/// A model of several files made into one, and how to read its elements.
#[derive(Debug)]
pub(crate) struct Composed {
    pub root: Element,
    pub sources: Sources,
    /// What a user should know of what was done.
    pub notes: Vec<String>,
    /// What was left out because it is not supported yet.
    pub left_out: Vec<String>,
}

/// Makes one model of a document whose includes are expanded.
///
/// # Errors
/// Where something attached cannot be found or read, attaches itself, or where the copies are more than the budget.
pub(crate) fn compose(
    mut root: Element,
    file: Option<&Path>,
    ignore_unsupported: bool,
    spending: &mut Spending,
) -> Result<Composed, LoadError> {
    let identity = file.and_then(|path| spending.identity(path).ok());
    let directory = file.and_then(Path::parent).unwrap_or(Path::new(""));
    let mut shared = Shared {
        sources: Sources::default(),
        spending,
        open: identity.into_iter().collect(),
        notes: Vec::new(),
        left_out: ignore_unsupported.then(Vec::new),
    };
    shared.check(&mut root)?;
    compose_model(&mut root, directory, &mut shared)?;
    Ok(Composed {
        root,
        sources: shared.sources,
        notes: shared.notes,
        left_out: shared.left_out.unwrap_or_default(),
    })
}

/// What all models of a composition share.
struct Shared<'a> {
    sources: Sources,
    spending: &'a mut Spending,
    /// The files of the models that are being read, the outermost first.
    open: Vec<PathBuf>,
    notes: Vec<String>,
    /// What was left out because it is not supported yet, if it may be.
    left_out: Option<Vec<String>>,
}

impl Shared<'_> {
    /// Holds a document against the schema, after what can be left out is.
    fn check(&mut self, root: &mut Element) -> Result<(), LoadError> {
        if let Some(left_out) = &mut self.left_out {
            leave_out(root, left_out);
        }
        schema::check(root)
    }

    /// Takes copies of an element and all in it, before they are made.
    fn charge(&mut self, at: &Element, what: &Element) -> Result<(), LoadError> {
        let (mut count, mut bytes, mut pending) = (0, 0, vec![what]);
        while let Some(element) = pending.pop() {
            let texts = element
                .attributes
                .iter()
                .map(|(name, value)| name.len() + value.len());
            let attributes = element.attributes.len() * size_of::<(String, String)>();
            bytes += size_of::<Element>() + element.tag.len() + attributes + texts.sum::<usize>();
            count += 1;
            pending.extend(&element.children);
        }
        let excess = |excess| at.error(excess);
        self.spending.elements(count).map_err(excess)?;
        self.spending.bytes(bytes as u64).map_err(excess)
    }
}

/// Replaces every attachment and replication in a model. Returns its options, with what they took from attached models.
fn compose_model(
    root: &mut Element,
    directory: &Path,
    shared: &mut Shared,
) -> Result<Settings, LoadError> {
    let source = shared.sources.add(root, directory, shared.spending)?;
    let models = Models::read(root, shared)?;
    let (options, others) = std::mem::take(&mut root.children)
        .into_iter()
        .partition(|section| section.tag == "option");
    root.children = others;
    let mut composer = Composer {
        models,
        source,
        names: Names::default(),
        settings: Settings(options),
        lists: take_lists(root),
        worlds: Vec::new(),
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
    Ok(settings)
}

/// Takes the sections whose elements can be copied out of a model, each kind as one.
fn take_lists(root: &mut Element) -> Vec<Element> {
    let kinds = relations::FOLLOWING.iter().chain(&["asset", "keyframe"]);
    let mut lists = Vec::new();
    for &kind in kinds {
        let mut list = Element::in_place_of(root, kind);
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

/// Expands the body tree of one model.
struct Composer<'a, 's> {
    models: Models,
    /// The model's own settings.
    source: usize,
    names: Names,
    settings: Settings,
    /// Its sections outside the tree that can grow.
    lists: Vec<Element>,
    /// Those parts of the world that are expanded.
    worlds: Vec<Element>,
    shared: &'a mut Shared<'s>,
}

/// An element of the tree whose children are being expanded.
struct Level {
    element: Element,
    left: std::vec::IntoIter<Element>,
}

impl Level {
    fn new(mut element: Element) -> Self {
        Level {
            left: std::mem::take(&mut element.children).into_iter(),
            element,
        }
    }
}

impl Composer<'_, '_> {
    fn add_list_names(&mut self) {
        for list in &self.lists {
            for element in &list.children {
                self.names.add(&list.tag, element);
            }
        }
    }

    fn list(&mut self, section: &str) -> &mut Vec<Element> {
        let found = self.lists.iter().position(|list| list.tag == section);
        &mut self.lists[found.unwrap_or_default()].children
    }

    /// Expands one `<worldbody>`.
    fn expand(&mut self, world: Element) -> Result<(), LoadError> {
        let mut open = vec![Level::new(world)];
        while let Some(level) = open.last_mut() {
            let Some(child) = level.left.next() else {
                let Some(Level { element, .. }) = open.pop() else {
                    break;
                };
                let expanded = match element.tag.as_str() {
                    "replicate" => self.replicate(element)?,
                    _ => vec![element],
                };
                match open.last_mut() {
                    Some(around) => around.element.children.extend(expanded),
                    None => self.worlds.extend(expanded),
                }
                continue;
            };
            self.names.add("worldbody", &child);
            if child.tag == "attach" {
                let attached = self.attach(&child, &open)?;
                if let Some(around) = open.last_mut() {
                    around.element.children.push(attached);
                }
            } else {
                open.push(Level::new(child));
            }
        }
        Ok(())
    }

    /// Copies the elements of a section that follow a part of the tree into a namespace.
    fn copy_following(
        &mut self,
        at: &Element,
        section: &str,
        from: &[&Element],
        namespace: &names::Namespace,
    ) -> Result<Vec<usize>, LoadError> {
        let mut copied = Vec::new();
        for element in from {
            let Some(copy) = relations::copy(section, element, namespace, &self.names) else {
                continue;
            };
            self.shared.charge(at, &copy)?;
            self.names.add(section, &copy);
            let list = self.list(section);
            copied.push(list.len());
            list.push(copy);
        }
        Ok(copied)
    }
}

/// Refuses a copy that would stand too deep.
fn check_depth(at: &Element, around: usize, what: &Element) -> Result<(), LoadError> {
    let (mut deepest, mut pending) = (0, vec![(what, around + 1)]);
    while let Some((element, depth)) = pending.pop() {
        deepest = deepest.max(depth);
        pending.extend(element.children.iter().map(|child| (child, depth + 1)));
    }
    match deepest > MAX_DEPTH {
        true => Err(at.error(document::too_deep())),
        false => Ok(()),
    }
}
