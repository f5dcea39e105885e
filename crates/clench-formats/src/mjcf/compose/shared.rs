//! What all models of a composition share.

use crate::LoadError;
use crate::mjcf::document::Element;
use crate::mjcf::leave_out::leave_out;
use crate::mjcf::schema;
use crate::mjcf::source::Sources;
use crate::spending::Spending;
use std::path::PathBuf;

/// What all models of a composition share.
pub(super) struct Shared<'a> {
    pub sources: Sources,
    pub spending: &'a mut Spending,
    /// Folders of packages, where URDF files look for meshes.
    pub packages: &'a [PathBuf],
    /// The files of the models that are being read, the outermost first.
    pub open: Vec<PathBuf>,
    /// The number that was last given to an element.
    pub last_number: u32,
    pub notes: Vec<String>,
    /// What was left out because it is not supported yet, if it may be.
    pub left_out: Option<Vec<String>>,
}

impl Shared<'_> {
    /// Holds a document against the schema, after what can be left out is.
    pub(super) fn check(&mut self, root: &mut Element) -> Result<(), LoadError> {
        if let Some(left_out) = &mut self.left_out {
            leave_out(root, left_out);
        }
        schema::check(root)
    }

    /// A number that no element has.
    pub(super) fn next_number(&mut self) -> u32 {
        self.last_number += 1;
        self.last_number
    }

    /// Takes copies of an element and all in it, before they are made.
    pub(super) fn charge(&mut self, at: &Element, what: &Element) -> Result<(), LoadError> {
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
