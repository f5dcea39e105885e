//! The triangles of a height field and their neighbours.

use crate::height_field::HeightField;
use crate::narrow::convex::prism::Prism;
use clench_math::{Real, Scalar, Vec3};

/// The row and column of a grid point, which may be beyond the border.
pub(super) type Node = [i64; 2];

/// Returns the angle up to which directions are equal, rad.
pub(super) fn same_direction<S: Scalar>() -> S {
    Real::max(S::new(1e-6), S::EPSILON * S::new(100.0))
}

/// A height field with data derived from its size.
pub(super) struct TerrainGrid<'a> {
    field: &'a HeightField,
    pub half: [f64; 2],
    /// The lengths of a cell along x and y, m.
    pub step: [f64; 2],
    pub elevation: f64,
    pub base: f64,
}

impl<'a> TerrainGrid<'a> {
    pub(super) fn new(field: &'a HeightField) -> Self {
        let [x, y, elevation, base] = field.size();
        let step = |half: f64, count: usize| 2.0 * half / (count - 1) as f64;
        TerrainGrid {
            field,
            half: [x, y],
            step: [step(x, field.columns()), step(y, field.rows())],
            elevation,
            base,
        }
    }

    /// Returns the cell at a coordinate along an axis, or the nearest one.
    pub(super) fn cell(&self, axis: usize, place: f64) -> i64 {
        let count = [self.field.columns(), self.field.rows()][axis];
        let cell = ((place + self.half[axis]) / self.step[axis]).floor();
        cell.clamp(0.0, (count - 2) as f64) as i64
    }

    /// Returns the row and column of the cell at a point, or of the nearest one.
    pub(super) fn cell_at(&self, point: Vec3<f64>) -> Node {
        [self.cell(1, point.y), self.cell(0, point.x)]
    }

    /// Returns x and y of a cell's lowest corner, m.
    pub(super) fn corner(&self, [row, column]: Node) -> [f64; 2] {
        [
            column as f64 * self.step[0] - self.half[0],
            row as f64 * self.step[1] - self.half[1],
        ]
    }

    /// Returns the maximum heights of the left and the right triangle of a cell, m.
    pub(super) fn tops(&self, [row, column]: Node) -> [f64; 2] {
        let height = |r, c| self.height([row + r, column + c]);
        let both = height(0, 0).max(height(1, 1));
        [both.max(height(1, 0)), both.max(height(0, 1))]
    }

    fn height(&self, [row, column]: Node) -> f64 {
        self.elevation * self.field.heights()[row as usize * self.field.columns() + column as usize]
    }
}

/// A triangle of the surface, in a frame with its origin at the first corner.
pub(super) struct Triangle<'a, S> {
    grid: &'a TerrainGrid<'a>,
    pub nodes: [Node; 3],
    /// The origin of its frame, in the field's frame.
    pub origin: Vec3<S>,
    /// The corners, counter-clockwise seen from above.
    pub corners: [Vec3<S>; 3],
}

impl<'a, S: Scalar> Triangle<'a, S> {
    /// Returns a triangle of a cell: 0 on the left, 1 on the right of its diagonal from the lowest x and y to the
    /// highest.
    pub(super) fn of_cell(grid: &'a TerrainGrid<'a>, first: Node, half: usize) -> Self {
        let [x, y] = grid.corner(first);
        let z = grid.height(first);
        let origin = Vec3::from_f64([x, y, z]);
        let node = |r, c| [first[0] + r, first[1] + c];
        let point = |r: i64, c: i64| {
            let rise = grid.height(node(r, c)) - z;
            Vec3::from_f64([c as f64 * grid.step[0], r as f64 * grid.step[1], rise])
        };
        let [second, third] = match half {
            0 => [(1, 1), (1, 0)],
            _ => [(0, 1), (1, 1)],
        };
        Triangle {
            grid,
            nodes: [first, node(second.0, second.1), node(third.0, third.1)],
            origin,
            corners: [
                Vec3::ZERO,
                point(second.0, second.1),
                point(third.0, third.1),
            ],
        }
    }

    /// Returns the unit normal.
    pub(super) fn normal(&self) -> Vec3<S> {
        let [_, q, r] = self.corners;
        q.cross(r).normalize().0
    }

    /// Returns the mean of the corners.
    pub(super) fn middle(&self) -> Vec3<S> {
        let [p, q, r] = self.corners;
        (p + q + r) * S::new(1.0 / 3.0)
    }

    /// Returns true if a point is within the ground below the triangle, and at least `distance` from walls and bottom,
    /// m.
    pub(super) fn surrounds(&self, point: Vec3<S>, distance: S) -> bool {
        let within = |k: usize| {
            let (from, to) = (self.corners[k], self.corners[(k + 1) % 3]);
            let (x, y) = (to.x - from.x, to.y - from.y);
            let inside = x * (point.y - from.y) - y * (point.x - from.x);
            inside >= distance * (x * x + y * y).sqrt()
        };
        let bottom = -self.origin.z - S::new(self.grid.base);
        (0..3).all(within) && point.z - bottom >= distance
    }

    /// Returns the ground below the triangle.
    pub(super) fn prism(&self) -> Prism<S> {
        let bottom = -self.origin.z - S::new(self.grid.base);
        Prism::new(self.corners, bottom)
    }

    /// Returns a grid point in the triangle's frame, if it exists.
    pub(super) fn node(&self, node: Node) -> Option<Vec3<S>> {
        let [row, column] = node;
        let field = self.grid.field;
        let inside = (0..field.rows() as i64).contains(&row)
            && (0..field.columns() as i64).contains(&column);
        inside.then(|| {
            let [first_row, first_column] = self.nodes[0];
            let [along_x, along_y] = self.grid.step;
            Vec3::new(
                S::new((column - first_column) as f64 * along_x),
                S::new((row - first_row) as f64 * along_y),
                S::new(self.grid.height(node)) - self.origin.z,
            )
        })
    }

    /// Returns the grid point across the edge that is opposite to corner `k`.
    pub(super) fn across(&self, k: usize) -> Option<Vec3<S>> {
        let [p, q, r] = [
            self.nodes[(k + 1) % 3],
            self.nodes[(k + 2) % 3],
            self.nodes[k],
        ];
        self.node([p[0] + q[0] - r[0], p[1] + q[1] - r[1]])
    }

    /// Returns the slope of the surface beyond the edge opposite to corner `k`, relative to the triangle; `None` at the
    /// border.
    fn rise_across(&self, k: usize, normal: Vec3<S>) -> Option<S> {
        let edge = self.across(k)? - self.corners[(k + 1) % 3];
        Some(normal.dot(edge) / edge.norm())
    }

    /// Returns true if the surface continues flat across the edge opposite to corner `k`.
    pub(super) fn goes_on_across(&self, k: usize, normal: Vec3<S>) -> bool {
        let rise = self.rise_across(k, normal);
        rise.is_some_and(|rise| rise.abs() <= same_direction())
    }

    /// Returns true if the surface bends away from the triangle nowhere, so that only its face can be touched.
    pub(super) fn is_hollow(&self, normal: Vec3<S>) -> bool {
        let bends_up = |k| {
            self.rise_across(k, normal)
                .is_some_and(|rise| rise >= -same_direction::<S>())
        };
        (0..3).all(bends_up)
    }
}
