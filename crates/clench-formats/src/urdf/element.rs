//! Common functions for URDF elements: unique children, error context, memory.

use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;

impl Element {
    /// Returns the only child of that name.
    ///
    /// # Errors
    /// Returns an error if there are several.
    pub(super) fn child(&self, tag: &str) -> Result<Option<&Element>, LoadError> {
        let mut found = self.children.iter().filter(|child| child.tag == tag);
        let first = found.next();
        match found.next() {
            Some(second) => Err(second.error(format!("there can be only one in {}", self.label()))),
            None => Ok(first),
        }
    }

    /// Returns the only child of that name, which is required.
    pub(super) fn required_child(&self, tag: &str) -> Result<&Element, LoadError> {
        self.child(tag)?
            .ok_or_else(|| self.error(format!("the element <{tag}> is required")))
    }
}

/// Adds the enclosing link or joint to an error.
pub(super) fn inside(outer: &Element) -> impl Fn(LoadError) -> LoadError {
    let label = outer.label();
    move |mut error| {
        error.element = error.element.map(|element| match element == label {
            true => element,
            false => format!("{element} of {label}"),
        });
        error
    }
}

/// Counts an element of this size with these texts against the budget.
pub(super) fn consume(
    element: &Element,
    size: usize,
    texts: &[&str],
    spending: &mut Spending,
) -> Result<(), LoadError> {
    /// Copies in the builder, in that of the fused bodies, and in the model.
    const COPIES: usize = 4;
    let texts: usize = texts.iter().map(|text| text.len()).sum();
    let consumed = spending.bytes((COPIES * (size + texts)) as u64);
    consumed.map_err(|excess| element.error(excess))
}
