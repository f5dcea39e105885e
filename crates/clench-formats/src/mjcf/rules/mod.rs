//! The elements and attributes of MJCF (MuJoCo 4.0) and their treatment by this reader.
//!
//! A rule belongs to an element name, or to `parent/name` if the name has another meaning in that parent. An attribute
//! under `later` may carry the value without effect (`adhesion=0`); that value is accepted.

pub(crate) use rule::{NONE, Rule};

use super::equality;

mod actuators;
mod assets;
mod relations;
pub(super) mod rule;
mod top;
mod tree;
mod visual;

/// Returns all rules, one per element.
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
