//! Up to eight sample points on the outline of a convex contact polygon, which move little when the polygon does.
//!
//! Corners chosen by size or distance swap when two of them are equally good, so those of a body at rest would jump
//! with every rounding error. Here each of eight sectors of directions, fixed in the body, contributes one point: the
//! mean of the corners that support the directions of the sector, each weighted by its share of them, moved outward to
//! the outline.
//!
//! ```text
//! s(u)   the corner furthest along u           qₖ = ∫ s(u) du over sector k, u from one end to the other at a constant speed
//! ```
//!
//! The integral of a support function's gradient changes no faster than the outline, whichever corners appear or
//! vanish. A corner sharper than a quarter turn supports a whole sector and is sampled exactly. Directions are those of
//! the rounded polygon: with its second moments C about the middle m, sectors have equal angles in x ↦ C^(-½) (x − m).

use super::polygon::CAPACITY;
use crate::contact::PATCH_POINTS;
use arrayvec::ArrayVec;
use clench_math::{Real, Scalar, Vec3};

/// The directions between sectors; the first sector is between the first two.
const BETWEEN: [(f64, f64); PATCH_POINTS] = {
    // Cosine and sine of 22.5°.
    const C: f64 = 0.923_879_532_511_286_7;
    const S: f64 = 0.382_683_432_365_089_8;
    [
        (C, -S),
        (C, S),
        (S, C),
        (-S, C),
        (-C, S),
        (-C, -S),
        (-S, -C),
        (S, -C),
    ]
};

/// A convex polygon, counter-clockwise, with more corners than a patch has points.
pub(super) struct Outline<S> {
    corners: ArrayVec<Vec3<S>, CAPACITY>,
    middle: Vec3<S>,
    /// The inverse root of the second moments: xx, xy, yy.
    round: [S; 3],
    /// The distance below which points are merged.
    same: S,
}

impl<S: Scalar> Outline<S> {
    /// Computes the convex hull of points ordered counter-clockwise, seen along z. A point nearer than `same` to its
    /// predecessor is omitted.
    pub(super) fn of_points(points: &[Vec3<S>], same: S) -> Self {
        let corners = hull(points, same);
        let (middle, round) = moments(&corners);
        Outline {
            corners,
            middle,
            round,
            same,
        }
    }

    pub(super) fn corners(&self) -> &[Vec3<S>] {
        &self.corners
    }

    pub(super) fn middle(&self) -> Vec3<S> {
        self.middle
    }

    /// Returns one point for each sector, the first about the direction `first`; coincident points are merged.
    pub(super) fn sample(&self, first: Vec3<S>) -> ArrayVec<Vec3<S>, PATCH_POINTS> {
        let first = self.rounded((first.x, first.y));
        let length = (first.0 * first.0 + first.1 * first.1).sqrt();
        let (x, y) = if length > S::ZERO {
            (first.0 / length, first.1 / length)
        } else {
            (S::ONE, S::ZERO)
        };
        let border = |k: usize| {
            let (c, s) = BETWEEN[k % PATCH_POINTS];
            let (c, s) = (S::new(c), S::new(s));
            self.rounded((x * c - y * s, x * s + y * c))
        };
        let mut points = ArrayVec::<Vec3<S>, PATCH_POINTS>::new();
        let mut to = border(0);
        let mut corner = self.support(to);
        for k in 0..PATCH_POINTS {
            let from = to;
            to = border(k + 1);
            let point = self.sector(from, to, &mut corner);
            let twin = |p: Option<&Vec3<S>>| p.is_some_and(|p| near(*p, point, self.same));
            if !twin(points.last()) && !twin(points.first()) {
                points.push(point);
            }
        }
        points
    }

    /// Returns the point of the sector between two directions; `corner` supports the first, and afterwards the second.
    fn sector(&self, from: (S, S), to: (S, S), corner: &mut usize) -> Vec3<S> {
        let len = self.corners.len();
        let begin = *corner;
        let (mut mean, mut passed) = (Vec3::ZERO, S::ZERO);
        let mut edges = 0;
        while edges < len {
            let (p, next) = (self.corners[*corner], self.corners[(*corner + 1) % len]);
            let rise = |(x, y): (S, S)| (next.x - p.x) * x + (next.y - p.y) * y;
            let (at_start, at_end) = (rise(from), rise(to));
            if at_end <= S::ZERO {
                break;
            }
            // From this fraction of the sector on, the next corner supports it.
            let share = if at_start < S::ZERO {
                (at_start / (at_start - at_end)).max(passed)
            } else {
                passed
            };
            mean += p * (share - passed);
            passed = share;
            *corner = (*corner + 1) % len;
            edges += 1;
        }
        mean += self.corners[*corner] * (S::ONE - passed);
        if edges == 0 {
            return mean;
        }
        // Outward from the middle, to the first edge hit between those corners.
        let outward = mean - self.middle;
        let mut reach = S::INFINITY;
        for k in 0..edges {
            let (p, q) = (
                self.corners[(begin + k) % len],
                self.corners[(begin + k + 1) % len],
            );
            let (x, y) = (q.y - p.y, p.x - q.x);
            let height = x * (p.x - self.middle.x) + y * (p.y - self.middle.y);
            let rise = x * outward.x + y * outward.y;
            if rise > S::ZERO {
                reach = reach.min(height / rise);
            }
        }
        if reach.is_finite() && reach > S::ONE {
            self.middle + outward * reach
        } else {
            mean
        }
    }

    /// Returns the first corner that is furthest along a direction.
    fn support(&self, (x, y): (S, S)) -> usize {
        let mut best = (-S::INFINITY, 0);
        for (k, p) in self.corners.iter().enumerate() {
            let height = p.x * x + p.y * y;
            if height > best.0 {
                best = (height, k);
            }
        }
        best.1
    }

    fn rounded(&self, (x, y): (S, S)) -> (S, S) {
        let [xx, xy, yy] = self.round;
        (xx * x + xy * y, xy * x + yy * y)
    }
}

fn near<S: Scalar>(p: Vec3<S>, q: Vec3<S>, same: S) -> bool {
    (p.x - q.x).squared() + (p.y - q.y).squared() <= same * same
}

/// Returns the corners of the convex hull of a star-shaped polygon (Graham 1972).
fn hull<S: Scalar>(points: &[Vec3<S>], same: S) -> ArrayVec<Vec3<S>, CAPACITY> {
    let mut corners = ArrayVec::<Vec3<S>, CAPACITY>::new();
    let Some(&first) = points.first() else {
        return corners;
    };
    let mut start = (first, 0);
    for (k, p) in points.iter().enumerate() {
        if p.x < start.0.x || (p.x == start.0.x && p.y < start.0.y) {
            start = (*p, k);
        }
    }
    // Removes corners where the path turns right or not at all.
    let straighten = |corners: &mut ArrayVec<Vec3<S>, CAPACITY>, next: Vec3<S>| {
        while let [.., p, q] = corners[..]
            && (q.x - p.x) * (next.y - q.y) - (q.y - p.y) * (next.x - q.x) <= S::ZERO
        {
            corners.pop();
        }
    };
    for k in 0..points.len() {
        let next = points[(start.1 + k) % points.len()];
        if corners.last().is_some_and(|last| near(*last, next, same)) {
            continue;
        }
        straighten(&mut corners, next);
        corners.push(next);
    }
    while corners.len() > 1 && near(corners[corners.len() - 1], start.0, same) {
        corners.pop();
    }
    straighten(&mut corners, start.0);
    corners
}

/// Computes the centroid of a convex polygon and the inverse root of its second moments about it; harmless values if it
/// has no area.
fn moments<S: Scalar>(corners: &[Vec3<S>]) -> (Vec3<S>, [S; 3]) {
    let Some(&origin) = corners.first() else {
        return (Vec3::ZERO, [S::ONE, S::ZERO, S::ONE]);
    };
    // Sums over the triangles between the first corner and each side: twice the area, first and second moments.
    let (mut area, mut x, mut y) = (S::ZERO, S::ZERO, S::ZERO);
    let (mut xx, mut xy, mut yy) = (S::ZERO, S::ZERO, S::ZERO);
    for side in corners.windows(2).skip(1) {
        let (p, q) = (side[0] - origin, side[1] - origin);
        let twice = p.x * q.y - p.y * q.x;
        area += twice;
        x += twice * (p.x + q.x);
        y += twice * (p.y + q.y);
        xx += twice * (p.x * p.x + p.x * q.x + q.x * q.x);
        xy += twice * (p.x * p.y + q.x * q.y + (p.x * q.y + q.x * p.y) * S::new(0.5));
        yy += twice * (p.y * p.y + p.y * q.y + q.y * q.y);
    }
    let inverse = S::ONE / area.max(S::MIN_POSITIVE);
    let (x, y) = (x * inverse / S::new(3.0), y * inverse / S::new(3.0));
    let sixth = inverse / S::new(6.0);
    let (xx, xy, yy) = (xx * sixth - x * x, xy * sixth - x * y, yy * sixth - y * y);
    // Widen a very thin polygon a little.
    let least = (xx + yy) * S::EPSILON.sqrt();
    let (xx, yy) = (xx.max(S::ZERO) + least, yy.max(S::ZERO) + least);
    let root = (xx * yy - xy * xy).max(S::MIN_POSITIVE).sqrt();
    let scale = S::ONE / (root * (xx + yy + root * S::new(2.0)).sqrt());
    let middle = Vec3::new(origin.x + x, origin.y + y, S::ZERO);
    if !Real::is_finite(scale) {
        return (middle, [S::ONE, S::ZERO, S::ONE]);
    }
    (
        middle,
        [(yy + root) * scale, -xy * scale, (xx + root) * scale],
    )
}
