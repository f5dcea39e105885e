//! The sections of a file, and what is in them.

use crate::document::Element;

/// The sections of a kind, in order.
pub(super) fn sections<'a>(root: &'a Element, tag: &str) -> impl Iterator<Item = &'a Element> {
    root.children
        .iter()
        .filter(move |section| section.tag == tag)
}

/// The elements in all sections of a kind.
pub(super) fn entries<'a>(root: &'a Element, tag: &str) -> impl Iterator<Item = &'a Element> {
    sections(root, tag).flat_map(|section| &section.children)
}
