//! `<default>`: classes of attribute values that elements start from.
//!
//! A class starts as a copy of its parent and overwrites what its elements give; an element starts as a copy of its
//! class. Copies, not a search for the nearest value, because an attribute with several numbers may give only some.

use super::actuator::{ActuatorDraft, Law, Shortcut};
use super::assets;
use super::contact;
use super::document::Element;
use super::equality::EqualityDraft;
use super::geom::GeomDraft;
use super::joint;
use super::mesh::MeshDraft;
use super::site::SiteDraft;
use super::tendon;
use crate::LoadError;
use clench_rigid::builder::{JointSpec, PairSpec, TendonSpec};

/// One class: what each kind of element starts as.
#[derive(Clone, Debug)]
pub(crate) struct Class {
    name: String,
    parent: Option<usize>,
    pub mesh: MeshDraft,
    /// Opacity of materials.
    pub material_alpha: f64,
    pub joint: JointSpec,
    pub geom: GeomDraft,
    pub site: SiteDraft,
    pub pair: PairSpec,
    pub equality: EqualityDraft,
    pub tendon: TendonSpec,
    pub actuator: ActuatorDraft,
}

/// All classes of a model; the first is `main`, which everything starts from.
#[derive(Clone, Debug)]
pub(crate) struct Classes(Vec<Class>);

/// The class `main`.
pub(crate) const MAIN: usize = 0;

impl Default for Classes {
    fn default() -> Self {
        Classes(vec![Class {
            name: "main".to_owned(),
            parent: None,
            mesh: MeshDraft::default(),
            material_alpha: 1.0,
            joint: JointSpec::default(),
            geom: GeomDraft::default(),
            site: SiteDraft::default(),
            pair: contact::default_pair(),
            equality: EqualityDraft::default(),
            tendon: TendonSpec::default(),
            actuator: ActuatorDraft::default(),
        }])
    }
}

impl std::ops::Index<usize> for Classes {
    type Output = Class;
    fn index(&self, class: usize) -> &Class {
        &self.0[class]
    }
}

impl Classes {
    /// Reads one top-level `<default>`, which is (more of) the class `main`.
    pub fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        match element.text("class") {
            None | Some("" | "main") => self.read_class(element, MAIN),
            Some(_) => Err(element.error("the top-level default class is called \"main\"")),
        }
    }

    fn read_class(&mut self, element: &Element, class: usize) -> Result<(), LoadError> {
        for child in &element.children {
            self.read_element(child, class)?;
        }
        for child in element
            .children
            .iter()
            .filter(|child| child.tag == "default")
        {
            let name = child.text("class").unwrap_or_default();
            if name.is_empty() {
                return Err(child.error("a nested default needs a class"));
            }
            if self.find(name).is_some() {
                return Err(child.error(format!("the default class \"{name}\" exists already")));
            }
            self.0.push(Class {
                name: name.to_owned(),
                parent: Some(class),
                ..self.0[class].clone()
            });
            self.read_class(child, self.0.len() - 1)?;
        }
        Ok(())
    }

    fn read_element(&mut self, element: &Element, class: usize) -> Result<(), LoadError> {
        if let Some(shortcut) = Shortcut::from_tag(&element.tag) {
            let law = self.law(class, shortcut);
            return self.0[class].actuator.read(element, shortcut, law);
        }
        let class = &mut self.0[class];
        match element.tag.as_str() {
            "mesh" => class.mesh.read(element),
            "material" => assets::read_alpha(element, &mut class.material_alpha),
            "joint" => joint::read(element, &mut class.joint),
            "geom" => class.geom.read(element),
            "site" => class.site.read(element),
            "pair" => contact::read_pair(element, &mut class.pair),
            "equality" => class.equality.read(element),
            "tendon" => tendon::read_common(element, &mut class.tendon),
            // Nested classes come after all elements; the rest is only seen (the schema lets nothing else through).
            _ => Ok(()),
        }
    }

    /// The law that a class lends to an actuator written with `shortcut`.
    pub fn law(&self, class: usize, shortcut: Shortcut) -> Law {
        let ancestors = std::iter::successors(Some(class), |&class| self.0[class].parent);
        ancestors
            .map(|class| &self.0[class].actuator)
            .find(|actuator| actuator.lends_law_to(shortcut))
            .map_or_else(Law::default, |actuator| actuator.law)
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|class| class.name == name)
    }

    /// The class that an attribute of the element names, or `otherwise`.
    pub fn named_by(
        &self,
        element: &Element,
        attribute: &str,
        otherwise: usize,
    ) -> Result<usize, LoadError> {
        let Some(name) = element.text(attribute) else {
            return Ok(otherwise);
        };
        self.find(name).ok_or_else(|| {
            let known = self.0.iter().map(|class| class.name.as_str());
            let hint = super::schema::suggestion(name, known);
            element.error(format!("there is no default class \"{name}\"{hint}"))
        })
    }

    /// The class of an element outside the body tree.
    pub fn of(&self, element: &Element) -> Result<&Class, LoadError> {
        Ok(&self.0[self.named_by(element, "class", MAIN)?])
    }
}
