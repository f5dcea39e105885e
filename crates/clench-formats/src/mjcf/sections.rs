//! The sections of a file, and their elements.

use crate::document::Element;

/// Returns the sections of a kind, in order.
pub(super) fn sections<'a>(root: &'a Element, tag: &str) -> impl Iterator<Item = &'a Element> {
    root.children
        .iter()
        .filter(move |section| section.tag == tag)
}

/// Returns the elements in all sections of a kind.
pub(super) fn entries<'a>(root: &'a Element, tag: &str) -> impl Iterator<Item = &'a Element> {
    sections(root, tag).flat_map(|section| &section.children)
}
