//! Hints about ignored elements and attributes with names similar to supported ones.

use crate::document::Element;
use crate::mjcf::schema::suggestion;

/// The supported attributes and children of each element.
const SUPPORTED: [(&str, &[&str], &[&str]); 21] = [
    ("robot", &["name"], &["link", "joint", "material", "mujoco"]),
    ("link", &["name"], &["inertial", "collision", "visual"]),
    ("inertial", &[], &["origin", "mass", "inertia"]),
    ("origin", &["xyz", "rpy"], &[]),
    ("mass", &["value"], &[]),
    ("inertia", &["ixx", "iyy", "izz", "ixy", "ixz", "iyz"], &[]),
    ("collision", &["name"], &["origin", "geometry"]),
    ("visual", &["name"], &["origin", "geometry", "material"]),
    (
        "geometry",
        &[],
        &["box", "cylinder", "sphere", "capsule", "mesh"],
    ),
    ("box", &["size"], &[]),
    ("cylinder", &["radius", "length"], &[]),
    ("sphere", &["radius"], &[]),
    ("capsule", &["radius", "length"], &[]),
    ("mesh", &["filename", "scale"], &[]),
    (
        "joint",
        &["name", "type"],
        &[
            "origin", "parent", "child", "axis", "limit", "dynamics", "mimic",
        ],
    ),
    ("parent", &["link"], &[]),
    ("child", &["link"], &[]),
    ("axis", &["xyz"], &[]),
    ("limit", &["lower", "upper", "effort", "velocity"], &[]),
    ("dynamics", &["damping", "friction"], &[]),
    ("mimic", &["joint", "multiplier", "offset"], &[]),
];

/// The maximum number of notes; further mistakes are probably of the same kind.
const MAX_NOTES: usize = 20;
/// The maximum number of names to compare with known ones.
const MAX_COMPARED: usize = 10_000;

/// Notes each name below a robot that is probably a misspelling of a supported one.
pub(super) fn collect(root: &Element, notes: &mut Vec<String>) {
    let mut compared = 0;
    let mut pending = vec![("robot", root)];
    while let Some((tag, element)) = pending.pop() {
        let Some((_, attributes, children)) =
            SUPPORTED.iter().find(|(supported, ..)| *supported == tag)
        else {
            continue;
        };
        let mut check = |what: String, name: &str, names: &[&str], line: u32| {
            if names.contains(&name) || compared >= MAX_COMPARED {
                return;
            }
            compared += 1;
            let hint = suggestion(name, names.iter().copied());
            if !hint.is_empty() && notes.len() < MAX_NOTES {
                let of = element.label();
                notes.push(format!("line {line}: {what} of {of} is ignored{hint}"));
            }
        };
        for (name, _) in &element.attributes {
            let what = format!("the attribute \"{name}\"");
            check(what, name, attributes, element.origin.line);
        }
        for child in &element.children {
            let what = format!("<{}>", child.tag);
            check(what, &child.tag, children, child.origin.line);
        }
        let read = |child: &&Element| children.contains(&child.tag.as_str());
        let below = element.children.iter().filter(read);
        pending.extend(below.rev().map(|child| (child.tag.as_str(), child)));
    }
}
