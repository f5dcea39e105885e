//! `<matrix>`, `<translate>`, `<rotate>` and `<scale>`: the transform of a node in its parent.

use super::file::{at, numbers};
use crate::mesh::affine::Transform;
use clench_math::{Quat, Vec3};
use roxmltree::Node;

/// Composes the transforms of a node's elements; the last acts first.
///
/// # Errors
/// Returns an error if an element has the wrong number of numbers or is of an unsupported kind.
pub(super) fn of_node(node: Node) -> Result<Transform, String> {
    let mut total = Transform::IDENTITY;
    for element in node.children().filter(Node::is_element) {
        let next = match element.tag_name().name() {
            "matrix" => {
                let numbers: [f64; 16] = exactly(element)?;
                let (rows, _) = numbers.as_chunks::<4>();
                Transform::from_rows([rows[0], rows[1], rows[2], rows[3]])
            }
            "translate" => Transform::translation(exactly(element)?),
            "rotate" => rotation(exactly(element)?),
            "scale" => Transform::scaling(exactly(element)?),
            "skew" | "lookat" => return Err(at(element, "is not supported")),
            _ => continue,
        };
        total = total * next;
    }
    Ok(total)
}

/// Creates a rotation about an axis by degrees; the identity for a zero axis.
fn rotation([x, y, z, degrees]: [f64; 4]) -> Transform {
    let axis = Vec3::new(x, y, z);
    let length = axis.dot(axis).sqrt();
    if length == 0.0 {
        return Transform::IDENTITY;
    }
    let rotation = Quat::from_axis_angle(axis * (1.0 / length), degrees.to_radians());
    Transform::rotation(rotation)
}

/// Parses the numbers of an element with exactly `N`.
fn exactly<const N: usize>(element: Node) -> Result<[f64; N], String> {
    let found: Vec<f64> = numbers(element)?;
    let count = found.len();
    let wrong = |_| at(element, &format!("has {N} numbers, not {count}"));
    found.try_into().map_err(wrong)
}
