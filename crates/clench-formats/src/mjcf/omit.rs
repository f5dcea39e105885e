//! Optional omission of elements that this library cannot simulate yet, with a report.
//!
//! Only an element that does not change the meaning of the others is omitted: a plugin, a deformable body, a sensor, a
//! force or a flag. Omitting a tendon or an actuator would change the controls and coordinates of the model, so those
//! are still rejected, and so are references to omitted elements.

use super::schema;
use crate::document::Element;

/// Elements that cannot be omitted.
const ESSENTIAL: &[&str] = &[
    "spatial",
    "fixed",
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "orientation",
    "pid",
    "muscle",
    "adhesion",
    "dcmotor",
];

/// Attributes that cannot be omitted, since they define what an element is or acts on.
const ESSENTIAL_ATTRIBUTES: &[&str] = &[
    "site",
    "refsite",
    "cranksite",
    "slidersite",
    "cranklength",
    "body",
    "mesh",
    "camera",
    "data",
];

/// Removes unsupported elements from a document, and adds a line about each.
pub(crate) fn omit(root: &mut Element, omitted: &mut Vec<String>) {
    let mut pending = vec![root];
    while let Some(element) = pending.pop() {
        let parent = element.tag.clone();
        element.children.retain_mut(|child| {
            let reason = unsupported(&parent, child);
            let Some(reason) = reason else {
                omit_attributes(&parent, child, omitted);
                return true;
            };
            omitted.push(child.error(reason).to_string());
            false
        });
        pending.extend(element.children.iter_mut().rev());
    }
}

/// Returns the reason to omit an element, if any.
fn unsupported(parent: &str, element: &Element) -> Option<String> {
    let tag = element.tag.as_str();
    let later = schema::is_later(parent, tag) && (parent == "default" || !ESSENTIAL.contains(&tag));
    let of_a_plugin =
        |element: &Element| element.children.iter().any(|child| child.tag == "plugin");
    let is_field = parent != "default" && element.text("type") == Some("sdf");
    let has_no_shape = tag == "mesh" && element.text("file").is_none() && of_a_plugin(element);
    let is_of_flex = parent == "equality" && element.text("flex").is_some();
    (later || is_field || has_no_shape || is_of_flex)
        .then(|| "is omitted: it is not supported yet".to_owned())
}

fn omit_attributes(parent: &str, element: &mut Element, omitted: &mut Vec<String>) {
    let is_omitted = |(name, value): &(String, String)| {
        let essential = ESSENTIAL_ATTRIBUTES.contains(&name.as_str());
        !essential && schema::is_later_attribute(parent, &element.tag, name, value)
    };
    let names: Vec<String> = (element.attributes.iter())
        .filter(|attribute| is_omitted(attribute))
        .map(|(name, _)| name.clone())
        .collect();
    for name in names {
        let note = format!("the attribute {name} is omitted: it is not supported yet");
        omitted.push(element.error(note).to_string());
        element.attributes.retain(|(other, _)| *other != name);
    }
}
