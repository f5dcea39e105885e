//! The elements and attributes of MJCF (MuJoCo 4.0) and what this reader does with each.
//!
//! A rule belongs to an element name, or to `parent/name` where the parent gives the name a meaning of its own. An
//! attribute under `later` may carry the value with which it does nothing (`adhesion=0`); that value is accepted.

mod actuators;
mod assets;
mod relations;
mod top;
mod tree;
mod visual;

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
const fn ignored(element: &'static str, attributes: &'static str, children: &'static str) -> Rule {
    Rule {
        element,
        ignored: attributes,
        children,
        ..NONE
    }
}

/// A section: it holds elements and has no attributes.
const fn section(
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

/// One rule an element.
pub(crate) fn rules() -> impl Iterator<Item = &'static Rule> {
    let files = [
        top::RULES,
        tree::RULES,
        relations::RULES,
        actuators::RULES,
        assets::RULES,
        visual::RULES,
    ];
    files.into_iter().flatten()
}
