//! Expansion of the body tree of one model.

use super::attached_keyframe::AttachedKeyframe;
use super::models::Models;
use super::names::{Names, Namespace};
use super::relations;
use super::settings::Settings;
use super::shared::Shared;
use crate::error::LoadError;
use crate::mjcf::document::{self, Element, MAX_DEPTH};

/// An expander of the body tree of one model.
pub(super) struct Composer<'a, 's> {
    pub models: Models,
    /// The index of the model's own settings.
    pub source: usize,
    pub names: Names,
    pub settings: Settings,
    /// The sections outside the tree that can grow.
    pub lists: Vec<Element>,
    /// The expanded parts of the world.
    pub worlds: Vec<Element>,
    /// The keyframes of attached models.
    pub keyframes: Vec<AttachedKeyframe>,
    pub shared: &'a mut Shared<'s>,
}

/// An element of the tree whose children are being expanded.
pub(super) struct Level {
    pub element: Element,
    pub remaining: std::vec::IntoIter<Element>,
}

impl Level {
    pub(super) fn new(mut element: Element) -> Self {
        Level {
            remaining: std::mem::take(&mut element.children).into_iter(),
            element,
        }
    }
}

impl Composer<'_, '_> {
    pub(super) fn add_list_names(&mut self) {
        for list in &self.lists {
            for element in &list.children {
                self.names.add(&list.tag, element);
            }
        }
    }

    pub(super) fn list(&mut self, section: &str) -> &mut Vec<Element> {
        let found = self.lists.iter().position(|list| list.tag == section);
        &mut self.lists[found.unwrap_or_default()].children
    }

    /// Expands one `<worldbody>`.
    pub(super) fn expand(&mut self, world: Element) -> Result<(), LoadError> {
        let mut open = vec![Level::new(world)];
        while let Some(level) = open.last_mut() {
            let Some(child) = level.remaining.next() else {
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

    /// Copies the elements of a section that belong to a part of the tree into a namespace.
    pub(super) fn copy_following(
        &mut self,
        at: &Element,
        section: &str,
        from: &[&Element],
        namespace: &Namespace,
    ) -> Result<Vec<usize>, LoadError> {
        let mut copied = Vec::new();
        for element in from {
            let Some(copy) = relations::copy(section, element, namespace, &self.names) else {
                continue;
            };
            self.shared.consume(at, &copy)?;
            self.names.add(section, &copy);
            let list = self.list(section);
            copied.push(list.len());
            list.push(copy);
        }
        Ok(copied)
    }
}

/// Rejects a copy that would be nested too deeply.
pub(super) fn check_depth(at: &Element, around: usize, what: &Element) -> Result<(), LoadError> {
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
