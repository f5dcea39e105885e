//! The contact manifold on terrain: points on one plane are replaced by the corners of their convex hull, and excess
//! points nearest to each other are dropped.

use super::grid::same_direction;
use crate::contact::{MAX_POINTS, PATCH_POINTS};
use crate::narrow::convex::pair::across;
use crate::narrow::per_lane::Point;
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};
use std::ops::Range;

/// The distance below which points are merged, relative to the body's size.
pub(crate) const SAME: f64 = 1e-5;

/// At most [`MAX_POINTS`] points, including the deepest.
pub(super) struct Manifold<S> {
    points: ArrayVec<Point<S>, { MAX_POINTS + 1 }>,
    /// The size of the body, m.
    size: S,
    /// The distance below which points are merged, m.
    same: S,
    /// The accuracy of distances, m.
    tolerance: S,
}

/// The points on one plane of the terrain and a new one, or both halves of their hull.
type Facet<S> = ArrayVec<Point<S>, { 2 * (PATCH_POINTS + 1) + 1 }>;

/// Returns the point of a contact on the terrain.
fn ground<S: Scalar>(point: &Point<S>) -> Vec3<S> {
    point.position - point.normal * (point.distance * S::new(0.5))
}

impl<S: Scalar> Manifold<S> {
    pub(super) fn new(size: S, tolerance: S) -> Self {
        Manifold {
            points: ArrayVec::new(),
            size,
            same: size * S::new(SAME),
            tolerance,
        }
    }

    pub(super) fn points(&self) -> &[Point<S>] {
        &self.points
    }

    /// Returns the distance of the deepest point; infinite if there is none.
    pub(super) fn deepest(&self) -> S {
        let distances = self.points.iter().map(|p| p.distance);
        distances.fold(S::INFINITY, |least, d| least.min(d))
    }

    /// Adds a point, unless it is redundant.
    pub(super) fn add(&mut self, point: Point<S>) {
        let facet = self.facet(&point);
        if self.is_redundant(&self.points[facet.clone()], &point) {
            return;
        }
        let mut corners: Facet<S> = self.points.drain(facet).collect();
        // A coincident point is not as deep.
        corners.retain(|p| !self.is_same(p, &point));
        corners.push(point);
        self.corners(&mut corners);
        for point in corners {
            self.points.push(point);
            if self.points.len() > MAX_POINTS {
                self.thin_out();
            }
        }
    }

    /// Returns the range of points on the plane of a point, which are adjacent and ordered around their area.
    fn facet(&self, point: &Point<S>) -> Range<usize> {
        let on_plane = |p: &Point<S>| {
            (p.normal - point.normal).norm_squared() <= same_direction::<S>().squared()
                && (ground(p) - ground(point)).dot(point.normal).abs() <= self.same
        };
        let start = self.points.iter().position(on_plane);
        let start = start.unwrap_or(self.points.len());
        let others = self.points[start..].iter();
        start
            ..start
                + others
                    .take_while(|p| on_plane(p))
                    .take(PATCH_POINTS)
                    .count()
    }

    fn is_same(&self, p: &Point<S>, q: &Point<S>) -> bool {
        (p.position - q.position).norm_squared() <= self.same.squared()
    }

    /// Returns true if a point is no deeper than a facet and lies within its area or on one of its points.
    fn is_redundant(&self, facet: &[Point<S>], point: &Point<S>) -> bool {
        let deepest = facet
            .iter()
            .fold(S::INFINITY, |least, p| least.min(p.distance));
        if point.distance < deepest - self.tolerance {
            return false;
        }
        if let Some(twin) = facet.iter().find(|p| self.is_same(p, point)) {
            return twin.distance <= point.distance + self.tolerance;
        }
        self.surrounds(facet, point.position)
    }

    /// Returns true if a point is above or below the area of a facet.
    fn surrounds(&self, facet: &[Point<S>], place: Vec3<S>) -> bool {
        let Some(last) = facet.last().filter(|_| facet.len() > 2) else {
            return false;
        };
        let mut from = last.position;
        for point in facet {
            let side = point.position - from;
            let size = side.x.abs().max(side.y.abs()).max(side.z.abs());
            if side.cross(place - from).dot(point.normal) < -self.same * size {
                return false;
            }
            from = point.position;
        }
        true
    }

    /// Keeps the corners of the area that the points of a facet span, and the deepest point.
    fn corners(&self, facet: &mut Facet<S>) {
        let same = self.same;
        if facet.len() < 3 {
            return;
        }
        let (e, f) = across(facet[0].normal);
        let at = |p: &Point<S>| (e.dot(p.position), f.dot(p.position));
        facet.sort_unstable_by(|p, q| {
            let order = at(p).partial_cmp(&at(q));
            order.unwrap_or(std::cmp::Ordering::Equal)
        });
        let mut hull = half_hull(facet.iter().copied(), at, same);
        let back = half_hull(facet.iter().rev().copied(), at, same);
        let ends = back.len() - 1;
        hull.pop();
        hull.extend(back.into_iter().take(ends.max(1)));
        let deepest = deepest(facet, self.tolerance);
        if !hull
            .iter()
            .any(|p| p.distance <= deepest.distance + self.tolerance)
        {
            hull.insert(0, deepest);
        }
        *facet = hull;
        while facet.len() > PATCH_POINTS {
            remove_least(facet, at, self.tolerance);
        }
    }

    /// Removes one of the two points that are nearest to each other: the shallower, or if equal the one nearer to the
    /// middle.
    fn thin_out(&mut self) {
        let points = &self.points;
        let mut nearest = (S::INFINITY, 0, 1);
        for (i, p) in points.iter().enumerate() {
            for (j, q) in points.iter().enumerate().skip(i + 1) {
                let rotation = (p.normal - q.normal).norm_squared() * self.size * self.size;
                let apart = (p.position - q.position).norm_squared() + rotation;
                if apart < nearest.0 {
                    nearest = (apart, i, j);
                }
            }
        }
        let (_, i, j) = nearest;
        let share = S::ONE / S::new(points.len() as f64);
        let middle = points.iter().fold(Vec3::ZERO, |sum, p| sum + p.position) * share;
        let deeper = points[j].distance - points[i].distance;
        let out = |k: usize| (points[k].position - middle).norm_squared();
        let removed = if deeper.abs() > self.tolerance {
            if deeper > S::ZERO { j } else { i }
        } else if out(i) < out(j) {
            i
        } else {
            j
        };
        self.points.remove(removed);
    }
}

/// Returns the chain of sorted points that has no point to its right (Andrew 1979), without those less than `same` off
/// the chain.
fn half_hull<S: Scalar>(
    points: impl Iterator<Item = Point<S>>,
    at: impl Fn(&Point<S>) -> (S, S),
    same: S,
) -> Facet<S> {
    let mut chain = Facet::new();
    for point in points {
        while let [.., p, q] = &chain[..] {
            let ((px, py), (qx, qy), (x, y)) = (at(p), at(q), at(&point));
            let (dx, dy) = (x - px, y - py);
            let area = (qx - px) * dy - (qy - py) * dx;
            if area > same * (dx * dx + dy * dy).sqrt() {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

/// Returns the first of the deepest points, up to the tolerance.
fn deepest<S: Scalar>(points: &[Point<S>], tolerance: S) -> Point<S> {
    let mut best = points[0];
    for point in points {
        if point.distance < best.distance - tolerance {
            best = *point;
        }
    }
    best
}

/// Removes the corner that spans the smallest triangle with its neighbours, except the deepest.
fn remove_least<S: Scalar>(facet: &mut Facet<S>, at: impl Fn(&Point<S>) -> (S, S), tolerance: S) {
    let len = facet.len();
    let kept = deepest(facet, tolerance).position;
    let mut least = (S::INFINITY, 0);
    for k in (0..len).filter(|&k| facet[k].position != kept) {
        let [p, q, r] = [k + len - 1, k, k + 1].map(|k| at(&facet[k % len]));
        let area = (q.0 - p.0) * (r.1 - p.1) - (q.1 - p.1) * (r.0 - p.0);
        if area.abs() < least.0 {
            least = (area.abs(), k);
        }
    }
    facet.remove(least.1);
}
