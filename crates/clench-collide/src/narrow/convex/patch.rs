//! The points of a contact: where the features of two bodies overlap when they are projected along the normal.
//!
//! At each corner of the overlap the contact's distance is the difference of the features' heights. For many corners stand
//! a few points on the outline (see [`Outline`]), and the deepest.

use super::clipping::ProjectedFeature;
use super::pair::{Gap, Pair, Vertex, across};
use super::simplex::Simplex;
use crate::PATCH_POINTS;
use crate::narrow::outline::Outline;
use crate::narrow::per_lane::{Point, Points};
use crate::narrow::placed::AnyPlaced;
use crate::narrow::polygon::{CAPACITY, Polygon};
use arrayvec::ArrayVec;
use clench_math::{Mat3, Scalar, Vec3};

/// Points of a patch are merged where they are nearer to each other than this share of the smaller body.
const SAME_POINT: f64 = 1e-5;
/// The deepest point of a patch may be less deep than the pair by at most this share of the smaller body.
const MAX_MISS: f64 = 1e-6;

/// A point of the patch, projected along the normal.
#[derive(Clone, Copy)]
struct PatchPoint<S> {
    /// Where it is across the normal.
    x: S,
    y: S,
    /// Where the surfaces of both bodies are along the normal.
    heights: (S, S),
}

impl<S: Scalar> PatchPoint<S> {
    fn distance(&self) -> S {
        self.heights.1 - self.heights.0
    }
    /// The same with another distance.
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
type PatchPoints<S> = ArrayVec<PatchPoint<S>, { CAPACITY + 1 }>;

/// Adds the contacts of a pair whose largest gap is known; `simplex` tells the nearest points of the cores where no feature
/// does.
pub(super) fn patch<S: Scalar>(
    pair: &Pair<S>,
    a: AnyPlaced<S>,
    best: Gap<S>,
    simplex: &Simplex<S>,
    margin: S,
    points: &mut Points<S>,
) {
    // It is normalized once more, since squares of very short vectors lose digits.
    let n = best.normal.normalize().0;
    let radii = (pair.a.radius, pair.b.radius);
    let half = best.gap * S::new(0.5);
    let shift = (radii.0 - radii.1) * S::new(0.5);
    let distance = best.gap - radii.0 - radii.1;
    // The frame of a sphere is that of the world: see [`Pair::new`].
    if pair.a.is_point() {
        points.push(Point {
            position: a.pose.position + n * (half + shift),
            normal: n,
            distance,
        });
        return;
    }
    let normal = a.pose.rotation * n;
    let mut add_one = |middle: Vec3<S>| {
        points.push(Point {
            position: a.pose.point(middle + n * shift),
            normal,
            distance,
        });
    };
    if pair.b.is_point() {
        return add_one(pair.offset - n * half);
    }
    let feature_a = pair.a.feature(n);
    // A corner is where it is, however exact the normal.
    if let (&[corner], false) = (&feature_a.corners[..], pair.a.is_curved()) {
        return add_one(corner + n * half);
    }
    let feature_b = pair.b.feature(-pair.rotation.transpose_mul(n));
    let place = |p| pair.offset + pair.rotation * p;
    // A corner, or the one point where a curved body touches.
    let middle = match (&feature_a.corners[..], &feature_b.corners[..]) {
        (&[p], &[q]) => Some((p + place(q)) * S::new(0.5)),
        (&[p], _) => Some(p + n * half),
        (_, &[q]) => Some(place(q) - n * half),
        _ => None,
    };
    if let Some(middle) = middle {
        return add_one(middle);
    }
    let (side, other) = across(n);
    let view = Mat3::from_rows(side, other, n);
    let projected_a = ProjectedFeature::new(&feature_a, Vec3::ZERO, &view, false);
    let projected_b = ProjectedFeature::new(
        &feature_b,
        view * pair.offset,
        &(view * pair.rotation),
        true,
    );

    let slack = (pair.smallest * S::new(MAX_MISS)).max(pair.tolerance);
    let project = |p: &Vec3<S>| {
        let on_a = projected_a.height(*p);
        // Just beyond a corner the features' planes go on, but the bodies do not.
        let on_b = projected_b.height(*p).max(on_a + best.gap);
        PatchPoint {
            x: p.x,
            y: p.y,
            heights: (on_a, on_b),
        }
    };
    let (mut over, mut found) = (Polygon::empty(), PatchPoints::new());
    // Bodies that touch with an edge touch at the border of a face, where rounding may miss it.
    for beyond in [S::ZERO, pair.tolerance, slack] {
        found.clear();
        projected_a.overlap(&projected_b, beyond, &mut over);
        found.extend(over.corners().iter().map(project));
        if found.iter().any(|s| s.distance() <= best.gap + slack) {
            break;
        }
    }
    let mut lowest = deepest(&found, pair.tolerance);
    if lowest.is_none_or(|lowest| lowest.distance() > best.gap + slack) {
        let witness = witness(simplex, pair, &view, best.gap);
        found.insert(0, witness);
        lowest = Some(witness);
    }
    let reach = margin + radii.0 + radii.1;
    let same = pair.smallest * S::new(SAME_POINT);
    match lowest {
        // The features are further apart than the bodies: one point stands for the patch.
        Some(lowest) if lowest.distance() > reach => {
            found.clear();
            found.push(lowest.at_distance(best.gap));
        }
        Some(lowest) if found.len() > PATCH_POINTS => {
            let first = projected_b.cap_direction();
            let first = first.filter(|_| !projected_a.is_cap());
            let first = first.unwrap_or_else(|| projected_a.direction());
            let outline = Outline::around(over.corners(), same);
            found.clear();
            sample(&outline, first, lowest, slack, project, &mut found);
        }
        _ => {}
    }
    found.retain(|s| s.distance() <= reach);
    merge(&mut found, same);
    for point in &found {
        let (from, to) = (point.heights.0 + radii.0, point.heights.1 - radii.1);
        let middle = Vec3::new(point.x, point.y, (from + to) * S::new(0.5));
        points.push(Point {
            position: a.pose.point(view.transpose_mul(middle)),
            normal,
            distance: to - from,
        });
    }
}

/// The nearest points of the cores: those that support the normal if they face each other, else as the simplex has them.
fn witness<S: Scalar>(
    simplex: &Simplex<S>,
    pair: &Pair<S>,
    view: &Mat3<S>,
    gap: S,
) -> PatchPoint<S> {
    let Vertex { w, a, b } = pair.vertex(view.rows[2]);
    let (mut on_a, mut on_b) = (a, b);
    if (w - view.rows[2] * gap).norm() > pair.smallest * S::new(MAX_MISS) {
        (on_a, on_b) = simplex.nearest();
    }
    let on_b = pair.offset + pair.rotation * on_b;
    let middle = *view * ((on_a + on_b) * S::new(0.5));
    let witness = PatchPoint {
        x: middle.x,
        y: middle.y,
        heights: (middle.z, middle.z),
    };
    witness.at_distance(gap)
}

/// Merges points that coincide into the deepest of them.
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

/// Fills `found` with at most [`PATCH_POINTS`]: all corners if they are no more, else points of the outline, seen from the direction
/// `first`. If these miss the lowest point by more than `slack` they are seen from its direction, and it is one of them.
fn sample<S: Scalar>(
    outline: &Outline<S>,
    first: Vec3<S>,
    lowest: PatchPoint<S>,
    slack: S,
    project: impl Fn(&Vec3<S>) -> PatchPoint<S>,
    found: &mut PatchPoints<S>,
) {
    let few = outline.corners().len() <= PATCH_POINTS;
    if few {
        found.extend(outline.corners().iter().map(&project));
    } else {
        found.extend(outline.sample(first).iter().map(&project));
    }
    let missed = least_distance(found) - lowest.distance();
    if missed > slack && few && found.len() < PATCH_POINTS {
        found.push(lowest);
    } else if missed > slack {
        let middle = outline.middle();
        let first = Vec3::new(lowest.x - middle.x, lowest.y - middle.y, S::ZERO);
        found.clear();
        found.extend(outline.sample(first).iter().map(&project));
        found[0] = lowest;
    }
    // What is left of the difference is too small to move a point for, but the contact has the true depth.
    let least = least_distance(found);
    if let Some(point) = found.iter_mut().find(|s| s.distance() <= least) {
        *point = point.at_distance(least.min(lowest.distance()));
    }
}

fn least_distance<S: Scalar>(found: &PatchPoints<S>) -> S {
    let distances = found.iter().map(PatchPoint::distance);
    distances.fold(S::INFINITY, |least, d| least.min(d))
}

/// The first of the deepest points; those that the tolerance cannot tell apart are equally deep.
fn deepest<S: Scalar>(found: &PatchPoints<S>, tolerance: S) -> Option<PatchPoint<S>> {
    let least = least_distance(found) + tolerance;
    let mut found = found.iter().copied();
    found.find(|point| point.distance() <= least)
}
