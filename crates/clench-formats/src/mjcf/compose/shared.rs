//! The state shared by all models of a composition.

use crate::error::LoadError;
use crate::mjcf::document::Element;
use crate::mjcf::omit::omit;
use crate::mjcf::schema;
use crate::mjcf::source::Sources;
use crate::spending::Spending;
use std::path::PathBuf;

/// The state shared by all models of a composition.
pub(super) struct Shared<'a> {
    pub sources: Sources,
    pub spending: &'a mut Spending,
    /// The package folders in which URDF files look for meshes.
    pub packages: &'a [PathBuf],
    /// The files of the models being read, outermost first.
    pub open: Vec<PathBuf>,
    /// The last number assigned to an element.
    pub last_number: u32,
    pub notes: Vec<String>,
    /// The omitted unsupported elements; `None` if omission is not allowed.
    pub omitted: Option<Vec<String>>,
}

impl Shared<'_> {
    /// Checks a document against the schema, after any allowed omissions.
    pub(super) fn check(&mut self, root: &mut Element) -> Result<(), LoadError> {
        if let Some(omitted) = &mut self.omitted {
            omit(root, omitted);
        }
        schema::check(root)
    }

    /// Returns an unused element number.
    pub(super) fn next_number(&mut self) -> u32 {
        self.last_number += 1;
        self.last_number
    }

    /// Counts copies of an element and its descendants against the budget.
    pub(super) fn consume(&mut self, at: &Element, what: &Element) -> Result<(), LoadError> {
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
