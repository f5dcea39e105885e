//! Clipping of a body's feature to the triangle that it faces.

use super::grid::Triangle;
use super::manifold::Manifold;
use crate::narrow::convex::body::Body;
use crate::narrow::convex::pair::across;
use crate::narrow::{per_lane::Point, polygon::Polygon};
use clench_math::{Mat3, Real, Scalar, Vec3};

/// The tolerance, relative to the body, by which a corner outside a triangle still belongs to it; at least rounding.
const OUTSIDE_TOLERANCE: f64 = 1e-9;

/// A triangle, and the body in its frame.
pub(super) struct FaceClip<'a, S> {
    pub triangle: &'a Triangle<'a, S>,
    /// The triangle's unit normal.
    pub normal: Vec3<S>,
    pub body: &'a Body<'a, S>,
    pub rotation: &'a Mat3<S>,
    pub offset: Vec3<S>,
}

/// The line of a side of a triangle: the outward vector, and its offset along it plus some slack, which scales with
/// `out`.
#[derive(Clone, Copy)]
struct Side<S> {
    out: Vec3<S>,
    limit: S,
    slack: S,
}

impl<S: Scalar> FaceClip<'_, S> {
    /// Adds a contact for each corner of the body's feature, clipped to the triangle, that is near enough. Returns true
    /// if there are any.
    ///
    /// Clipping adds no corner where the surface continues in the same plane.
    pub(super) fn touch(&self, margin: S, found: &mut Manifold<S>) -> bool {
        let feature = self.body.feature(-self.rotation.transpose_mul(self.normal));
        let [p, q, r] = self.triangle.corners;
        // Each side is opposite to the corner of its index.
        let sides = [self.side(q, r), self.side(r, p), self.side(p, q)];
        let place = |corner: &Vec3<S>| self.offset + *self.rotation * *corner;
        let beyond = |side: &Side<S>| {
            let mut corners = feature.corners.iter();
            corners.all(|corner| side.out.dot(place(corner)) > side.limit)
        };
        if sides.iter().any(beyond) {
            return false;
        }
        if let [corner] = &feature.corners[..] {
            return self.add(place(corner), margin, found);
        }
        let (e, f) = across(self.normal);
        let projection = Mat3::from_rows(e, f, self.normal);
        let mut clipped = Polygon::empty();
        for corner in &feature.corners {
            clipped.push(projection * place(corner));
        }
        let own = clipped.clone();
        for Side { out, limit, .. } in sides {
            clipped.clip((out.dot(e), out.dot(f)), limit);
        }
        let mut any = false;
        for corner in clipped.corners() {
            let place = projection.transpose_mul(*corner);
            if own.corners().contains(corner) || self.ends_at(place, &sides) {
                any |= self.add(place, margin, found);
            } else {
                any |= corner.z - self.body.radius <= margin;
            }
        }
        any
    }

    fn side(&self, from: Vec3<S>, to: Vec3<S>) -> Side<S> {
        let out = (to - from).cross(self.normal);
        let size = out.x.abs().max(out.y.abs()).max(out.z.abs());
        let tolerance = Real::max(S::new(OUTSIDE_TOLERANCE), S::EPSILON * S::new(8.0));
        let slack = self.body.bounding_radius * tolerance * size;
        Side {
            out,
            limit: out.dot(from) + slack,
            slack,
        }
    }

    /// Returns true if the plane of the triangle ends at one of the sides that a point is on.
    fn ends_at(&self, place: Vec3<S>, sides: &[Side<S>; 3]) -> bool {
        sides.iter().enumerate().any(|(k, side)| {
            let on_side = side.out.dot(place) > side.limit - side.slack * S::new(4.0);
            on_side && !self.triangle.goes_on_across(k, self.normal)
        })
    }

    /// Adds the contact below a point of the body's core, if it is near enough.
    fn add(&self, point: Vec3<S>, margin: S, found: &mut Manifold<S>) -> bool {
        let contact = self.contact(point);
        let near = contact.distance <= margin;
        if near {
            found.add(contact);
        }
        near
    }

    /// Returns the contact below a point of the body's core.
    pub(super) fn contact(&self, point: Vec3<S>) -> Point<S> {
        let height = self.normal.dot(point);
        let distance = height - self.body.radius;
        let down = height - distance * S::new(0.5);
        Point {
            position: self.triangle.origin + point - self.normal * down,
            normal: self.normal,
            distance,
        }
    }
}
