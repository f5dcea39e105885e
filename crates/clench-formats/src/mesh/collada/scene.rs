//! `<visual_scene>`: the meshes and their transforms.

use super::file::{File, at, child, children};
use super::transform;
use crate::mesh::affine::Transform;
use roxmltree::Node;

/// The maximum nesting depth of nodes, including node instances.
const MAX_DEPTH: usize = 64;
/// The maximum number of nodes, counting each instance.
const MAX_NODES: usize = 100_000;

/// A mesh of the scene.
pub(super) struct Instance<'a> {
    pub geometry: Node<'a, 'a>,
    pub transform: Transform,
}

/// Returns all meshes of the file's scene: of the first scene if the file names none, and each mesh once if it has
/// none.
///
/// # Errors
/// Returns an error if a mesh is missing or deformed by a skeleton, or nodes are too many or too deep.
pub(super) fn instances<'a>(
    file: &File<'a>,
    root: Node<'a, 'a>,
) -> Result<Vec<Instance<'a>>, String> {
    let said = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let first = || child(child(root, "library_visual_scenes")?, "visual_scene");
    let scene = match said {
        Some(said) => Some(file.referred(said)?),
        None => first(),
    };
    match scene {
        Some(scene) => below(file, scene),
        None => {
            let library = child(root, "library_geometries").into_iter();
            let all = library.flat_map(|library| children(library, "geometry"));
            Ok(all
                .map(|geometry| Instance {
                    geometry,
                    transform: Transform::IDENTITY,
                })
                .collect())
        }
    }
}

/// A node to visit, with the transform of its parent.
struct Pending<'a> {
    node: Node<'a, 'a>,
    parent: Transform,
    depth: usize,
}

/// Returns the meshes of all nodes below a scene, in order.
fn below<'a>(file: &File<'a>, scene: Node<'a, 'a>) -> Result<Vec<Instance<'a>>, String> {
    let (mut found, mut visited) = (Vec::new(), 0);
    let mut pending = vec![Pending {
        node: scene,
        parent: Transform::IDENTITY,
        depth: 0,
    }];
    while let Some(Pending {
        node,
        parent,
        depth,
    }) = pending.pop()
    {
        visited += 1;
        if depth > MAX_DEPTH || visited > MAX_NODES {
            return Err(at(
                node,
                "nodes are nested too deeply, or there are too many",
            ));
        }
        let transform = parent * transform::of_node(node)?;
        let mut inner = Vec::new();
        for element in node.children().filter(Node::is_element) {
            let node = match element.tag_name().name() {
                "instance_geometry" => {
                    let geometry = file.referred(element)?;
                    found.push(Instance {
                        geometry,
                        transform,
                    });
                    continue;
                }
                "instance_controller" => {
                    return Err(at(
                        element,
                        "meshes that a skeleton deforms are not supported",
                    ));
                }
                "node" => element,
                "instance_node" => file.referred(element)?,
                _ => continue,
            };
            inner.push(Pending {
                node,
                parent: transform,
                depth: depth + 1,
            });
        }
        pending.extend(inner.into_iter().rev());
    }
    Ok(found)
}
