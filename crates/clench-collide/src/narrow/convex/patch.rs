//! The points of a contact: where the features of two bodies overlap, seen along the normal.
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

/// Shares of the smaller body: points nearer to each other are one; a patch may miss the deepest point by so much.
const SAME: f64 = 1e-5;
const MISSED: f64 = 1e-6;

/// A contact in the view: where it is across the normal, and the heights of both surfaces.
#[derive(Clone, Copy)]
struct Spot<S> {
    x: S,
    y: S,
    heights: (S, S),
}

impl<S: Scalar> Spot<S> {
    fn distance(&self) -> S {
        self.heights.1 - self.heights.0
    }
    /// The same with another distance.
    fn at_distance(&self, distance: S) -> Self {
        let middle = (self.heights.0 + self.heights.1) * S::new(0.5);
        let half = distance * S::new(0.5);
        Spot {
            heights: (middle - half, middle + half),
            ..*self
        }
    }
}

/// All corners of an overlap, and one more.
type Spots<S> = ArrayVec<Spot<S>, { CAPACITY + 1 }>;

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
    // Once more: squares of very short vectors lose digits.
    let n = best.normal.normalize().0;
    let radii = (pair.a.radius, pair.b.radius);
    let half = best.gap * S::new(0.5);
    let shift = (radii.0 - radii.1) * S::new(0.5);
    let distance = best.gap - radii.0 - radii.1;
    // Its frame is upright: see [`Pair::new`].
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

    let slack = (pair.smallest * S::new(MISSED)).max(pair.tolerance);
    let spot_at = |p: &Vec3<S>| {
        let on_a = projected_a.height(*p);
        // Just beyond a corner the features' planes go on, but the bodies do not.
        let on_b = projected_b.height(*p).max(on_a + best.gap);
        Spot {
            x: p.x,
            y: p.y,
            heights: (on_a, on_b),
        }
    };
    let (mut over, mut spots) = (Polygon::empty(), Spots::new());
    // Bodies that touch with an edge touch at the border of a face, where rounding may miss it.
    for beyond in [S::ZERO, pair.tolerance, slack] {
        spots.clear();
        projected_a.overlap(&projected_b, beyond, &mut over);
        spots.extend(over.corners().iter().map(spot_at));
        if spots.iter().any(|s| s.distance() <= best.gap + slack) {
            break;
        }
    }
    let mut lowest = deepest(&spots, pair.tolerance);
    if lowest.is_none_or(|lowest| lowest.distance() > best.gap + slack) {
        let witness = witness(simplex, pair, &view, best.gap);
        spots.insert(0, witness);
        lowest = Some(witness);
    }
    let reach = margin + radii.0 + radii.1;
    let same = pair.smallest * S::new(SAME);
    match lowest {
        // They touch by less than the features tell.
        Some(lowest) if lowest.distance() > reach => {
            spots.clear();
            spots.push(lowest.at_distance(best.gap));
        }
        Some(lowest) if spots.len() > PATCH_POINTS => {
            let first = projected_b.cap_direction();
            let first = first.filter(|_| !projected_a.is_cap());
            let first = first.unwrap_or_else(|| projected_a.direction());
            let outline = Outline::around(over.corners(), same);
            spots.clear();
            sample(&outline, first, lowest, slack, spot_at, &mut spots);
        }
        _ => {}
    }
    spots.retain(|s| s.distance() <= reach);
    merge(&mut spots, same);
    for spot in &spots {
        let (from, to) = (spot.heights.0 + radii.0, spot.heights.1 - radii.1);
        let middle = Vec3::new(spot.x, spot.y, (from + to) * S::new(0.5));
        points.push(Point {
            position: a.pose.point(view.transpose_mul(middle)),
            normal,
            distance: to - from,
        });
    }
}

/// The nearest points of the cores: those that support the normal if they face each other, else as the simplex has them.
fn witness<S: Scalar>(simplex: &Simplex<S>, pair: &Pair<S>, view: &Mat3<S>, gap: S) -> Spot<S> {
    let Vertex { w, a, b } = pair.vertex(view.rows[2]);
    let (mut on_a, mut on_b) = (a, b);
    if (w - view.rows[2] * gap).norm() > pair.smallest * S::new(MISSED) {
        (on_a, on_b) = simplex.nearest();
    }
    let on_b = pair.offset + pair.rotation * on_b;
    let middle = *view * ((on_a + on_b) * S::new(0.5));
    let spot = Spot {
        x: middle.x,
        y: middle.y,
        heights: (middle.z, middle.z),
    };
    spot.at_distance(gap)
}

/// Leaves one of points that coincide: the deepest.
fn merge<S: Scalar>(spots: &mut Spots<S>, same: S) {
    let mut kept = 0;
    for k in 0..spots.len() {
        let spot = spots[k];
        let near = |s: &Spot<S>| (s.x - spot.x).squared() + (s.y - spot.y).squared() <= same * same;
        match spots[..kept].iter().position(near) {
            Some(twin) if spot.distance() < spots[twin].distance() => spots[twin] = spot,
            Some(_) => {}
            None => {
                spots[kept] = spot;
                kept += 1;
            }
        }
    }
    spots.truncate(kept);
}

/// Fills `spots` with at most [`PATCH_POINTS`]: all corners if they are no more, else points of the outline, seen from the direction
/// `first`. If these miss the lowest spot by more than `slack` they are seen from its direction, and it is one of them.
fn sample<S: Scalar>(
    outline: &Outline<S>,
    first: Vec3<S>,
    lowest: Spot<S>,
    slack: S,
    spot_at: impl Fn(&Vec3<S>) -> Spot<S>,
    spots: &mut Spots<S>,
) {
    let few = outline.corners().len() <= PATCH_POINTS;
    if few {
        spots.extend(outline.corners().iter().map(&spot_at));
    } else {
        spots.extend(outline.sample(first).iter().map(&spot_at));
    }
    let missed = least_distance(spots) - lowest.distance();
    if missed > slack && few && spots.len() < PATCH_POINTS {
        spots.push(lowest);
    } else if missed > slack {
        let middle = outline.middle();
        let first = Vec3::new(lowest.x - middle.x, lowest.y - middle.y, S::ZERO);
        spots.clear();
        spots.extend(outline.sample(first).iter().map(&spot_at));
        spots[0] = lowest;
    }
    // What is left of the difference is too little to move a point, not to be told.
    let least = least_distance(spots);
    if let Some(spot) = spots.iter_mut().find(|s| s.distance() <= least) {
        *spot = spot.at_distance(least.min(lowest.distance()));
    }
}

fn least_distance<S: Scalar>(spots: &Spots<S>) -> S {
    let distances = spots.iter().map(Spot::distance);
    distances.fold(S::INFINITY, |least, d| least.min(d))
}

/// The first of the deepest spots; what the tolerance cannot tell apart is as deep.
fn deepest<S: Scalar>(spots: &Spots<S>, tolerance: S) -> Option<Spot<S>> {
    let least = least_distance(spots) + tolerance;
    let mut spots = spots.iter().copied();
    spots.find(|spot| spot.distance() <= least)
}
