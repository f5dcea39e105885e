//! Contact points on terrain, few enough: those that lie on one plane are replaced by the corners around them, and of too
//! many the nearest to each other are thinned out.

use super::grid::same_direction;
use crate::narrow::convex::pair::across;
use crate::narrow::one_by_one::Point;
use crate::{MAX_POINTS, PATCH_POINTS};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// Points nearer to each other than this share of the body's size are one.
const SAME: f64 = 1e-5;

/// At most [`MAX_POINTS`] points, and the deepest is among them.
pub(super) struct Spread<S> {
    points: ArrayVec<Point<S>, { MAX_POINTS + 1 }>,
    /// The size of the body, m.
    size: S,
    /// How exact distances are, m.
    tolerance: S,
}

/// The points on one plane of the terrain.
type Facet<S> = ArrayVec<Point<S>, { 2 * PATCH_POINTS + 4 }>;

impl<S: Scalar> Spread<S> {
    pub fn new(size: S, tolerance: S) -> Self {
        Spread {
            points: ArrayVec::new(),
            size,
            tolerance,
        }
    }

    pub fn points(&self) -> &[Point<S>] {
        &self.points
    }

    /// The distance of the deepest point; infinite if there is none.
    pub fn deepest(&self) -> S {
        let distances = self.points.iter().map(|p| p.distance);
        distances.fold(S::INFINITY, |least, d| least.min(d))
    }

    /// Adds a point, if it says more than those that are there.
    pub fn add(&mut self, point: Point<S>) {
        let same = self.size * S::new(SAME);
        let ground = |p: &Point<S>| p.position - p.normal * (p.distance * S::new(0.5));
        let mut facet = Facet::new();
        let mut found = false;
        self.points.retain(|p| {
            let on_plane = (p.normal - point.normal).norm() <= same_direction()
                && (ground(p) - ground(&point)).dot(point.normal).abs() <= same;
            if !on_plane || facet.len() > PATCH_POINTS {
                return true;
            }
            if !found && (p.position - point.position).norm() <= same {
                found = true;
                if point.distance < p.distance {
                    *p = point;
                }
            }
            facet.push(*p);
            false
        });
        if !found {
            facet.push(point);
        }
        self.corners(&mut facet, same);
        for point in facet {
            self.points.push(point);
            if self.points.len() > MAX_POINTS {
                self.thin_out();
            }
        }
    }

    /// Leaves the corners of the area that the points of a facet span, and the deepest of them.
    fn corners(&self, facet: &mut Facet<S>, same: S) {
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

    /// Removes one of the two points that are nearest to each other: the shallower, between equals the one nearer to the middle.
    fn thin_out(&mut self) {
        let points = &self.points;
        let mut nearest = (S::INFINITY, 0, 1);
        for (i, p) in points.iter().enumerate() {
            for (j, q) in points.iter().enumerate().skip(i + 1) {
                let turn = (p.normal - q.normal).norm_squared() * self.size * self.size;
                let apart = (p.position - q.position).norm_squared() + turn;
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

/// The chain of points to the right of which none lies, of points sorted along a line (Andrew 1979). Those less than `same` off the
/// chain are left out.
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
            let turn = (qx - px) * dy - (qy - py) * dx;
            if turn > same * (dx * dx + dy * dy).sqrt() {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

/// The first of the deepest points; what the tolerance cannot tell apart is as deep.
fn deepest<S: Scalar>(points: &[Point<S>], tolerance: S) -> Point<S> {
    let mut best = points[0];
    for point in points {
        if point.distance < best.distance - tolerance {
            best = *point;
        }
    }
    best
}

/// Removes the corner that spans the smallest triangle with its neighbours, but not the deepest.
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
