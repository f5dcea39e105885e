//! Convex polygons projected along a direction, and their clipping.

use crate::shape::MAX_CORNERS;
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};
use std::cmp::Ordering;

/// The capacity for corners. For each side of a face, both ends of a chord may be corners of its overlap with another
/// face, and so may all corners of both.
pub(super) const CAPACITY: usize = 4 * MAX_CORNERS;

/// A convex polygon, or a segment (two corners): x and y in the projection plane, z the height above it.
#[derive(Clone, Debug)]
pub(super) struct Polygon<S> {
    corners: ArrayVec<Vec3<S>, CAPACITY>,
}

impl<S: Scalar> Polygon<S> {
    pub(super) fn empty() -> Self {
        Polygon {
            corners: ArrayVec::new(),
        }
    }
    pub(super) fn corners(&self) -> &[Vec3<S>] {
        &self.corners
    }
    pub(super) fn clear(&mut self) {
        self.corners.clear();
    }
    pub(super) fn push(&mut self, corner: Vec3<S>) {
        // Only rounding could exceed the capacity, and then the corners coincide with others.
        let _ = self.corners.try_push(corner);
    }

    /// Keeps the part where x·`x` + y·`y` is at most `limit` (Sutherland–Hodgman).
    pub(super) fn clip(&mut self, (x, y): (S, S), limit: S) {
        let beyond = |p: Vec3<S>| x * p.x + y * p.y - limit;
        if self.corners.iter().all(|p| beyond(*p) <= S::ZERO) {
            return;
        }
        let mut whole = ArrayVec::<Vec3<S>, CAPACITY>::new();
        whole.extend(self.corners.drain(..));
        // The return along a segment would cross the line a second time.
        let sides = if whole.len() == 2 { 1 } else { whole.len() };
        for (k, &p) in whole.iter().enumerate() {
            let q = whole[(k + 1) % whole.len()];
            let (dp, dq) = (beyond(p), beyond(q));
            if dp <= S::ZERO {
                self.push(p);
            }
            let crosses = (dp < S::ZERO && dq > S::ZERO) || (dp > S::ZERO && dq < S::ZERO);
            if crosses && k < sides {
                self.push(p + (q - p) * (dp / (dp - dq)));
            }
        }
    }

    /// Sorts the corners around their middle, starting with the first. It overwrites their heights.
    pub(super) fn sort_by_angle(&mut self) {
        let Some(&first) = self.corners.first() else {
            return;
        };
        let share = S::ONE / S::new(self.corners.len() as f64);
        let sum = self.corners.iter().fold(Vec3::ZERO, |sum, p| sum + *p);
        let middle = sum * share;
        let start = first - middle;
        // Grows with the angle from the first corner, 0 to 4; keeps corners next to the first with it.
        let tiny = S::EPSILON * S::new(1e3);
        for p in &mut self.corners {
            let arm = *p - middle;
            let along = start.x * arm.x + start.y * arm.y;
            let across = start.x * arm.y - start.y * arm.x;
            let sum = (along.abs() + across.abs()).max(S::MIN_POSITIVE);
            let pseudo_angle = S::ONE - along / sum;
            p.z = if across < -sum * tiny {
                S::new(4.0) - pseudo_angle
            } else {
                pseudo_angle
            };
        }
        self.corners
            .sort_unstable_by(|p, q| p.z.partial_cmp(&q.z).unwrap_or(Ordering::Equal));
    }
}
