//! Bounds of a body along axes and slopes, to select the triangles that it may touch.

use super::grid::{Node, TerrainGrid};
use crate::narrow::convex::body::Body;
use clench_math::{Mat3, Scalar, Vec3};
use std::ops::RangeInclusive;

/// The bounds of a body with its margin, in the field's frame.
pub(super) struct Bounds {
    pub low: Vec3<f64>,
    pub high: Vec3<f64>,
    /// Bounds along the two diagonals of cells: the minimum and maximum of x·dy − y·dx and x·dy + y·dx, with the
    /// lengths dx, dy of a cell.
    diagonals: [(f64, f64); 2],
    /// The minima of z − x, z + x, z − y and z + y.
    slopes: [f64; 4],
    /// The lowest point of the body.
    pub lowest: Vec3<f64>,
}

impl Bounds {
    /// Computes the bounds of a finite body, enlarged by `padding`, its radius and margin.
    pub(super) fn new<S: Scalar>(
        body: &Body<S>,
        rotation: &Mat3<S>,
        offset: Vec3<S>,
        padding: S,
        grid: &TerrainGrid,
    ) -> Option<Self> {
        let size = body.bounding_radius + offset.norm_squared();
        if !(size.to_f64().is_finite() && padding > -S::INFINITY) {
            return None;
        }
        let furthest = |d: Vec3<f64>| {
            let (d, length) = Vec3::<S>::from_f64(d.to_array()).normalize();
            let local = rotation.transpose_mul(d);
            let point = *rotation * body.support(local, local) + offset;
            (point, ((point.dot(d) + padding) * length).to_f64())
        };
        let largest = |d: Vec3<f64>| furthest(d).1;
        let extent = |d: Vec3<f64>| (-largest(-d), largest(d));
        let [dx, dy] = grid.step;
        let (x, y) = (
            extent(Vec3::new(1.0, 0.0, 0.0)),
            extent(Vec3::new(0.0, 1.0, 0.0)),
        );
        let (lowest, bottom) = furthest(Vec3::new(0.0, 0.0, -1.0));
        let top = largest(Vec3::new(0.0, 0.0, 1.0));
        let slopes = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
        Some(Bounds {
            low: Vec3::new(x.0, y.0, -bottom),
            high: Vec3::new(x.1, y.1, top),
            diagonals: [Vec3::new(dy, -dx, 0.0), Vec3::new(dy, dx, 0.0)].map(extent),
            slopes: slopes.map(|(x, y)| -largest(Vec3::new(x, y, -1.0))),
            lowest: Vec3::from_array(lowest.to_array().map(S::to_f64)),
        })
    }

    /// Returns the rows and columns of cells that the bounds overlap, up to the field's elevation; `None` if they are
    /// off the field.
    pub(super) fn window(&self, grid: &TerrainGrid) -> Option<[RangeInclusive<i64>; 2]> {
        let (low, high) = self.below(grid.elevation);
        let over = |axis: usize| low[axis] <= grid.half[axis] && high[axis] >= -grid.half[axis];
        let cells = |axis| grid.cell(axis, low[axis])..=grid.cell(axis, high[axis]);
        let level = self.low.z <= grid.elevation && self.high.z >= -grid.base;
        (over(0) && over(1) && level).then(|| [cells(1), cells(0)])
    }

    /// Returns the bounds along x and y of the part below a height.
    pub(super) fn below(&self, height: f64) -> ([f64; 2], [f64; 2]) {
        let [minus_x, plus_x, minus_y, plus_y] = self.slopes;
        let (low, high) = (self.low, self.high);
        (
            [low.x.max(plus_x - height), low.y.max(plus_y - height)],
            [high.x.min(height - minus_x), high.y.min(height - minus_y)],
        )
    }

    /// Returns true for each of a cell's left and right triangles that the bounds reach; without branches, which would
    /// be unpredictable.
    #[inline]
    pub(super) fn reach(&self, cell: Node, grid: &TerrainGrid) -> [bool; 2] {
        let [x, y] = grid.corner(cell);
        let [dx, dy] = grid.step;
        let area = dx * dy;
        let (aside, along) = (x * dy - y * dx, x * dy + y * dx);
        let ([low, high], (from, to)) = (
            [self.diagonals[0].0, self.diagonals[0].1],
            self.diagonals[1],
        );
        let near = (along <= to) & (along + 2.0 * area >= from);
        let slopes = self.slopes;
        let steep = (slopes[0] + x).max(slopes[1] - x - dx);
        let steep = steep.max(slopes[2] + y).max(slopes[3] - y - dy);
        let below = self.low.z.max(steep);
        let [left, right] = grid.tops(cell);
        [
            near & (aside - area <= high) & (aside >= low) & (left >= below),
            near & (aside <= high) & (aside + area >= low) & (right >= below),
        ]
    }
}
