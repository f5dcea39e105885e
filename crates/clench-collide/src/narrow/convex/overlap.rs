//! The overlap of two features projected along the normal.
//!
//! At each corner of the overlap the contact's distance is the difference of the features' heights. Many corners are
//! replaced by a few points on the outline (see [`Outline`]) and the deepest point.

use super::clipping::ProjectedFeature;
use super::pair::{Gap, Pair, Vertex, across};
use super::simplex::Simplex;
use crate::contact::PATCH_POINTS;
use crate::narrow::outline::Outline;
use crate::narrow::polygon::{CAPACITY, Polygon};
use crate::shape::Feature;
use arrayvec::ArrayVec;
use clench_math::{Mat3, Scalar, Vec3};

/// The distance below which points of a patch are merged, relative to the smaller body.
pub(crate) const SAME_POINT: f64 = 1e-5;
/// The error of the patch's depth, relative to the smaller body.
pub(crate) const MAX_MISS: f64 = 1e-6;
/// The ratio by which the extension of features that miss each other grows until they touch.
pub(crate) const EXTENSION: f64 = 1.25;
/// The extension, relative to the smaller body, from which on it is enough that the features overlap.
pub(crate) const MAX_EXTENSION: f64 = 1e-3;
/// The angle up to which faces are level, rad.
const LEVEL: f64 = 1e-9;

/// A point of the patch, projected along the normal.
#[derive(Clone, Copy)]
pub(super) struct PatchPoint<S> {
    /// The position across the normal.
    pub x: S,
    pub y: S,
    /// The heights of both surfaces along the normal.
    pub heights: (S, S),
}

impl<S: Scalar> PatchPoint<S> {
    fn distance(&self) -> S {
        self.heights.1 - self.heights.0
    }
    /// Returns the same point with another distance.
    fn at_distance(&self, distance: S) -> Self {
        let middle = (self.heights.0 + self.heights.1) * S::new(0.5);
        let half = distance * S::new(0.5);
        PatchPoint {
            heights: (middle - half, middle + half),
            ..*self
        }
    }
}

/// The corners of an overlap, and one more point.
pub(super) type PatchPoints<S> = ArrayVec<PatchPoint<S>, { CAPACITY + 1 }>;

/// Two features of a pair, projected along the normal of the largest gap.
pub(super) struct Overlap<'a, S> {
    pair: &'a Pair<'a, S>,
    /// Rows: two directions across the normal, and the normal.
    projection: Mat3<S>,
    features: [ProjectedFeature<S>; 2],
    /// The gap of the cores along the normal.
    gap: S,
    /// The tolerance of the deepest point's distance, m.
    slack: S,
}

impl<'a, S: Scalar> Overlap<'a, S> {
    /// Projects the features of both bodies, each in its body's frame, along the unit normal `n`.
    pub(super) fn new(
        pair: &'a Pair<'a, S>,
        features: [&Feature<S>; 2],
        n: Vec3<S>,
        gap: S,
    ) -> Self {
        let (side, other) = across(n);
        let projection = Mat3::from_rows(side, other, n);
        let [a, b] = features;
        let of_b = (projection * pair.offset, projection * pair.rotation);
        Overlap {
            pair,
            features: [
                ProjectedFeature::new(a, Vec3::ZERO, &projection, false),
                ProjectedFeature::new(b, of_b.0, &of_b.1, true),
            ],
            projection,
            gap,
            slack: (pair.smallest * S::new(MAX_MISS)).max(pair.tolerance),
        }
    }

    /// Adds the points of the patch that are at most `reach` apart to `found`, which is empty; `simplex` yields the
    /// nearest points of the cores where the features do not. The output is large, so it is not returned, which would
    /// copy it.
    pub(super) fn points(
        &self,
        simplex: Option<&Simplex<S>>,
        reach: S,
        found: &mut PatchPoints<S>,
    ) {
        let mut polygon = Polygon::empty();
        self.corners(&mut polygon, found);
        let lowest = deepest(found, self.pair.tolerance);
        let lowest = match lowest.filter(|point| point.distance() <= self.gap + self.slack) {
            Some(lowest) => lowest,
            None => {
                let witness = match (self.facing(), simplex) {
                    (Some(facing), _) => facing,
                    (None, Some(simplex)) => self.witness(simplex.nearest()),
                    (None, None) => self.nearly_touching(&mut polygon, found),
                };
                found.insert(0, witness);
                witness
            }
        };
        let same = self.pair.smallest * S::new(SAME_POINT);
        if lowest.distance() > reach {
            // The features are further apart than the bodies: use one point.
            found.clear();
            found.push(lowest.at_distance(self.gap));
        } else if found.len() > PATCH_POINTS {
            *found = self.sample(&Outline::of_points(polygon.corners(), same), lowest);
        }
        found.retain(|point| point.distance() <= reach);
        merge(found, same);
    }

    /// Returns the normal and its gap if the features are faces that lie level on each other.
    ///
    /// Both faces then have the same normal, but if they turn, the normal of the largest gap is that of the face which
    /// contains the other: its plane is cut less deep. If none does, the normal has no derivative, and that of the
    /// first face is used.
    pub(super) fn level_faces(&self, features: [&Feature<S>; 2]) -> Option<Gap<S>> {
        let [a, b] = features;
        if a.corners.len() < 3 || b.corners.len() < 3 {
            return None;
        }
        let n = self.projection.rows[2];
        let (own, other) = (a.normal, -(self.pair.rotation * b.normal));
        let level = S::new(LEVEL * LEVEL);
        if (own - n).norm_squared() > level || (other - n).norm_squared() > level {
            return None;
        }
        let [face_a, face_b] = &self.features;
        let inner = face_b.contains(face_a, self.slack) && !face_a.contains(face_b, self.slack);
        let mut normal = if inner { other } else { own };
        let mut gap = normal.dot(self.pair.vertex(normal).w);
        for axis in 0..3 {
            normal[axis].set_value(n[axis].value());
        }
        gap.set_value(self.gap.value());
        Some(Gap {
            normal,
            gap,
            is_exact: true,
        })
    }

    /// Transforms a point of the projection to the first body's frame.
    pub(super) fn unproject(&self, place: Vec3<S>) -> Vec3<S> {
        self.projection.transpose_mul(place)
    }

    /// Returns the point of the patch at a point of the projection.
    fn at(&self, place: &Vec3<S>) -> PatchPoint<S> {
        let [a, b] = &self.features;
        let on_a = a.height(*place);
        // Just beyond a corner the features' planes continue, but the bodies do not.
        let (plane, lowest) = (b.height(*place), on_a + self.gap);
        let mut on_b = plane.max(lowest);
        if S::IS_DUAL && lowest - plane <= self.pair.tolerance {
            // Level faces touch at every corner, but each corner has a derivative of its own.
            let height = on_b;
            on_b = plane;
            on_b.set_value(height.value());
        }
        PatchPoint {
            x: place.x,
            y: place.y,
            heights: (on_a, on_b),
        }
    }

    /// Computes the overlap, and the points at its corners.
    fn corners(&self, polygon: &mut Polygon<S>, found: &mut PatchPoints<S>) {
        let [a, b] = &self.features;
        // Rounding may miss an edge that touches the border of a face.
        for beyond in [S::ZERO, self.pair.tolerance, self.slack] {
            found.clear();
            a.overlap(b, beyond, polygon);
            found.extend(polygon.corners().iter().map(|place| self.at(place)));
            if self.touch(found) {
                break;
            }
        }
    }

    /// Returns true if any of some points is as deep as the bodies.
    fn touch(&self, found: &PatchPoints<S>) -> bool {
        let deepest = self.gap + self.slack;
        found.iter().any(|point| point.distance() <= deepest)
    }

    /// Returns the support points along the normal if they face each other: then they are the nearest of the cores.
    fn facing(&self) -> Option<PatchPoint<S>> {
        let n = self.projection.rows[2];
        let Vertex { w, a, b, .. } = self.pair.vertex(n);
        let miss = (w - n * self.gap).norm();
        (miss <= self.pair.smallest * S::new(MAX_MISS)).then(|| self.witness((a, b)))
    }

    /// Returns the deepest point of the overlap of the features, extended until they touch: a normal whose gap is
    /// the largest up to the tolerance may be that of features which miss each other by the root of the tolerance.
    fn nearly_touching(
        &self,
        polygon: &mut Polygon<S>,
        found: &mut PatchPoints<S>,
    ) -> PatchPoint<S> {
        let [a, b] = &self.features;
        let far = self.pair.smallest * S::new(MAX_EXTENSION);
        let mut beyond = self.slack;
        while beyond < far || (found.is_empty() && beyond < self.pair.largest) {
            beyond *= S::new(EXTENSION);
            a.overlap(b, beyond, polygon);
            found.clear();
            found.extend(polygon.corners().iter().map(|place| self.at(place)));
            if self.touch(found) {
                break;
            }
        }
        match deepest(found, self.pair.tolerance) {
            Some(lowest) => lowest.at_distance(self.gap),
            None => self.witness({
                let Vertex { a, b, .. } = self.pair.vertex(self.projection.rows[2]);
                (a, b)
            }),
        }
    }

    /// Returns the point between two points of the cores, each in its body's frame.
    fn witness(&self, (on_a, on_b): (Vec3<S>, Vec3<S>)) -> PatchPoint<S> {
        let on_b = self.pair.offset + self.pair.rotation * on_b;
        let middle = self.projection * ((on_a + on_b) * S::new(0.5));
        let witness = PatchPoint {
            x: middle.x,
            y: middle.y,
            heights: (middle.z, middle.z),
        };
        witness.at_distance(self.gap)
    }

    /// Returns the start direction of an outline, which rotates with a body: to the first corner of a round cap, or
    /// along the first edge.
    fn first_direction(&self) -> Vec3<S> {
        let [a, b] = &self.features;
        let cap = b.cap_direction().filter(|_| !a.is_cap());
        cap.unwrap_or_else(|| a.direction())
    }

    /// Returns at most [`PATCH_POINTS`] points: all corners of the outline if they are few enough, else a sample. If
    /// the sample misses the lowest point, it samples again starting with that point.
    fn sample(&self, outline: &Outline<S>, lowest: PatchPoint<S>) -> PatchPoints<S> {
        let from = |first| -> PatchPoints<S> {
            let samples = outline.sample(first);
            samples.iter().map(|sample| self.at(sample)).collect()
        };
        let few = outline.corners().len() <= PATCH_POINTS;
        let mut found: PatchPoints<S> = if few {
            outline.corners().iter().map(|p| self.at(p)).collect()
        } else {
            from(self.first_direction())
        };
        let missed = least_distance(&found) - lowest.distance();
        if missed > self.slack && few && found.len() < PATCH_POINTS {
            found.push(lowest);
        } else if missed > self.slack {
            let middle = outline.middle();
            found = from(Vec3::new(lowest.x - middle.x, lowest.y - middle.y, S::ZERO));
            found[0] = lowest;
        }
        // The remaining difference is too small to move a point, but the contact gets the true depth.
        let least = least_distance(&found);
        if S::IS_DUAL && least - lowest.distance() <= self.pair.tolerance {
            return found;
        }
        if let Some(point) = found.iter_mut().find(|s| s.distance() <= least) {
            *point = point.at_distance(least.min(lowest.distance()));
        }
        found
    }
}

/// Merges coincident points into the deepest of them.
fn merge<S: Scalar>(found: &mut PatchPoints<S>, same: S) {
    let mut kept = 0;
    for k in 0..found.len() {
        let point = found[k];
        let near = |s: &PatchPoint<S>| {
            (s.x - point.x).squared() + (s.y - point.y).squared() <= same * same
        };
        match found[..kept].iter().position(near) {
            Some(twin) if point.distance() < found[twin].distance() => found[twin] = point,
            Some(_) => {}
            None => {
                found[kept] = point;
                kept += 1;
            }
        }
    }
    found.truncate(kept);
}

fn least_distance<S: Scalar>(found: &PatchPoints<S>) -> S {
    let distances = found.iter().map(PatchPoint::distance);
    distances.fold(S::INFINITY, |least, d| least.min(d))
}

/// Returns the first of the deepest points, up to the tolerance.
fn deepest<S: Scalar>(found: &PatchPoints<S>, tolerance: S) -> Option<PatchPoint<S>> {
    let least = least_distance(found) + tolerance;
    let mut found = found.iter().copied();
    found.find(|point| point.distance() <= least)
}
