//! Bodies referenced by elements without effect on motion: MuJoCo does not fuse them into others.

use super::sections::entries;
use crate::document::Element;
use clench_builder::BodySpec;
use std::collections::HashSet;

/// Excludes bodies from fusion that are targets of cameras and lights, bones of skins, or elements of user tuples.
pub(crate) fn exclude_from_fusion(root: &Element, bodies: &mut [BodySpec]) {
    let mut names = HashSet::new();
    for section in ["worldbody", "asset", "custom"] {
        let mut pending: Vec<&Element> = entries(root, section).collect();
        while let Some(element) = pending.pop() {
            names.extend(match element.tag.as_str() {
                "camera" | "light" => element.text("target"),
                "bone" => element.text("body"),
                "element" if element.text("objtype") == Some("body") => element.text("objname"),
                _ => None,
            });
            pending.extend(&element.children);
        }
    }
    for body in bodies {
        body.never_fused |= names.contains(body.name.as_str());
    }
}
