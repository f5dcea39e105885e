//! Resolution of names to indices.

use super::element::Element;
use super::model_builder::ModelBuilder;
use super::uses::GeomUses;
use super::{BodySpec, BuildError, GeomSpec};
use std::collections::HashMap;

/// The named elements of one kind.
pub(super) struct Names<'a> {
    kind: &'static str,
    indices: HashMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    /// Collects the names of elements in the model's order.
    ///
    /// # Errors
    /// Returns an error if a name is already used.
    pub(super) fn new<E: Element + 'a>(
        elements: impl IntoIterator<Item = &'a E>,
    ) -> Result<Self, BuildError> {
        let mut indices = HashMap::new();
        for (index, element) in elements.into_iter().enumerate() {
            let name = element.name();
            if !name.is_empty() && indices.insert(name, index).is_some() {
                return Err(element.error("this name is already in use"));
            }
        }
        Ok(Names {
            kind: E::KIND,
            indices,
        })
    }

    /// Returns the index of a name that `user` refers to.
    ///
    /// # Errors
    /// Returns an error if no element of this kind has that name.
    pub(super) fn find(&self, name: &str, user: &impl Element) -> Result<usize, BuildError> {
        self.indices.get(name).copied().ok_or_else(|| {
            user.error(match name {
                "" => format!("names no {}", self.kind),
                name => format!("there is no {} \"{name}\"", self.kind),
            })
        })
    }
}

/// The named elements of every kind that others refer to.
pub(super) struct AllNames<'a> {
    pub bodies: Names<'a>,
    pub joints: Names<'a>,
    pub geoms: Names<'a>,
    pub sites: Names<'a>,
    pub cameras: Names<'a>,
    pub tendons: Names<'a>,
    pub actuators: Names<'a>,
}

impl<'a> AllNames<'a> {
    /// Collects the names of a model whose bodies come in `order`.
    ///
    /// # Errors
    /// Returns an error if two elements of one kind share a name, even if nothing refers to it.
    pub(super) fn new(builder: &'a ModelBuilder, order: &[usize]) -> Result<Self, BuildError> {
        let in_order = || order.iter().map(|&b| &builder.bodies[b]);
        let uses = GeomUses::of(builder);
        let kept = |geom: &&GeomSpec| !uses.is_discarded(geom);
        Names::new(&builder.sensors)?;
        Names::new(&builder.equalities)?;
        Names::new(&builder.pairs)?;
        Names::new(&builder.excludes)?;
        Names::new(&builder.keyframes)?;
        Ok(AllNames {
            bodies: body_names(in_order())?,
            joints: Names::new(in_order().flat_map(|b| &b.joints))?,
            geoms: Names::new(in_order().flat_map(|b| &b.geoms).filter(kept))?,
            sites: Names::new(in_order().flat_map(|b| &b.sites))?,
            cameras: Names::new(in_order().flat_map(|b| &b.cameras))?,
            tendons: Names::new(&builder.tendons)?,
            actuators: Names::new(&builder.actuators)?,
        })
    }
}

/// Collects the names of bodies. The first is always also the world.
fn body_names<'a>(bodies: impl Iterator<Item = &'a BodySpec>) -> Result<Names<'a>, BuildError> {
    let mut names = Names::new(bodies)?;
    if let Some(&other) = names.indices.get("world")
        && other != 0
    {
        return Err(BuildError::new(
            "body \"world\"",
            "this name belongs to the first body",
        ));
    }
    names.indices.insert("world", 0);
    Ok(names)
}
