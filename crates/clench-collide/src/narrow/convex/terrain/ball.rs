//! A ball whose centre is above a triangle: the result of GJK in closed form.

use super::{Search, grid::Triangle, replace_if_deeper};
use crate::narrow::convex::{pair::Gap, simplex::on_triangle};
use crate::narrow::per_lane::Point;
use clench_math::{Scalar, Vec3};

/// The minimum distance of the centre from the triangle, in tolerances, for an exact direction.
pub(crate) const CLEAR: f64 = 1e3;

impl<S: Scalar> Search<S> {
    /// Adds the contact of a triangle and a ball about `middle`. Returns false if it cannot decide: a centre below the
    /// nearest point of the triangle may be nearer to the walls below.
    pub(super) fn ball(&mut self, triangle: &Triangle<S>, middle: Vec3<S>, radius: S) -> bool {
        let [p, q, r] = triangle.corners;
        let near = on_triangle([(0, p - middle), (1, q - middle), (2, r - middle)]);
        let (normal, gap) = (-near.point).normalize();
        if !(normal.z > S::ZERO && gap > self.tolerance * S::new(CLEAR)) {
            return false;
        }
        let distance = gap - radius;
        if distance > self.margin {
            return true;
        }
        let gap_along = Gap {
            normal,
            gap,
            is_exact: true,
        };
        let half = S::new(0.5);
        let point = Point {
            position: triangle.origin + middle - normal * ((gap + radius) * half),
            normal,
            distance,
        };
        if near.is_inside() || triangle.admits_normal(&triangle.feature(gap_along)) {
            replace_if_deeper(&mut self.deepest, point);
            self.found.add(point);
        } else {
            replace_if_deeper(&mut self.rejected, point);
        }
        true
    }
}
