//! Names: those of elements, their references, and the effect of a namespace on both.

use crate::mjcf::document::Element;
use std::collections::HashMap;

/// Kinds of elements that others refer to by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Body,
    Joint,
    Geom,
    Site,
    Camera,
    Tendon,
    Actuator,
    Sensor,
    Mesh,
}

/// Attributes that refer to an element of one kind.
const REFERENCES: &[(&str, Kind)] = &[
    ("joint", Kind::Joint),
    ("jointinparent", Kind::Joint),
    ("joint1", Kind::Joint),
    ("joint2", Kind::Joint),
    ("body", Kind::Body),
    ("body1", Kind::Body),
    ("body2", Kind::Body),
    ("subtree1", Kind::Body),
    ("subtree2", Kind::Body),
    ("geom", Kind::Geom),
    ("geom1", Kind::Geom),
    ("geom2", Kind::Geom),
    ("site", Kind::Site),
    ("site1", Kind::Site),
    ("site2", Kind::Site),
    ("sidesite", Kind::Site),
    ("refsite", Kind::Site),
    ("cranksite", Kind::Site),
    ("slidersite", Kind::Site),
    ("camera", Kind::Camera),
    ("tendon", Kind::Tendon),
    ("tendon1", Kind::Tendon),
    ("tendon2", Kind::Tendon),
    ("actuator", Kind::Actuator),
];

/// Attributes that refer to an element of the kind given by another attribute.
const TYPED_REFERENCES: &[(&str, &str)] = &[("objname", "objtype"), ("refname", "reftype")];

/// The values of those other attributes.
const TYPES: &[(&str, Kind)] = &[
    ("body", Kind::Body),
    ("xbody", Kind::Body),
    ("joint", Kind::Joint),
    ("geom", Kind::Geom),
    ("site", Kind::Site),
    ("camera", Kind::Camera),
    ("tendon", Kind::Tendon),
    ("actuator", Kind::Actuator),
    ("sensor", Kind::Sensor),
];

/// The body that has the same name in every model.
const WORLD: &str = "world";

/// Returns true if a name means that body; a site or a geom may have the same name.
pub(super) fn is_world(kind: Kind, name: &str) -> bool {
    kind == Kind::Body && name == WORLD
}

fn lookup<V: Copy>(table: &[(&str, V)], key: &str) -> Option<V> {
    let found = table.iter().find(|(name, _)| *name == key);
    found.map(|(_, value)| *value)
}

/// A reference of an element: the index of the attribute, and the kind of its target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    pub attribute: usize,
    pub kind: Kind,
}

/// Returns the references in an element's own attributes.
pub(super) fn references(element: &Element) -> Vec<Reference> {
    let kind = |name: &str| {
        let typed = || element.text(lookup(TYPED_REFERENCES, name)?);
        lookup(REFERENCES, name).or_else(|| lookup(TYPES, typed()?))
    };
    let attributes = element.attributes.iter().enumerate();
    attributes
        .filter_map(|(attribute, (name, _))| kind(name).map(|kind| Reference { attribute, kind }))
        .collect()
}

/// Returns the kind by which others refer to an element, from its section and tag.
pub(super) fn kind_of(section: &str, tag: &str) -> Option<Kind> {
    match (section, tag) {
        ("worldbody", "body") => Some(Kind::Body),
        ("worldbody", "joint" | "freejoint") => Some(Kind::Joint),
        ("worldbody", "geom") => Some(Kind::Geom),
        ("worldbody", "site") => Some(Kind::Site),
        ("worldbody", "camera") => Some(Kind::Camera),
        ("tendon", _) => Some(Kind::Tendon),
        ("actuator", _) => Some(Kind::Actuator),
        ("sensor", _) => Some(Kind::Sensor),
        ("asset", "mesh") => Some(Kind::Mesh),
        _ => None,
    }
}

/// The prefix and suffix of the names of attached or replicated elements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Namespace<'a> {
    pub prefix: &'a str,
    pub suffix: &'a str,
    /// True if the elements come from another model, so that their assets are renamed as well.
    pub foreign: bool,
}

impl Namespace<'_> {
    pub(super) fn apply(&self, name: &str) -> String {
        format!("{}{name}{}", self.prefix, self.suffix)
    }

    /// Like [`apply`](Self::apply), for a name that refers to an element.
    pub(super) fn refer(&self, kind: Kind, name: &str) -> String {
        match is_world(kind, name) {
            true => name.to_owned(),
            false => self.apply(name),
        }
    }

    /// Renames an element, but not its references; an unnamed one is unchanged.
    pub(super) fn rename(&self, element: &mut Element) {
        self.rename_attribute(element, "name");
    }

    fn rename_attribute(&self, element: &mut Element, attribute: &str) {
        let found = (element.attributes.iter_mut()).find(|(name, _)| name == attribute);
        if let Some((_, value)) = found.filter(|(_, value)| !value.is_empty()) {
            *value = self.apply(value);
        }
    }

    /// Renames an element of the body tree and its descendants, with their references.
    pub(super) fn rename_tree(&self, element: &mut Element) {
        self.rename(element);
        self.rename_attribute(element, "target");
        self.rename_assets_of(element);
        for child in &mut element.children {
            self.rename_tree(child);
        }
    }

    /// Renames the assets that an element of another model refers to.
    pub(super) fn rename_assets_of(&self, element: &mut Element) {
        if self.foreign {
            for asset in ["mesh", "hfield", "material", "texture"] {
                self.rename_attribute(element, asset);
            }
        }
    }

    /// Renames an asset of another model, with its references to assets. An asset without a name gets that of its file.
    pub(super) fn rename_asset(&self, element: &mut Element) {
        if element.text("name").is_none_or(str::is_empty) {
            let file = element.text("file").unwrap_or_default().replace('\\', "/");
            let last = file.rsplit('/').next().unwrap_or_default();
            let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem);
            let stem = stem.to_owned();
            element.attributes.retain(|(name, _)| name != "name");
            element.attributes.push(("name".to_owned(), stem));
        }
        self.rename(element);
        for asset in ["material", "texture"] {
            self.rename_attribute(element, asset);
        }
        for layer in &mut element.children {
            self.rename_attribute(layer, "texture");
        }
    }
}

/// The names in use, with their numbers of elements.
#[derive(Debug, Default)]
pub(super) struct Names(HashMap<(Kind, String), usize>);

impl Names {
    /// Adds the name of an element in a section.
    pub(super) fn add(&mut self, section: &str, element: &Element) {
        if let Some(key) = key(section, element) {
            *self.0.entry(key).or_default() += 1;
        }
    }

    /// Removes the name of an element in a section.
    pub(super) fn remove(&mut self, section: &str, element: &Element) {
        let Some(key) = key(section, element) else {
            return;
        };
        if let Some(count) = self.0.get_mut(&key) {
            *count -= 1;
            if *count == 0 {
                self.0.remove(&key);
            }
        }
    }

    /// Adds the names of an element and its descendants.
    pub(super) fn add_tree(&mut self, element: &Element) {
        self.add("worldbody", element);
        for child in &element.children {
            self.add_tree(child);
        }
    }

    /// Removes the names of an element and its descendants.
    pub(super) fn remove_tree(&mut self, element: &Element) {
        self.remove("worldbody", element);
        for child in &element.children {
            self.remove_tree(child);
        }
    }

    /// Returns true if the element exists.
    pub(super) fn has(&self, kind: Kind, name: &str) -> bool {
        is_world(kind, name) || self.0.contains_key(&(kind, name.to_owned()))
    }
}

fn key(section: &str, element: &Element) -> Option<(Kind, String)> {
    let name = element.text("name").filter(|name| !name.is_empty())?;
    Some((kind_of(section, &element.tag)?, name.to_owned()))
}
