//! The triangles of a height field, one at a time, and which normals a solid has at their corners and edges.

use crate::HeightField;
use crate::narrow::convex::prism::Prism;
use clench_math::{Real, Scalar, Vec3};
use std::ops::Range;

/// Row and column of a grid point; those beyond the border do not exist.
type Node = [i64; 2];

/// Directions count as one up to this angle, rad.
pub(super) fn same_direction<S: Scalar>() -> S {
    Real::max(S::new(1e-6), S::EPSILON * S::new(100.0))
}

/// The rows and columns of cells above or below a rectangle.
pub(super) struct Window {
    pub rows: Range<i64>,
    pub columns: Range<i64>,
}

impl Window {
    /// The cells that a rectangle reaches, given by its lowest and highest x and y in the field's frame.
    pub fn new(field: &HeightField, low: [f64; 2], high: [f64; 2]) -> Self {
        let [half_x, half_y, ..] = field.size();
        let cells = |axis: usize, half: f64, count: usize| {
            let last = (count - 1) as f64;
            let at = |x: f64| (x / half + 1.0) * 0.5 * last;
            let from = at(low[axis]).floor().clamp(0.0, last);
            let to = at(high[axis]).ceil().clamp(0.0, last);
            from as i64..to as i64
        };
        Window {
            rows: cells(1, half_y, field.rows()),
            columns: cells(0, half_x, field.columns()),
        }
    }
}

/// A triangle of the surface.
pub(super) struct Triangle<'a, S> {
    field: &'a HeightField,
    nodes: [Node; 3],
    /// Where the prism's frame begins, in the field's frame.
    origin: Vec3<f64>,
    pub prism: Prism<S>,
}

impl<'a, S: Scalar> Triangle<'a, S> {
    /// Both triangles of a cell, which its diagonal from the lowest x and y to the highest divides.
    pub fn of_cell(field: &'a HeightField, row: i64, column: i64) -> [Self; 2] {
        let node = |r, c| [row + r, column + c];
        [
            [node(0, 0), node(1, 1), node(1, 0)],
            [node(0, 0), node(0, 1), node(1, 1)],
        ]
        .map(|nodes| {
            let origin = point(field, nodes[0]);
            let [.., base] = field.size();
            let local = |node| Vec3::from_f64((point(field, node) - origin).to_array());
            Triangle {
                field,
                nodes,
                origin,
                prism: Prism::new(nodes.map(local), S::new(-base - origin.z)),
            }
        })
    }

    /// Where the prism's frame begins, in the field's frame.
    pub fn origin(&self) -> Vec3<S> {
        Vec3::from_f64(self.origin.to_array())
    }

    /// A grid point in the prism's frame, if it exists.
    fn node(&self, node: Node) -> Option<Vec3<S>> {
        let [row, column] = node;
        let inside = (0..self.field.rows() as i64).contains(&row)
            && (0..self.field.columns() as i64).contains(&column);
        inside.then(|| Vec3::from_f64((point(self.field, node) - self.origin).to_array()))
    }

    /// The grid point across the edge that is opposite to corner `k`.
    fn across(&self, k: usize) -> Option<Vec3<S>> {
        let [p, q, r] = [
            self.nodes[(k + 1) % 3],
            self.nodes[(k + 2) % 3],
            self.nodes[k],
        ];
        self.node([p[0] + q[0] - r[0], p[1] + q[1] - r[1]])
    }

    /// Whether the surface bends away from the triangle nowhere, so that nothing but its face can be touched.
    pub fn is_hollow(&self) -> bool {
        (0..3).all(|k| {
            self.across(k).is_some_and(|w| {
                let edge = w - self.prism.corners[(k + 1) % 3];
                self.prism.normal.dot(edge) >= -edge.norm() * same_direction()
            })
        })
    }

    /// Whether `n` is a normal of the whole field where the prism reaches furthest along it: not where the field goes on beyond
    /// the prism's wall, or rises beyond its edge.
    pub fn admits(&self, n: Vec3<S>) -> bool {
        let flat = n.z < -same_direction::<S>();
        let level = |v: Vec3<S>| {
            if flat {
                Vec3::new(v.x, v.y, S::ZERO)
            } else {
                v
            }
        };
        let corners = [0, 1, 2].map(|k| level(self.prism.corners[k]));
        let reach = corners.map(|v| v.dot(n));
        let most = reach[0].max(reach[1]).max(reach[2]);
        let size = (corners[1] - corners[0]).norm() + (corners[2] - corners[0]).norm();
        let touches = reach.map(|r| r >= most - size * same_direction());
        let below = |from: Vec3<S>, to: Option<Vec3<S>>| {
            to.is_none_or(|to| {
                let edge = level(to) - from;
                edge.dot(n) <= edge.norm() * same_direction()
            })
        };
        match touches.iter().filter(|t| **t).count() {
            3 => true,
            2 => (0..3).all(|k| touches[k] || below(corners[(k + 1) % 3], self.across(k))),
            _ => (0..3).all(|k| {
                let [row, column] = self.nodes[k];
                let beside = |[r, c]: Node| below(corners[k], self.node([row + r, column + c]));
                !touches[k] || AROUND.into_iter().all(beside)
            }),
        }
    }
}

/// From a grid point to those that share an edge with it.
const AROUND: [Node; 6] = [[0, 1], [1, 1], [1, 0], [0, -1], [-1, -1], [-1, 0]];

fn point(field: &HeightField, [row, column]: Node) -> Vec3<f64> {
    field.point(row as usize, column as usize)
}
