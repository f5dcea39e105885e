//! Features projected along the contact normal, and their clipping.
//!
//! In the projection an edge is a segment and a face a convex polygon, with a linear height. One is clipped against the
//! sides of the other. A round cap clips as a circle: it keeps corners within the circle, the ends of chords, and
//! sample points of the circle inside the polygon.

use crate::narrow::polygon::Polygon;
use crate::shape::{Feature, MAX_CORNERS};
use arrayvec::ArrayVec;
use clench_math::{Mat3, Scalar, Vec3};

/// The angle below which edges are parallel; others cross.
pub(crate) const PARALLEL: f64 = 1e-3;

/// The distance beyond an end of an edge, relative to its length, at which a crossing is still on the edge.
pub(crate) const BEYOND_END: f64 = 1e-5;

/// A projected edge or face: x and y across the normal, z along it.
pub(super) struct ProjectedFeature<S> {
    corners: ArrayVec<Vec3<S>, MAX_CORNERS>,
    /// The slope of the height.
    slope: (S, S),
    /// The round cap that the polygon samples.
    disc: Option<Disc<S>>,
}

/// A round cap: two axes in its plane, a point with the coordinates of its middle along them, its radius, and the
/// vector from its middle to its first corner.
struct Disc<S> {
    x: Vec3<S>,
    y: Vec3<S>,
    center: Vec3<S>,
    radius: S,
    first: Vec3<S>,
}

impl<S: Scalar> ProjectedFeature<S> {
    /// Projects a feature of a body with the given origin and axes in the projection. `below` is true if the normal
    /// points into the body, which reverses the order of corners.
    pub(super) fn new(feature: &Feature<S>, origin: Vec3<S>, axes: &Mat3<S>, below: bool) -> Self {
        let mut corners = ArrayVec::new();
        let place = |corner: &Vec3<S>| origin + *axes * *corner;
        if below {
            corners.extend(feature.corners.iter().rev().map(place));
        } else {
            corners.extend(feature.corners.iter().map(place));
        }
        let normal = *axes * feature.normal;
        let slope = match corners[..] {
            [p, q] => {
                let (x, y) = (q.x - p.x, q.y - p.y);
                let rise = (q.z - p.z) / (x * x + y * y).max(S::MIN_POSITIVE);
                (x * rise, y * rise)
            }
            _ => (-normal.x / normal.z, -normal.y / normal.z),
        };
        let disc = feature.radius.map(|radius| Disc {
            x: axes.column(0),
            y: axes.column(1),
            center: origin,
            radius,
            first: (feature.corners.first()).map_or(Vec3::ZERO, |corner| {
                axes.column(0) * corner.x + axes.column(1) * corner.y
            }),
        });
        ProjectedFeature {
            corners,
            slope,
            disc,
        }
    }

    fn is_edge(&self) -> bool {
        self.corners.len() == 2
    }

    /// Returns true if it is a round cap.
    pub(super) fn is_cap(&self) -> bool {
        self.disc.is_some()
    }

    /// Returns the vector from the middle of a round cap to its first corner.
    pub(super) fn cap_direction(&self) -> Option<Vec3<S>> {
        self.disc.as_ref().map(|disc| disc.first)
    }

    /// Returns a direction that rotates with the body: to the first corner of a round cap, else along the first edge.
    pub(super) fn direction(&self) -> Vec3<S> {
        let along_edge = || self.corners[1] - self.corners[0];
        self.cap_direction().unwrap_or_else(along_edge)
    }

    /// Returns the height of the feature's plane at a point of the projection.
    pub(super) fn height(&self, p: Vec3<S>) -> S {
        let origin = self.corners[0];
        origin.z + self.slope.0 * (p.x - origin.x) + self.slope.1 * (p.y - origin.y)
    }

    /// Sets `out` to the overlap of two features in the projection, extended by `slack` m: the corners of a polygon,
    /// the ends of a segment, or a point. Their heights are undefined.
    pub(super) fn overlap(&self, other: &ProjectedFeature<S>, slack: S, out: &mut Polygon<S>) {
        out.clear();
        if let (&[p, p_end], &[q, q_end]) = (&self.corners[..], &other.corners[..])
            && !parallel(p_end - p, q_end - q)
        {
            return out.push(crossing((p, p_end), (q, q_end)));
        }
        // A face clips an edge, a circle a polygon, few sides many.
        let self_is_cut = self.is_edge()
            || (!other.is_edge()
                && (other.disc.is_some()
                    || (self.disc.is_none() && self.corners.len() >= other.corners.len())));
        let (cut, by) = if self_is_cut {
            (self, other)
        } else {
            (other, self)
        };
        match &by.disc {
            Some(disc) => by.clip_to_disc(disc, cut, slack, out),
            None => {
                cut.corners.iter().for_each(|corner| out.push(*corner));
                by.clip(out, slack);
            }
        }
    }

    /// Clips a polygon to the sides of this one, or between the ends of this segment.
    fn clip(&self, polygon: &mut Polygon<S>, slack: S) {
        let corners = &self.corners;
        for (k, p) in corners.iter().enumerate() {
            let q = corners[(k + 1) % corners.len()];
            let (x, y) = (q.x - p.x, q.y - p.y);
            let outward = if self.is_edge() { (-x, -y) } else { (y, -x) };
            let beyond = (x * x + y * y).sqrt() * slack;
            polygon.clip(outward, outward.0 * p.x + outward.1 * p.y + beyond);
        }
    }

    /// Returns true if the corners of another feature lie in this face.
    pub(super) fn contains(&self, other: &ProjectedFeature<S>, slack: S) -> bool {
        other
            .corners
            .iter()
            .all(|corner| self.covers(*corner, slack))
    }

    /// Returns true if a point of the projection lies in this face.
    fn covers(&self, p: Vec3<S>, slack: S) -> bool {
        if let Some(disc) = &self.disc {
            let (x, y) = self.in_plane(disc, p);
            return x * x + y * y <= (disc.radius + slack).squared();
        }
        let corners = &self.corners;
        (0..corners.len()).all(|k| {
            let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
            cross_2d(to - from, p - from) >= -slack * (to - from).norm()
        })
    }

    /// Returns the coordinates, in the plane of this cap and from its middle, of a point of the projection.
    fn in_plane(&self, disc: &Disc<S>, p: Vec3<S>) -> (S, S) {
        let arm = Vec3::new(p.x, p.y, self.height(p)) - disc.center;
        (disc.x.dot(arm), disc.y.dot(arm))
    }

    /// Clips an edge or a face to this round cap.
    fn clip_to_disc(
        &self,
        disc: &Disc<S>,
        cut: &ProjectedFeature<S>,
        slack: S,
        out: &mut Polygon<S>,
    ) {
        if let [p, q] = cut.corners[..] {
            let (from, to) = self.chord(disc, p, q);
            for t in [from, to] {
                out.push(p + (q - p) * t.clamp(S::ZERO, S::ONE));
            }
            return;
        }
        let corners = &cut.corners;
        // If all corners are inside, so is the face.
        if corners.iter().all(|p| self.covers(*p, slack)) {
            corners.iter().for_each(|corner| out.push(*corner));
            return;
        }
        for (k, &p) in corners.iter().enumerate() {
            if self.covers(p, slack) {
                out.push(p);
            }
            let q = corners[(k + 1) % corners.len()];
            let (from, to) = self.chord(disc, p, q);
            for t in [from, to] {
                if from < to && t > S::ZERO && t < S::ONE {
                    out.push(p + (q - p) * t);
                }
            }
        }
        for &p in &self.corners {
            if cut.covers(p, slack) {
                out.push(p);
            }
        }
        out.sort_by_angle();
    }

    /// Returns the parameters, 0 to 1 on the segment, at which it enters and leaves this cap's circle; twice that
    /// nearest to the middle if it misses the circle.
    fn chord(&self, disc: &Disc<S>, p: Vec3<S>, q: Vec3<S>) -> (S, S) {
        let (from, to) = (self.in_plane(disc, p), self.in_plane(disc, q));
        let along = (to.0 - from.0, to.1 - from.1);
        let square = (along.0 * along.0 + along.1 * along.1).max(S::MIN_POSITIVE);
        let middle = -(from.0 * along.0 + from.1 * along.1) / square;
        let miss = from.0 * along.1 - from.1 * along.0;
        let reach = (disc.radius * disc.radius * square - miss * miss).max(S::ZERO);
        let reach = reach.sqrt() / square;
        (middle - reach, middle + reach)
    }
}

fn cross_2d<S: Scalar>(u: Vec3<S>, v: Vec3<S>) -> S {
    u.x * v.y - u.y * v.x
}

fn parallel<S: Scalar>(u: Vec3<S>, v: Vec3<S>) -> bool {
    let lengths = (u.x * u.x + u.y * u.y) * (v.x * v.x + v.y * v.y);
    cross_2d(u, v).squared() <= lengths * S::new(PARALLEL * PARALLEL)
}

/// Returns the crossing of two segments in the projection, or the middle between their nearest points.
fn crossing<S: Scalar>((p, p_end): (Vec3<S>, Vec3<S>), (q, q_end): (Vec3<S>, Vec3<S>)) -> Vec3<S> {
    let (u, v, offset) = (p_end - p, q_end - q, q - p);
    let inverse = S::ONE / cross_2d(u, v);
    let (on_p, on_q) = (cross_2d(offset, v) * inverse, cross_2d(offset, u) * inverse);
    let (mut s, mut t) = (on_p.clamp(S::ZERO, S::ONE), on_q.clamp(S::ZERO, S::ONE));
    let beyond = (on_p - s).abs().max((on_q - t).abs());
    if beyond > S::new(BEYOND_END) {
        // The lines of nearly parallel segments may cross far beyond the end at which the segments are nearest.
        let nearest = |along: Vec3<S>, to: Vec3<S>| {
            let square = along.x * along.x + along.y * along.y;
            ((along.x * to.x + along.y * to.y) / square).clamp(S::ZERO, S::ONE)
        };
        t = nearest(v, p + u * s - q);
        s = nearest(u, q + v * t - p);
    }
    (p + u * s + q + v * t) * S::new(0.5)
}
