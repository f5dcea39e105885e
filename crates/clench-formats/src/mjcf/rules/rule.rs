//! The permitted content of an element.

/// The permitted content of an element; every field is a list of names.
#[derive(Debug)]
pub(crate) struct Rule {
    pub element: &'static str,
    /// Attributes that are read.
    pub read: &'static str,
    /// Attributes without effect on motion. Some, for colours and surfaces, are stored for viewers.
    pub ignored: &'static str,
    /// Attributes not supported yet, each with its value without effect, if any.
    pub later: &'static str,
    /// Repeatable children.
    pub children: &'static str,
    /// Children that may occur only once.
    pub once: &'static str,
    /// Children not supported yet.
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

/// Creates the rule of an element that only concerns appearance, memory or user programs.
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

/// Creates the rule of a section: elements and no attributes.
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
