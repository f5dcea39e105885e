//! What an element may have.

/// What an element may have; every field is a list of words.
#[derive(Debug)]
pub(crate) struct Rule {
    pub element: &'static str,
    /// Attributes that are read.
    pub read: &'static str,
    /// Attributes that do not act on motion. What some of them say of colours and surfaces is kept for viewers.
    pub ignored: &'static str,
    /// Attributes that are not supported yet, each with the value that does nothing if there is one.
    pub later: &'static str,
    /// Children, in any number.
    pub children: &'static str,
    /// Children of which there can be only one.
    pub once: &'static str,
    /// Children that are not supported yet.
    pub later_children: &'static str,
}

pub(crate) const NONE: Rule = Rule {
    element: "",
    read: "",
    ignored: "",
    later: "",
    children: "",
    once: "",
    later_children: "",
};

/// An element that only matters to the eye, to memory or to a user's program.
pub(in crate::mjcf) const fn ignored(
    element: &'static str,
    attributes: &'static str,
    children: &'static str,
) -> Rule {
    Rule {
        element,
        ignored: attributes,
        children,
        ..NONE
    }
}

/// A section: it holds elements and has no attributes.
pub(in crate::mjcf) const fn section(
    element: &'static str,
    children: &'static str,
    later_children: &'static str,
) -> Rule {
    Rule {
        element,
        children,
        later_children,
        ..NONE
    }
}
