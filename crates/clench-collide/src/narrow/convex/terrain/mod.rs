//! Height fields against convex shapes.
//!
//! Below each triangle of the surface is a prism down to the base, and together they are the field. The distance of a
//! body outside is the minimum of its distances to the prisms. The shortest exit from one prism may lead into the next,
//! inside the field. So a direction is valid only if it is a normal of the whole surface: of a face, of a convex edge
//! or vertex (whose normals are its Voronoi region), or of the field's sides. Along the normal of a face the contact
//! manifold is the body's feature clipped to the triangle. If a prism's best direction is invalid, its face is used,
//! unless its depth is much larger: at the foot of a cliff a body is not pushed out over the top. A convex edge or
//! vertex belongs to several prisms with equal gaps along its normal, so only one is searched.
//!
//! The work grows with the number of cells below the body's bounding box.

mod ball;
mod bounds;
mod face_clip;
mod grid;
mod manifold;
mod voronoi;

use super::{
    begin,
    body::Body,
    cylinder_polyhedron::prism_gap,
    nearest,
    pair::{Gap, Pair},
    patch::patch,
    prism::Prism,
    simplex::Simplex,
};
use crate::contact::Contacts;
use crate::narrow::per_lane::{Point, Points, per_lane};
use crate::narrow::placed::{AnyPlaced, Placed};
use crate::pose::Pose;
use crate::shape::{Shape, ShapeKind, Terrain};
use arrayvec::ArrayVec;
pub(super) use ball::CLEAR;
use bounds::Bounds;
use clench_math::{Mat3, Real, Scalar, Vec3};
use face_clip::FaceClip;
use grid::{TerrainGrid, Triangle, same_direction};
use manifold::Manifold;
pub(super) use manifold::SAME;
use voronoi::VoronoiFeature;

/// The maximum depth of a face, relative to the smallest depth of any prism.
pub(crate) const FACE_DEPTH_RATIO: f64 = 2.0;

/// The angle, in tolerances for equal directions, up to which a direction is the face's normal: rounding of a
/// triangle's corners turns its normal by no more.
pub(crate) const FACE_NORMAL_RATIO: f64 = 8.0;

/// The maximum number of cached convex edges and vertices; others may be searched repeatedly.
pub(crate) const MAX_FEATURES: usize = 4;

/// Computes the contacts of a height field and a bounded convex shape.
pub(in crate::narrow) fn terrain<T: Real>(
    a: Placed<Terrain<T>, T>,
    b: AnyPlaced<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    per_lane(a, b, margin, out, |a, b, margin, found| {
        points(a, b, margin, found);
    });
}

fn points<S: Scalar>(a: Placed<Terrain<S>, S>, b: AnyPlaced<S>, margin: S, points: &mut Points<S>) {
    let Some(field) = a.shape.field else {
        return;
    };
    let grid = TerrainGrid::new(field);
    let mut search = Search::new(a, b, margin);
    let body = Body::new(&b.shape);
    let padding = body.radius + margin + search.tolerance;
    let Some(bounds) = Bounds::new(&body, &search.rotation, search.offset, padding, &grid) else {
        return;
    };
    let Some([rows, columns]) = bounds.window(&grid) else {
        return;
    };
    let mut add_triangle = |cell, reached: [bool; 2]| {
        for half in (0..2).filter(|half| reached[*half]) {
            search.add_triangle(&Triangle::of_cell(&grid, cell, half), &body);
        }
    };
    // Finding the deepest contact first saves much of the remaining work.
    let first = grid.cell_at(bounds.lowest);
    if rows.contains(&first[0]) && columns.contains(&first[1]) {
        add_triangle(first, bounds.reach(first, &grid));
    }
    for row in rows {
        for column in columns.clone() {
            let cell = [row, column];
            let reached = bounds.reach(cell, &grid);
            if (reached[0] | reached[1]) && cell != first {
                add_triangle(cell, reached);
            }
        }
    }
    search.finish();
    for point in search.found.points() {
        points.push(Point {
            position: a.pose.point(point.position),
            normal: a.pose.rotation * point.normal,
            distance: point.distance,
        });
    }
}

/// The search over triangles: the contacts found, and data that avoids later searches.
struct Search<S> {
    /// The body in the field's frame.
    rotation: Mat3<S>,
    offset: Vec3<S>,
    margin: S,
    /// The accuracy of distances, m.
    tolerance: S,
    found: Manifold<S>,
    /// Contacts with faces whose depth may not be the smallest.
    provisional: Manifold<S>,
    /// The contact of least distance along valid directions.
    deepest: Option<Point<S>>,
    /// The convex edges and vertices that touch. All triangles around one touch there.
    features: ArrayVec<VoronoiFeature<S>, MAX_FEATURES>,
    /// The largest distance along normals of faces with provisional contacts.
    shallowest: S,
    /// The contact of least distance along invalid directions.
    rejected: Option<Point<S>>,
    /// The direction that separated the last triangle's ground from the body; it may separate the next one's.
    apart: Vec3<S>,
}

/// The largest gap, and the simplex of the search by support functions, if there was one.
type Largest<S> = (Gap<S>, Option<Simplex<S>>);

/// Keeps the deeper of two points.
fn replace_if_deeper<S: Scalar>(deepest: &mut Option<Point<S>>, point: Point<S>) {
    if deepest.is_none_or(|old| point.distance < old.distance) {
        *deepest = Some(point);
    }
}

impl<S: Scalar> Search<S> {
    fn new(a: Placed<Terrain<S>, S>, b: AnyPlaced<S>, margin: S) -> Self {
        let size = b.shape.bounding_radius();
        let offset = a.pose.local(b.pose.position);
        let rounding = (size + offset.norm()) * S::EPSILON * S::new(64.0);
        let tolerance = Real::max(rounding, size * S::new(1e-9));
        Search {
            rotation: a.pose.rotation.transpose() * b.pose.rotation,
            offset,
            margin,
            tolerance,
            found: Manifold::new(size, tolerance),
            provisional: Manifold::new(size, tolerance),
            deepest: None,
            features: ArrayVec::new(),
            shallowest: -S::INFINITY,
            rejected: None,
            apart: Vec3::ZERO,
        }
    }

    /// Adds the contacts of a triangle.
    fn add_triangle(&mut self, triangle: &Triangle<S>, body: &Body<S>) {
        let offset = self.offset - triangle.origin;
        if body.is_point() && self.ball(triangle, offset, body.radius) {
            return;
        }
        if self.is_separating(triangle, body, offset, offset - triangle.middle()) {
            return;
        }
        let normal = triangle.normal();
        let local = -self.rotation.transpose_mul(normal);
        let lowest = self.rotation * body.support(local, local) + offset;
        let height = normal.dot(lowest);
        let distance = height - body.radius;
        if distance > self.margin {
            return;
        }
        // Not deeper than the deepest contact: only the face itself or a convex feature can add contacts.
        let rotation = self.rotation;
        let clip = FaceClip {
            triangle,
            normal,
            body,
            rotation: &rotation,
            offset,
        };
        if distance >= self.deepest_distance() - self.tolerance
            && (clip.touch(self.margin, &mut self.found) || triangle.is_hollow(normal))
        {
            return;
        }
        if self.is_separating(triangle, body, offset, self.apart) {
            return;
        }
        // Deep within its walls, the smallest depth of the prism is through its face.
        let foot = lowest - normal * height.max(S::ZERO);
        if triangle.surrounds(foot, (-height).max(S::ZERO)) {
            replace_if_deeper(&mut self.deepest, clip.contact(lowest));
            clip.touch(self.margin, &mut self.found);
            return;
        }
        let prism = triangle.prism();
        let pair = Pair::between(Body::of_prism(&prism), body.clone(), rotation, offset);
        // A convex edge or vertex touches all of the prisms around it along one normal.
        if let Some(feature) = self.features.iter().find(|feature| triangle.has(feature)) {
            let touching = self.patch(&clip, &pair, feature.gap, None);
            touching.iter().for_each(|p| self.found.add(*p));
            return;
        }
        match self.largest_gap(&pair, &prism) {
            Ok((best, simplex)) => self.classify(&clip, &pair, distance, best, simplex.as_ref()),
            Err(gap) => self.apart = gap.normal,
        }
    }

    /// Returns the largest gap of a body and the ground below a triangle, or as an error a separating one beyond the
    /// margin.
    fn largest_gap(&self, pair: &Pair<S>, prism: &Prism<S>) -> Result<Largest<S>, Gap<S>> {
        if let Some(cylinder) = pair.b.as_cylinder() {
            let known = prism_gap(pair, prism, cylinder, self.margin);
            if known.gap > self.margin {
                return Err(known);
            }
            // If the bodies are apart, this gap is not always the distance.
            if known.gap <= S::ZERO && Real::is_finite(known.gap) {
                return Ok((known, None));
            }
        }
        let (start, mut simplex) = begin(pair);
        nearest(pair, start, self.margin, &mut simplex, None).map(|best| (best, Some(simplex)))
    }

    /// Returns true if a direction separates a body from the ground below a triangle.
    fn is_separating(
        &self,
        triangle: &Triangle<S>,
        body: &Body<S>,
        offset: Vec3<S>,
        n: Vec3<S>,
    ) -> bool {
        // Downwards the prism's bottom would have to be considered too.
        if n.z <= S::ZERO {
            return false;
        }
        let local = -self.rotation.transpose_mul(n);
        let nearest = self.rotation * body.support(local, local) + offset;
        let [p, q, r] = triangle.corners;
        let gap = n.dot(nearest) - n.dot(p).max(n.dot(q)).max(n.dot(r));
        let reach = self.margin + body.radius;
        gap > S::ZERO && gap.squared() > reach.squared() * n.norm_squared()
    }

    /// Returns the least distance found along valid directions.
    fn deepest_distance(&self) -> S {
        self.deepest.map_or(S::INFINITY, |p| p.distance)
    }

    /// Adds the contacts of a triangle, given its distance along its normal and the largest gap of its prism.
    fn classify(
        &mut self,
        clip: &FaceClip<S>,
        pair: &Pair<S>,
        distance: S,
        best: Gap<S>,
        simplex: Option<&Simplex<S>>,
    ) {
        let depth = best.gap - pair.b.radius;
        let level =
            (best.normal - clip.normal).norm() <= S::new(FACE_NORMAL_RATIO) * same_direction();
        let feature = clip.triangle.feature(best);
        let admitted = clip.triangle.admits_normal(&feature);
        if level || admitted {
            let touching = self.patch(clip, pair, best, simplex);
            touching
                .iter()
                .for_each(|p| replace_if_deeper(&mut self.deepest, *p));
            if !level || !clip.touch(self.margin, &mut self.found) {
                touching.iter().for_each(|p| self.found.add(*p));
                // Beside a level face the field may rise above the feature. If the capacity is exceeded, the feature is
                // found again with the next triangle around it.
                if admitted {
                    let _ = self.features.try_push(feature);
                }
            }
        } else {
            if self.rejected.is_none_or(|old| depth < old.distance) {
                let touching = self.patch(clip, pair, best, simplex);
                touching
                    .iter()
                    .for_each(|p| replace_if_deeper(&mut self.rejected, *p));
            }
            if clip.touch(self.margin, &mut self.provisional) {
                self.shallowest = Real::max(self.shallowest, distance);
            }
        }
    }

    /// Returns the contacts of the ground below a triangle.
    fn patch(
        &self,
        clip: &FaceClip<S>,
        pair: &Pair<S>,
        best: Gap<S>,
        simplex: Option<&Simplex<S>>,
    ) -> Points<S> {
        let pose = Pose {
            position: clip.triangle.origin,
            rotation: Mat3::IDENTITY,
        };
        let shape = Shape::new(ShapeKind::HeightField, Vec3::ZERO);
        let ground = Placed { shape, pose: &pose };
        let mut touching = Points::new();
        patch(pair, ground, best, simplex, self.margin, &mut touching);
        touching
    }

    /// Completes the contacts found. The body's depth in the field is at least its depth in any prism.
    fn finish(&mut self) {
        let depth = |p: Option<Point<S>>| p.map_or(S::INFINITY, |p| p.distance);
        let (counted, other) = (depth(self.deepest), depth(self.rejected));
        let least = Real::min(counted, other * S::new(FACE_DEPTH_RATIO));
        let least = match self.deepest {
            Some(_) => least,
            None => Real::min(least, self.shallowest),
        };
        for point in self.provisional.points() {
            if point.distance >= least - self.tolerance {
                self.found.add(*point);
            }
        }
        // Contacts that no face has: a corner in a groove, or a body between faces.
        for witness in [self.deepest, self.rejected].into_iter().flatten() {
            if self.found.deepest() > witness.distance + self.tolerance {
                self.found.add(witness);
            }
        }
    }
}
