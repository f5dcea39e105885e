//! From names to indices.

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
    /// From the elements in the model's order.
    ///
    /// # Errors
    /// A name that is taken already.
    pub(super) fn new<E: Element + 'a>(
        elements: impl IntoIterator<Item = &'a E>,
    ) -> Result<Self, BuildError> {
        let mut indices = HashMap::new();
        for (index, element) in elements.into_iter().enumerate() {
            let name = element.name();
            if !name.is_empty() && indices.insert(name, index).is_some() {
                return Err(element.error("this name is taken already"));
            }
        }
        Ok(Names {
            kind: E::KIND,
            indices,
        })
    }

    /// The index of a name that `user` refers to.
    ///
    /// # Errors
    /// No element of this kind has that name.
    pub(super) fn find(&self, name: &str, user: &impl Element) -> Result<usize, BuildError> {
        self.indices.get(name).copied().ok_or_else(|| {
            user.error(match name {
                "" => format!("names no {}", self.kind),
                name => format!("there is no {} \"{name}\"", self.kind),
            })
        })
    }
}

/// Every kind of element that others refer to.
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
    /// Names of a model whose bodies come in `order`.
    ///
    /// # Errors
    /// A name that two elements of one kind share, those included that nothing refers to.
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

/// The first body is the world, whatever else it is called.
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
