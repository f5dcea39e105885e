//! Nodes: the meshes and their transforms.

use super::json::{Mesh, Node, Root};
use crate::mesh::affine::Transform;
use clench_math::Quat;

/// The maximum nesting depth of nodes.
const MAX_DEPTH: usize = 64;
/// The maximum number of nodes of a scene, counting each instance.
const MAX_NODES: usize = 100_000;

/// A mesh of the scene.
pub(super) struct Instance<'a> {
    pub mesh: &'a Mesh,
    pub transform: Transform,
}

/// A node to visit, with the transform of its parent.
struct Pending {
    node: usize,
    parent: Transform,
    depth: usize,
}

/// Returns all meshes of the file's scene in order: of the first scene if the file names none, and each mesh once if it
/// has none.
///
/// # Errors
/// Returns an error if a node or mesh is missing, a skeleton deforms a mesh, or nodes are too many or too deep.
pub(super) fn instances(root: &Root) -> Result<Vec<Instance<'_>>, String> {
    let all = |mesh| Instance {
        mesh,
        transform: Transform::IDENTITY,
    };
    if root.scenes.is_empty() {
        return Ok(root.meshes.iter().map(all).collect());
    }
    let scene = root.scene.unwrap_or(0);
    let scene = root.scenes.get(scene);
    let scene = scene.ok_or("the scene of the file does not exist")?;
    let mut pending = Vec::new();
    let outermost = (Transform::IDENTITY, 0);
    push(&mut pending, &scene.nodes, outermost);
    let (mut found, mut visited) = (Vec::new(), 0);
    while let Some(Pending {
        node: number,
        parent,
        depth,
    }) = pending.pop()
    {
        visited += 1;
        if visited > MAX_NODES || depth > MAX_DEPTH {
            return Err(format!(
                "more than {MAX_NODES} nodes, or nodes nested more than {MAX_DEPTH} deep"
            ));
        }
        let node = root.nodes.get(number);
        let node = node.ok_or_else(|| format!("there is no node {number}"))?;
        let transform = parent * own(node);
        if let Some(number) = node.mesh {
            if node.skin.is_some() {
                return Err("meshes that a skeleton deforms are not supported".to_owned());
            }
            let mesh = root.meshes.get(number);
            let mesh = mesh.ok_or_else(|| format!("there is no mesh {number}"))?;
            found.push(Instance { mesh, transform });
        }
        if pending.len() + node.children.len() > MAX_NODES {
            return Err(format!("more than {MAX_NODES} nodes"));
        }
        push(&mut pending, &node.children, (transform, depth + 1));
    }
    Ok(found)
}

/// Pushes nodes in reverse, so that the first is popped first.
fn push(pending: &mut Vec<Pending>, nodes: &[usize], (parent, depth): (Transform, usize)) {
    let pushed = nodes.iter().rev().map(|&node| Pending {
        node,
        parent,
        depth,
    });
    pending.extend(pushed);
}

/// Returns the transform of a node in its parent.
fn own(node: &Node) -> Transform {
    if let Some(m) = node.matrix {
        return Transform::from_rows(
            [0, 1, 2, 3].map(|row| [m[row], m[row + 4], m[row + 8], m[row + 12]]),
        );
    }
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = Quat::from_f64([w, x, y, z]).normalize();
    Transform::translation(node.translation.unwrap_or_default())
        * Transform::rotation(rotation)
        * Transform::scaling(node.scale.unwrap_or([1.0; 3]))
}
