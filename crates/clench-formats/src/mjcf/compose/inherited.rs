//! Assets that elements of an attached model inherit from default classes. The classes name them without the prefix of
//! the attachment.

use super::shared::Shared;
use crate::error::LoadError;
use crate::mjcf::defaults::MAIN;
use crate::mjcf::document::Element;

/// Gives the elements of a composed model the attributes for assets that they inherit, so that attachment renames them.
pub(super) fn write_assets(root: &mut Element, shared: &mut Shared) -> Result<(), LoadError> {
    for section in &mut root.children {
        match section.tag.as_str() {
            "worldbody" => write_in_tree(section, MAIN, shared)?,
            "asset" | "tendon" => {
                for element in &mut section.children {
                    let class = class_of(element, "class", MAIN, shared)?;
                    write(element, class, shared)?;
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Gives these attributes to an element of the tree and to its descendants; `class` applies to elements without one.
fn write_in_tree(
    element: &mut Element,
    class: usize,
    shared: &mut Shared,
) -> Result<(), LoadError> {
    let own = class_of(element, "class", class, shared)?;
    write(element, own, shared)?;
    let inner = if element.tag == "frame" { own } else { class };
    let inner = class_of(element, "childclass", inner, shared)?;
    for child in &mut element.children {
        write_in_tree(child, inner, shared)?;
    }
    Ok(())
}

fn class_of(
    element: &Element,
    attribute: &str,
    otherwise: usize,
    shared: &Shared,
) -> Result<usize, LoadError> {
    let classes = &shared.sources.of(element).classes;
    classes.named_by(element, attribute, otherwise)
}

fn write(element: &mut Element, class: usize, shared: &mut Shared) -> Result<(), LoadError> {
    let assets = shared.sources.of(element).classes[class].assets_of(&element.tag);
    let missing =
        |(attribute, name): &(&str, &str)| !name.is_empty() && element.text(attribute).is_none();
    let assets = assets.into_iter().filter(missing);
    let assets: Vec<_> = assets
        .map(|(attribute, name)| (attribute.to_owned(), name.to_owned()))
        .collect();
    for asset in assets {
        let bytes = size_of::<(String, String)>() + asset.0.len() + asset.1.len();
        let spent = shared.spending.bytes(bytes as u64);
        spent.map_err(|excess| element.error(excess))?;
        element.attributes.push(asset);
    }
    Ok(())
}
