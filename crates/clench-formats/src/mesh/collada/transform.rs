//! `<matrix>`, `<translate>`, `<rotate>` and `<scale>`: how a node stands in the one around it.

use super::{at, numbers};
use clench_math::{Mat3, Quat, Vec3};
use roxmltree::Node;
use std::ops::Mul;

/// An affine map of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transform {
    linear: Mat3<f64>,
    offset: Vec3<f64>,
}

impl Transform {
    pub(super) const IDENTITY: Transform = Transform {
        linear: Mat3::IDENTITY,
        offset: Vec3::ZERO,
    };

    /// Scales along the axes.
    pub(super) fn scaling(factors: [f64; 3]) -> Self {
        Transform {
            linear: Mat3::diagonal(Vec3::from_array(factors)),
            ..Self::IDENTITY
        }
    }

    /// What the elements of a node say together; the last acts first.
    ///
    /// # Errors
    /// An element with another number of numbers than it has, or of a kind that is not read.
    pub(super) fn of_node(node: Node) -> Result<Self, String> {
        let mut total = Self::IDENTITY;
        for element in node.children().filter(Node::is_element) {
            let next = match element.tag_name().name() {
                "matrix" => Self::from_matrix(exactly(element)?),
                "translate" => Transform {
                    offset: Vec3::from_array(exactly(element)?),
                    ..Self::IDENTITY
                },
                "rotate" => Self::rotation(exactly(element)?),
                "scale" => Self::scaling(exactly(element)?),
                "skew" | "lookat" => return Err(at(element, "is not supported")),
                _ => continue,
            };
            total = total * next;
        }
        Ok(total)
    }

    /// A matrix of four rows, whose last is 0 0 0 1.
    fn from_matrix(m: [f64; 16]) -> Self {
        let (rows, _) = m.as_chunks::<4>();
        let row = |i: usize| [rows[i][0], rows[i][1], rows[i][2]];
        Transform {
            linear: Mat3::from_f64([row(0), row(1), row(2)]),
            offset: Vec3::from_array([rows[0][3], rows[1][3], rows[2][3]]),
        }
    }

    /// A turn about an axis, by degrees; none where the axis is zero.
    fn rotation([x, y, z, degrees]: [f64; 4]) -> Self {
        let axis = Vec3::new(x, y, z);
        let length = axis.dot(axis).sqrt();
        if length == 0.0 {
            return Self::IDENTITY;
        }
        let turn = Quat::from_axis_angle(axis * (1.0 / length), degrees.to_radians());
        Transform {
            linear: turn.to_matrix(),
            ..Self::IDENTITY
        }
    }

    pub(super) fn point(&self, point: Vec3<f64>) -> Vec3<f64> {
        self.linear * point + self.offset
    }

    /// Whether it turns right hands into left ones, and so faces inside out.
    pub(super) fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

impl Mul for Transform {
    type Output = Transform;

    /// First `inner`, then this.
    fn mul(self, inner: Transform) -> Transform {
        Transform {
            linear: self.linear * inner.linear,
            offset: self.point(inner.offset),
        }
    }
}

/// The numbers of an element that has exactly so many.
fn exactly<const N: usize>(element: Node) -> Result<[f64; N], String> {
    let found: Vec<f64> = numbers(element)?;
    let count = found.len();
    let wrong = |_| at(element, &format!("has {N} numbers, not {count}"));
    found.try_into().map_err(wrong)
}
