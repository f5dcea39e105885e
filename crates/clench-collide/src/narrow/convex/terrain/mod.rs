//! Height fields against convex shapes.
//!
//! Under each triangle of the surface lies a prism down to the base, and together they are the field. The distance of a body
//! that is outside is the least of its distances to the prisms. One that has sunk in may leave a single prism sideways, into the
//! next one, which is no way out of the field; so a direction counts only where it is a normal of the whole surface: of a
//! face, of an edge or a corner that stands out, or of the field's sides. Along the normal of a face the contacts are the
//! corners of what the body shows to it, clipped to the triangle. Where a prism's best direction does not count, its face
//! does, unless that is a long way round: the foot of a cliff is not left over the top. What stands out belongs to several
//! prisms, whose gaps along its normal are the same, so one of them is searched.
//!
//! The work grows with the number of cells below the body's bounding box.

mod ball;
mod bounds;
mod face;
mod grid;
mod ridge;
mod spread;

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
use crate::narrow::{
    Placed,
    one_by_one::{Point, Points, one_by_one},
};
use crate::{Asset, Contacts, Pose, Shape, ShapeKind};
use arrayvec::ArrayVec;
use bounds::Bounds;
use clench_math::{Mat3, Real, Scalar, Vec3};
use face::Over;
use grid::{Grid, Triangle, same_direction};
use ridge::Ridge;
use spread::Spread;

/// How many times as far as the shortest way out of any prism a face may still be a way out of the field.
const DETOUR: f64 = 2.0;

/// Directions within so many times what counts as one are that of a face: more than a triangle's corners tell apart.
const LEVEL: f64 = 8.0;

/// So many ridges are remembered; those after them may be found more than once.
const RIDGES: usize = 4;

/// The contacts of a height field and a shape that is bounded and convex.
pub(in crate::narrow) fn terrain<T: Real>(
    a: Placed<T>,
    b: Placed<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    one_by_one(a, b, margin, out, points);
}

fn points<S: Scalar>(a: Placed<S>, b: Placed<S>, margin: S, points: &mut Points<S>) {
    let Asset::HeightField(field) = a.shape.asset else {
        return;
    };
    let grid = Grid::new(field);
    let mut search = Search::new(a, b, margin);
    let body = Body::new(b.shape);
    let around = body.radius + margin + search.tolerance;
    let Some(bounds) = Bounds::new(&body, &search.rotation, search.offset, around, &grid) else {
        return;
    };
    let Some([rows, columns]) = grid.window(&bounds) else {
        return;
    };
    let mut look_at = |cell, reached: [bool; 2]| {
        for half in (0..2).filter(|half| reached[*half]) {
            search.look_at(&Triangle::of_cell(&grid, cell, half), &body);
        }
    };
    // What is deepest saves much of the work on the rest.
    let first = grid.cell_at(bounds.lowest);
    if rows.contains(&first[0]) && columns.contains(&first[1]) {
        look_at(first, bounds.reach(first, &grid));
    }
    for row in rows {
        for column in columns.clone() {
            let cell = [row, column];
            let reached = bounds.reach(cell, &grid);
            if (reached[0] | reached[1]) && cell != first {
                look_at(cell, reached);
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

/// What is known after some of the triangles.
struct Search<S> {
    /// The body in the field's frame.
    rotation: Mat3<S>,
    offset: Vec3<S>,
    margin: S,
    /// How exact distances are, m.
    tolerance: S,
    found: Spread<S>,
    /// Contacts with faces that may not be the shortest way out.
    doubtful: Spread<S>,
    /// The least distance along directions that count, and a contact that has it.
    deepest: Option<Point<S>>,
    /// What stands out and touches. The triangles around it all do so there.
    ridges: ArrayVec<Ridge<S>, RIDGES>,
    /// The largest distance along normals of doubtful faces.
    shallowest: S,
    /// The least distance along directions that do not count, and its contact.
    sideways: Option<Point<S>>,
    /// The direction along which the last triangle's ground was apart from the body: the next one's may be so, too.
    apart: Vec3<S>,
}

/// Takes the deeper of two points.
fn deepen<S: Scalar>(deepest: &mut Option<Point<S>>, point: Point<S>) {
    if deepest.is_none_or(|old| point.distance < old.distance) {
        *deepest = Some(point);
    }
}

impl<S: Scalar> Search<S> {
    fn new(a: Placed<S>, b: Placed<S>, margin: S) -> Self {
        let size = crate::bounding_radius(b.shape);
        let offset = a.pose.local(b.pose.position);
        let rounding = (size + offset.norm()) * S::EPSILON * S::new(64.0);
        let tolerance = Real::max(rounding, size * S::new(1e-9));
        Search {
            rotation: a.pose.rotation.transpose() * b.pose.rotation,
            offset,
            margin,
            tolerance,
            found: Spread::new(size, tolerance),
            doubtful: Spread::new(size, tolerance),
            deepest: None,
            ridges: ArrayVec::new(),
            shallowest: -S::INFINITY,
            sideways: None,
            apart: Vec3::ZERO,
        }
    }

    /// Adds the contacts of a triangle.
    fn look_at(&mut self, triangle: &Triangle<S>, body: &Body<S>) {
        let offset = self.offset - triangle.origin;
        if body.is_point() && self.ball(triangle, offset, body.radius) {
            return;
        }
        if self.passes(triangle, body, offset, offset - triangle.middle()) {
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
        // No deeper than what is known: then only what lies on the face or stands out can add to it.
        let rotation = self.rotation;
        let over = Over {
            triangle,
            normal,
            body,
            rotation: &rotation,
            offset,
        };
        if distance >= self.known() - self.tolerance
            && (over.touch(self.margin, &mut self.found) || triangle.is_hollow(normal))
        {
            return;
        }
        if self.passes(triangle, body, offset, self.apart) {
            return;
        }
        // Deep within its walls: then no way out of the prism is shorter than through its face.
        let foot = lowest - normal * height.max(S::ZERO);
        if triangle.surrounds(foot, (-height).max(S::ZERO)) {
            deepen(&mut self.deepest, over.contact(lowest));
            over.touch(self.margin, &mut self.found);
            return;
        }
        let prism = triangle.prism();
        let pair = Pair::between(Body::of_prism(&prism), body.clone(), rotation, offset);
        // What stands out touches along one normal with all of the ground around it.
        if let Some(ridge) = self.ridges.iter().find(|ridge| triangle.has(ridge)) {
            let simplex = Simplex::new(pair.vertex(ridge.gap.normal));
            let touching = self.patch(&over, &pair, ridge.gap, &simplex);
            touching.iter().for_each(|p| self.found.add(*p));
            return;
        }
        match self.largest_gap(&pair, &prism) {
            Ok((best, simplex)) => self.judge(&over, &pair, distance, best, &simplex),
            Err(gap) => self.apart = gap.normal,
        }
    }

    /// The largest gap of the ground below a triangle and a body, or, if they are more than the margin apart, one that shows it.
    fn largest_gap(
        &self,
        pair: &Pair<S>,
        prism: &Prism<S>,
    ) -> Result<(Gap<S>, Simplex<S>), Gap<S>> {
        if pair.b.kind() == ShapeKind::Cylinder {
            let known = prism_gap(pair, prism, self.margin);
            if known.gap > self.margin {
                return Err(known);
            }
            // Of bodies that are apart it tells no distance.
            if known.gap <= S::ZERO && Real::is_finite(known.gap) {
                return Ok((known, Simplex::new(pair.vertex(known.normal))));
            }
        }
        let (start, mut simplex) = begin(pair);
        nearest(pair, start, self.margin, &mut simplex).map(|best| (best, simplex))
    }

    /// Whether a direction shows that a body and the ground below a triangle are apart.
    fn passes(&self, triangle: &Triangle<S>, body: &Body<S>, offset: Vec3<S>, n: Vec3<S>) -> bool {
        // Downwards the ground would have to be looked at, too.
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

    /// The least distance along directions that count, so far.
    fn known(&self) -> S {
        self.deepest.map_or(S::INFINITY, |p| p.distance)
    }

    /// Adds the contacts of a triangle, given its distance along its normal and the largest gap of its prism.
    fn judge(
        &mut self,
        over: &Over<S>,
        pair: &Pair<S>,
        distance: S,
        best: Gap<S>,
        simplex: &Simplex<S>,
    ) {
        let depth = best.gap - pair.b.radius;
        let level = (best.normal - over.normal).norm() <= S::new(LEVEL) * same_direction();
        let ridge = over.triangle.ridge(best);
        if level || over.triangle.admits(&ridge) {
            let touching = self.patch(over, pair, best, simplex);
            touching.iter().for_each(|p| deepen(&mut self.deepest, *p));
            if !level || !over.touch(self.margin, &mut self.found) {
                touching.iter().for_each(|p| self.found.add(*p));
                // Where there is no more room it is found again.
                let _ = self.ridges.try_push(ridge);
            }
        } else {
            if self.sideways.is_none_or(|old| depth < old.distance) {
                let touching = self.patch(over, pair, best, simplex);
                touching.iter().for_each(|p| deepen(&mut self.sideways, *p));
            }
            if over.touch(self.margin, &mut self.doubtful) {
                self.shallowest = Real::max(self.shallowest, distance);
            }
        }
    }

    /// The contacts of the ground below a triangle.
    fn patch(
        &self,
        over: &Over<S>,
        pair: &Pair<S>,
        best: Gap<S>,
        simplex: &Simplex<S>,
    ) -> Points<S> {
        let pose = Pose {
            position: over.triangle.origin,
            rotation: Mat3::IDENTITY,
        };
        let shape = &Shape::new(ShapeKind::HeightField, Vec3::ZERO);
        let ground = Placed { shape, pose: &pose };
        let mut touching = Points::new();
        patch(pair, ground, best, simplex, self.margin, &mut touching);
        touching
    }

    /// Leaves all contacts in what is found. The body is in the field at least as deep as in any prism.
    fn finish(&mut self) {
        let depth = |p: Option<Point<S>>| p.map_or(S::INFINITY, |p| p.distance);
        let (known, other) = (depth(self.deepest), depth(self.sideways));
        let least = Real::min(known, other * S::new(DETOUR));
        let least = match self.deepest {
            Some(_) => least,
            None => Real::min(least, self.shallowest),
        };
        for point in self.doubtful.points() {
            if point.distance >= least - self.tolerance {
                self.found.add(*point);
            }
        }
        // What no face shows: a corner in a groove, or a body between faces.
        for witness in [self.deepest, self.sideways].into_iter().flatten() {
            if self.found.deepest() > witness.distance + self.tolerance {
                self.found.add(witness);
            }
        }
    }
}
