//! What all elements of URDF share: only children, errors that say where, memory.

use crate::LoadError;
use crate::document::Element;
use crate::spending::Spending;

impl Element {
    /// The only child of that name.
    ///
    /// # Errors
    /// More than one.
    pub(super) fn child(&self, tag: &str) -> Result<Option<&Element>, LoadError> {
        let mut found = self.children.iter().filter(|child| child.tag == tag);
        let first = found.next();
        match found.next() {
            Some(second) => Err(second.error(format!("there can be only one in {}", self.label()))),
            None => Ok(first),
        }
    }

    /// The only child of that name, which must be there.
    pub(super) fn required_child(&self, tag: &str) -> Result<&Element, LoadError> {
        self.child(tag)?
            .ok_or_else(|| self.error(format!("the element <{tag}> is required")))
    }
}

/// An error inside of a link or joint, which says so.
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

/// Takes the memory of an element of this size with these texts.
pub(super) fn charge(
    element: &Element,
    size: usize,
    texts: &[&str],
    spending: &mut Spending,
) -> Result<(), LoadError> {
    /// What is read stands in the builder, in that of the fused bodies, then in the model.
    const COPIES: usize = 4;
    let texts: usize = texts.iter().map(|text| text.len()).sum();
    let charged = spending.bytes((COPIES * (size + texts)) as u64);
    charged.map_err(|excess| element.error(excess))
}
