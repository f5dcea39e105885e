//! `<default>`: classes of initial attribute values of elements.
//!
//! A class starts as a copy of its parent and overwrites what its elements give; an element starts as a copy of its
//! class. Copies, not a search for the nearest value, because an attribute with several numbers may give only some.

use super::actuator::ActuatorDraft;
use super::appearance;
use super::camera::CameraDraft;
use super::contact;
use super::equality::EqualityDraft;
use super::geom::GeomDraft;
use super::joint;
use super::light::LightDraft;
use super::mesh::MeshDraft;
use super::shortcut::{ActuatorParams, Shortcut};
use super::site::SiteDraft;
use super::tendon;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{JointSpec, MaterialSpec, PairSpec, TendonSpec};
use std::collections::HashMap;

/// A class: the initial values of each kind of element.
#[derive(Clone, Debug)]
pub(crate) struct Class {
    name: String,
    parent: Option<usize>,
    pub mesh: MeshDraft,
    pub material: MaterialSpec,
    pub joint: JointSpec,
    pub geom: GeomDraft,
    pub site: SiteDraft,
    pub camera: CameraDraft,
    pub light: LightDraft,
    pub pair: PairSpec,
    pub equality: EqualityDraft,
    pub tendon: TendonSpec,
    pub actuator: ActuatorDraft,
}

impl Class {
    /// Returns the assets that an element of the class refers to by default: the attributes and the names.
    pub(super) fn assets_of(&self, tag: &str) -> Vec<(&'static str, &str)> {
        let [mesh, hfield, material] = self.geom.assets();
        let [site_mesh, site_material] = self.site.assets();
        match tag {
            "geom" => vec![("mesh", mesh), ("hfield", hfield), ("material", material)],
            "site" => vec![("mesh", site_mesh), ("material", site_material)],
            "spatial" => vec![("material", &self.tendon.appearance.material)],
            "material" => vec![("texture", &self.material.texture)],
            _ => Vec::new(),
        }
    }
}

/// All classes of a model; the first is `main`, the root of all others.
#[derive(Debug)]
pub(crate) struct Classes {
    list: Vec<Class>,
    by_name: HashMap<String, usize>,
}

/// The class `main`.
pub(crate) const MAIN: usize = 0;

impl Default for Classes {
    fn default() -> Self {
        let main = Class {
            name: "main".to_owned(),
            parent: None,
            mesh: MeshDraft::default(),
            material: MaterialSpec::default(),
            joint: JointSpec::default(),
            geom: GeomDraft::default(),
            site: SiteDraft::default(),
            camera: CameraDraft::default(),
            light: LightDraft::default(),
            pair: contact::default_pair(),
            equality: EqualityDraft::default(),
            tendon: TendonSpec::default(),
            actuator: ActuatorDraft::default(),
        };
        Classes {
            by_name: HashMap::from([(main.name.clone(), MAIN)]),
            list: vec![main],
        }
    }
}

impl std::ops::Index<usize> for Classes {
    type Output = Class;
    fn index(&self, class: usize) -> &Class {
        &self.list[class]
    }
}

impl Classes {
    /// Reads one top-level `<default>`, which adds to the class `main`.
    pub(super) fn read(
        &mut self,
        element: &Element,
        spending: &mut Spending,
    ) -> Result<(), LoadError> {
        match element.text("class") {
            None | Some("" | "main") => {}
            Some(_) => return Err(element.error("the top-level default class is called \"main\"")),
        }
        // The classes whose own elements are read, each with its nested classes that remain to be read.
        let mut open = vec![(MAIN, self.read_own(element, MAIN)?)];
        while let Some((class, nested)) = open.last_mut() {
            let Some(child) = nested.next() else {
                open.pop();
                continue;
            };
            let class = self.derive(child, *class, spending)?;
            open.push((class, self.read_own(child, class)?));
        }
        Ok(())
    }

    /// Reads the elements of a class; returns its nested classes.
    fn read_own<'a>(
        &mut self,
        element: &'a Element,
        class: usize,
    ) -> Result<impl Iterator<Item = &'a Element> + use<'a>, LoadError> {
        for child in &element.children {
            self.read_element(child, class)?;
        }
        let nested = |child: &&Element| child.tag == "default";
        Ok(element.children.iter().filter(nested))
    }

    /// Adds a class as a copy of its parent.
    fn derive(
        &mut self,
        element: &Element,
        parent: usize,
        spending: &mut Spending,
    ) -> Result<usize, LoadError> {
        let name = element.text("class").unwrap_or_default();
        if name.is_empty() {
            return Err(element.incomplete("a nested default needs a class"));
        }
        if self.by_name.contains_key(name) {
            return Err(element.error(format!("the default class \"{name}\" exists already")));
        }
        let inherited = self.list[parent].geom.text_length();
        spending
            .bytes((size_of::<Class>() + 2 * name.len() + inherited) as u64)
            .map_err(|excess| element.error(excess))?;
        let class = self.list.len();
        self.by_name.insert(name.to_owned(), class);
        self.list.push(Class {
            name: name.to_owned(),
            parent: Some(parent),
            ..self.list[parent].clone()
        });
        Ok(class)
    }

    fn read_element(&mut self, element: &Element, class: usize) -> Result<(), LoadError> {
        if let Some(shortcut) = Shortcut::from_tag(&element.tag) {
            let parameters = self.parameters(class, shortcut);
            return self.list[class]
                .actuator
                .read(element, shortcut, parameters);
        }
        let class = &mut self.list[class];
        match element.tag.as_str() {
            "mesh" => class.mesh.read(element),
            "material" => appearance::read_material(element, &mut class.material),
            "joint" => joint::read(element, &mut class.joint),
            "geom" => class.geom.read(element),
            "site" => class.site.read(element),
            "camera" => class.camera.read(element),
            "light" => class.light.read(element),
            "pair" => contact::read_pair(element, &mut class.pair),
            "equality" => class.equality.read(element),
            "tendon" => tendon::read_common(element, &mut class.tendon),
            // Nested classes are read after all elements; the remaining elements are only visual (the schema admits no
            // others).
            _ => Ok(()),
        }
    }

    /// Returns the parameters that an actuator written with `shortcut` inherits from a class.
    pub(super) fn parameters(&self, class: usize, shortcut: Shortcut) -> ActuatorParams {
        let ancestors = std::iter::successors(Some(class), |&class| self.list[class].parent);
        ancestors
            .map(|class| &self.list[class].actuator)
            .find(|actuator| actuator.lends_parameters_to(shortcut))
            .map_or_else(ActuatorParams::default, |actuator| actuator.parameters)
    }

    /// Returns copies of all classes with prefixed names, for a model that attaches this one.
    ///
    /// # Errors
    /// Returns a message if they exceed the budget.
    pub(super) fn prefixed(
        &self,
        prefix: &str,
        spending: &mut Spending,
    ) -> Result<Vec<Class>, String> {
        for class in &self.list {
            let texts = prefix.len() + class.name.len() + class.geom.text_length();
            spending.bytes((size_of::<Class>() + 2 * texts) as u64)?;
        }
        let renamed = |class: &Class| Class {
            name: format!("{prefix}{}", class.name),
            ..class.clone()
        };
        Ok(self.list.iter().map(renamed).collect())
    }

    /// Adds classes of another model; of classes with the same name the first takes precedence.
    pub(super) fn borrow(&mut self, lent: Vec<Class>) {
        let first = self.list.len();
        for class in lent {
            let index = self.list.len();
            self.by_name.entry(class.name.clone()).or_insert(index);
            self.list.push(Class {
                parent: class.parent.map(|parent| first + parent),
                ..class
            });
        }
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Returns the class that an attribute of the element names, or `otherwise`.
    pub(super) fn named_by(
        &self,
        element: &Element,
        attribute: &str,
        otherwise: usize,
    ) -> Result<usize, LoadError> {
        let Some(name) = element.text(attribute) else {
            return Ok(otherwise);
        };
        self.find(name).ok_or_else(|| {
            let names = self.list.iter().map(|class| class.name.as_str());
            let hint = super::schema::suggestion(name, names);
            element.error(format!("there is no default class \"{name}\"{hint}"))
        })
    }

    /// Returns the class of an element outside the body tree.
    pub(super) fn of(&self, element: &Element) -> Result<&Class, LoadError> {
        Ok(&self.list[self.named_by(element, "class", MAIN)?])
    }
}
