//! `<attach>`: attaches a body, a frame or the whole world of another model, or a body or frame of this one.

use super::composer::{Composer, Level, check_depth};
use super::models::Part;
use super::names::Namespace;
use super::relations::{FOLLOWING, follows};
use super::replicate::drop_inertia;
use super::settings::Settings;
use crate::error::LoadError;
use crate::mjcf::compiler::Conflict;
use crate::mjcf::document::Element;
use crate::mjcf::schema;
use crate::mjcf::sections::sections;

impl Composer<'_, '_> {
    /// Returns the replacement of an `<attach>` inside these elements.
    pub(super) fn attach(
        &mut self,
        element: &Element,
        open: &[Level],
    ) -> Result<Element, LoadError> {
        element.at_most_one(&["body", "frame"])?;
        let prefix = element.required_text("prefix")?;
        let wanted = ["body", "frame"]
            .iter()
            .find_map(|tag| Some((*tag, element.text(tag)?)));
        let namespace = Namespace {
            prefix,
            suffix: "",
            foreign: element.text("model").is_some(),
        };
        let models = std::mem::take(&mut self.models);
        let result = match element.text("model") {
            Some(name) => match models.find(name) {
                Some(model) => self.attach_model(element, model, wanted, &namespace, open.len()),
                None => {
                    let names = models.0.iter().map(|(name, _)| name.as_str());
                    let hint = schema::suggestion(name, names);
                    Err(element.error(format!(
                        "there is no model \"{name}\" among the assets{hint}"
                    )))
                }
            },
            None => self.attach_own(element, wanted, &namespace, open),
        };
        self.models = models;
        result
    }

    fn attach_model(
        &mut self,
        element: &Element,
        part: &Part,
        wanted: Option<(&str, &str)>,
        namespace: &Namespace,
        depth: usize,
    ) -> Result<Element, LoadError> {
        self.merge_options(element, &part.settings)?;
        let model = &part.root;
        let mut frame = Element::with_location_of(model, "frame");
        let class = match wanted {
            None => {
                let worlds = sections(model, "worldbody").flat_map(|world| &world.children);
                for part in worlds {
                    self.shared.consume(element, part)?;
                    frame.children.push(part.clone());
                }
                None
            }
            Some((tag, name)) => {
                let mut found = None;
                for world in sections(model, "worldbody") {
                    found = found.or_else(|| find(world, tag, name, None));
                }
                let (part, class) = found.ok_or_else(|| {
                    let message = format!("there is no {tag} \"{name}\" in the attached model");
                    element.error(message)
                })?;
                self.shared.consume(element, part)?;
                frame.children.push(part.clone());
                class
            }
        };
        self.finish(element, &mut frame, class, namespace, depth)?;
        self.shared
            .sources
            .lend_classes(
                model.source,
                self.source,
                namespace.prefix,
                self.shared.spending,
            )
            .map_err(|excess| element.error(excess))?;
        let own = ["tendon", "actuator"].map(|section| self.list(section).len());
        // Sensors that follow refer to assets.
        let is_asset = |section: &&Element| section.tag == "asset";
        let assets = model.children.iter().filter(is_asset);
        let others = model.children.iter().filter(|section| !is_asset(section));
        for section in assets.chain(others) {
            self.copy_section(element, section, namespace)?;
        }
        self.attach_keyframes(element, part, &mut frame, own, namespace)?;
        Ok(frame)
    }

    /// Copies a section of an attached model outside its tree.
    fn copy_section(
        &mut self,
        at: &Element,
        section: &Element,
        namespace: &Namespace,
    ) -> Result<(), LoadError> {
        let tag = section.tag.as_str();
        let excess = |excess| at.error(excess);
        self.shared
            .spending
            .elements(section.children.len() as u64)
            .map_err(excess)?;
        if FOLLOWING.contains(&tag) {
            let from: Vec<&Element> = section.children.iter().collect();
            self.copy_following(at, tag, &from, namespace)?;
        } else if tag == "asset" {
            for asset in section
                .children
                .iter()
                .filter(|asset| asset.tag != "model" && asset.tag != "skin")
            {
                self.shared.consume(at, asset)?;
                let mut copy = asset.clone();
                namespace.rename_asset(&mut copy);
                self.names.add(tag, &copy);
                self.list(tag).push(copy);
            }
        }
        Ok(())
    }

    /// Merges the options of an attached model as the conflict rule allows.
    fn merge_options(&mut self, element: &Element, options: &Settings) -> Result<(), LoadError> {
        if options.is_empty() {
            return Ok(());
        }
        let name = element.text("model").unwrap_or_default();
        let rule = self.shared.sources.of(element).compiler.conflict;
        let adopted = match rule {
            Conflict::Warning => Ok(Vec::new()),
            Conflict::Merge | Conflict::Error => self.settings.merge(options, rule),
        };
        let adopted = adopted.map_err(|what| {
            element.error(format!(
                "the options of the attached model \"{name}\" are in conflict with this model's: {what}"
            ))
        })?;
        self.add_note(match (rule, adopted.is_empty()) {
            (Conflict::Merge, true) => return Ok(()),
            (Conflict::Merge, false) => {
                let adopted = adopted.join(", ");
                format!("options adopted from the attached model \"{name}\": {adopted}")
            }
            _ => format!(
                "the options of the attached model \"{name}\" are omitted; those of the model itself apply"
            ),
        });
        Ok(())
    }

    fn add_note(&mut self, note: String) {
        if !self.shared.notes.contains(&note) {
            self.shared.notes.push(note);
        }
    }

    /// Attaches a part of the model itself that has been read.
    fn attach_own(
        &mut self,
        element: &Element,
        wanted: Option<(&str, &str)>,
        namespace: &Namespace,
        open: &[Level],
    ) -> Result<Element, LoadError> {
        let (tag, name) = wanted.ok_or_else(|| {
            element.error("either model, or a body or frame of this model must be given")
        })?;
        let (part, class) = self.find_own(element, tag, name, open)?;
        self.shared.consume(element, &part)?;
        let mut frame = Element::with_location_of(element, "frame");
        frame.children.push(part);
        self.finish(element, &mut frame, class.as_deref(), namespace, open.len())?;
        for section in FOLLOWING {
            let from = self.list(section).clone();
            let from: Vec<&Element> = from.iter().filter(|part| follows(section, part)).collect();
            self.copy_following(element, section, &from, namespace)?;
        }
        Ok(frame)
    }

    /// Copies a body or frame of the model itself that has been read; returns it with its enclosing class.
    fn find_own(
        &self,
        element: &Element,
        tag: &str,
        name: &str,
        open: &[Level],
    ) -> Result<(Element, Option<String>), LoadError> {
        let mut worlds = self.worlds.iter();
        if let Some((part, class)) = worlds.find_map(|world| find(world, tag, name, None)) {
            return Ok((part.clone(), class.map(str::to_owned)));
        }
        let mut enclosing_class = None;
        for (depth, level) in open.iter().enumerate() {
            let Some((part, class)) = find(&level.element, tag, name, enclosing_class) else {
                enclosing_class = class_within(&level.element).or(enclosing_class);
                continue;
            };
            let class = class.map(str::to_owned);
            if !std::ptr::eq(part, &level.element) {
                return Ok((part.clone(), class));
            }
            if open[depth..]
                .iter()
                .any(|level| level.element.tag == "replicate")
            {
                let message =
                    "an element cannot be attached within its own replicate: not supported yet";
                return Err(element.error(message));
            }
            let so_far = read_so_far(&open[depth..]);
            return Ok((so_far.unwrap_or_else(|| part.clone()), class));
        }
        let message = format!("there is no {tag} \"{name}\" before this in the model");
        Err(element.error(message))
    }

    /// Renames a copied part; elements in it without a class keep the default class of their origin.
    fn finish(
        &mut self,
        element: &Element,
        frame: &mut Element,
        class: Option<&str>,
        namespace: &Namespace,
        depth: usize,
    ) -> Result<(), LoadError> {
        check_depth(element, depth, frame)?;
        let class = class.unwrap_or("main").to_owned();
        frame.attributes.push(("childclass".to_owned(), class));
        drop_inertia(frame);
        for child in &mut frame.children {
            namespace.rename_tree(child);
            self.names.add_tree(child);
        }
        Ok(())
    }
}

/// Returns a body or frame by name, and its enclosing default class.
fn find<'a>(
    enclosing: &'a Element,
    tag: &str,
    name: &str,
    class: Option<&'a str>,
) -> Option<(&'a Element, Option<&'a str>)> {
    let mut pending = vec![(enclosing, class)];
    while let Some((element, class)) = pending.pop() {
        if element.tag == tag && element.text("name") == Some(name) {
            return Some((element, class));
        }
        let class = class_within(element).or(class);
        pending.extend(element.children.iter().rev().map(|child| (child, class)));
    }
    None
}

/// Returns the default class that a body or frame sets for its elements.
fn class_within(element: &Element) -> Option<&str> {
    let own = element.text("childclass");
    own.or_else(|| element.text("class").filter(|_| element.tag == "frame"))
}

/// Copies an element of the tree, up to the point of expansion.
fn read_so_far(open: &[Level]) -> Option<Element> {
    let mut inner: Option<Element> = None;
    for level in open.iter().rev() {
        let mut element = level.element.clone();
        element.children.extend(inner);
        inner = Some(element);
    }
    inner
}
