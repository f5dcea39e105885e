//! What of a body lies against a plane: a face, an edge or a corner.

use super::body::{Body, radial_direction};
use super::corners::{EDGE_SINE, Feature, MAX_CORNERS, most_level};
use crate::{Hull, ShapeKind, hull::FACE_COSINE};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// How much further than the others, as a share of its body, a corner must be to count, which would not be among those looked at.
const NOTICEABLE: f64 = 1e-7;
/// Faces tilted by less are level.
const LEVEL: f64 = 2e-3;
/// A cap tilted by less is level to rounding: all its corners are equally deep.
const TILT: f64 = 5e-6;

impl<S: Scalar> Feature<S> {
    /// The feature of a body that is furthest along the unit direction `d`, in the body's frame. Its corners come in an order that
    /// depends on the feature alone.
    pub(super) fn new(body: &Body<S>, d: Vec3<S>) -> Self {
        let mut feature = Feature {
            corners: ArrayVec::new(),
            normal: d,
            radius: None,
        };
        let edge = S::new(EDGE_SINE);
        match body.kind() {
            ShapeKind::Cylinder if d.z.abs() >= S::new(FACE_COSINE) => feature.cap(body.size(), d),
            ShapeKind::Cylinder | ShapeKind::Capsule if d.z.abs() <= edge => {
                feature.edge(body.support(d, d), 2);
            }
            ShapeKind::Box => feature.of_box(body.size(), d),
            ShapeKind::Mesh => feature.of_hull(body, d),
            ShapeKind::HeightField => match body.prism() {
                Some(prism) => prism.feature(d, &mut feature),
                None => feature.corners.push(Vec3::ZERO),
            },
            _ => feature.corners.push(body.support(d, d)),
        }
        feature
    }

    /// The edge along `axis` through a corner.
    fn edge(&mut self, mut corner: Vec3<S>, axis: usize) {
        for sign in [-S::ONE, S::ONE] {
            corner[axis] = corner[axis].copysign(sign);
            self.corners.push(corner);
        }
    }

    fn of_box(&mut self, size: Vec3<S>, d: Vec3<S>) {
        let corner = Vec3::new(
            size.x.copysign(d.x),
            size.y.copysign(d.y),
            size.z.copysign(d.z),
        );
        if let Some(axis) = (0..3).find(|i| d[*i].abs() >= S::new(FACE_COSINE)) {
            let sign = S::ONE.copysign(d[axis]);
            self.normal = Vec3::ZERO;
            self.normal[axis] = sign;
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let mut corner = corner;
                corner[next] = size[next] * S::new(u) * sign;
                corner[last] = size[last] * S::new(v);
                self.corners.push(corner);
            }
        } else if let Some(axis) = (0..3).find(|i| d[*i].abs() <= S::new(EDGE_SINE)) {
            self.edge(corner, axis);
        } else {
            self.corners.push(corner);
        }
    }

    /// Of the faces and edges at the furthest vertex the one that is most nearly level, if one is level enough.
    fn of_hull(&mut self, body: &Body<S>, d: Vec3<S>) {
        let (Some(hull), Some((vertex, corner))) = (body.hull, body.vertex(d)) else {
            self.corners.push(Vec3::ZERO);
            return;
        };
        if let Some(face) = hull.face_across(vertex, Vec3::from_array(d.to_array().map(S::to_f64)))
        {
            self.face(
                hull,
                face,
                vertex,
                d,
                body.bounding_radius * S::new(NOTICEABLE),
            );
            return;
        }
        let neighbors = hull.neighbors(vertex).iter().map(|&k| k as usize);
        let ends = neighbors.map(|k| (k, Vec3::from_f64(hull.vertices()[k].to_array())));
        self.corners.push(corner);
        if let Some((neighbor, end)) = most_level(corner, ends, d) {
            self.corners.insert(usize::from(vertex < neighbor), end);
        }
    }

    /// A face of a hull. Where corners are left out, the furthest vertex is kept, but for a level face if it is not noticeably further
    /// than the others.
    fn face(&mut self, hull: &Hull, face: usize, vertex: usize, d: Vec3<S>, noticeable: S) {
        let at = |v: u32| Vec3::from_f64(hull.vertices()[v as usize].to_array());
        let corners = hull.corners(face);
        let stride = corners.len().div_ceil(MAX_CORNERS - 1);
        self.normal = Vec3::from_f64(hull.normal(face).to_array());
        let level = (d - self.normal).norm_squared() <= S::new(LEVEL * LEVEL);
        let sampled = corners.iter().step_by(stride).map(|&v| d.dot(at(v)));
        let furthest = sampled.fold(-S::INFINITY, S::max);
        let needed = !level || d.dot(at(vertex as u32)) > furthest + noticeable;
        self.corners.clear();
        for (k, &corner) in corners.iter().enumerate() {
            if k % stride == 0 || (needed && corner as usize == vertex) {
                self.corners.push(at(corner));
            }
        }
    }

    /// The cap of a cylinder: corners at equal angles, the first at the deepest point of the rim. They do not turn with a tilt that
    /// nobody can tell, so that a standing cylinder stands still.
    fn cap(&mut self, size: Vec3<S>, d: Vec3<S>) {
        let up = S::ONE.copysign(d.z);
        self.normal = Vec3::new(S::ZERO, S::ZERO, up);
        self.radius = Some(size.x);
        let tilted = (d.x * d.x + d.y * d.y).sqrt() > S::new(TILT);
        let (x, y) = if tilted {
            radial_direction(d)
        } else {
            (S::ONE, S::ZERO)
        };
        for (cosine, sine) in CAP_CIRCLE {
            let (cosine, sine) = (S::new(cosine) * size.x, S::new(sine) * size.x * up);
            self.corners.push(Vec3::new(
                x * cosine - y * sine,
                y * cosine + x * sine,
                size.y * up,
            ));
        }
    }
}

/// Sixteen directions round a circle.
const CAP_CIRCLE: [(f64, f64); 16] = {
    // Cosine and sine of 22.5°, 45° and 67.5°.
    const C: f64 = 0.923_879_532_511_286_7;
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const S: f64 = 0.382_683_432_365_089_8;
    [
        (1.0, 0.0),
        (C, S),
        (D, D),
        (S, C),
        (0.0, 1.0),
        (-S, C),
        (-D, D),
        (-C, S),
        (-1.0, 0.0),
        (-C, -S),
        (-D, -D),
        (-S, -C),
        (0.0, -1.0),
        (S, -C),
        (D, -D),
        (C, -S),
    ]
};
