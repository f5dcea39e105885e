//! The elements and attributes of MJCF (MuJoCo 4.0) and what this reader does with each.
//!
//! A rule belongs to an element name, or to `parent/name` where the parent gives the name a meaning of its own. An
//! attribute under `later` may carry the value with which it does nothing (`adhesion=0`); that value is accepted.

pub(crate) use rule::{NONE, Rule};

use super::equality;

mod actuators;
mod assets;
mod relations;
pub(super) mod rule;
mod top;
mod tree;
mod visual;

/// One rule an element.
pub(crate) fn rules() -> impl Iterator<Item = &'static Rule> {
    let files = [
        top::RULES,
        tree::RULES,
        relations::RULES,
        equality::RULES,
        actuators::RULES,
        assets::RULES,
        visual::RULES,
    ];
    files.into_iter().flatten()
}
