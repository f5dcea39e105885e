//! The contact points of two boxes, once it is known which feature of each touches the other.

use super::{
    box_box::{BoxPair, tolerance},
    one_by_one::{Point, Points},
    polygon::Polygon,
};
use clench_math::{Scalar, Vec3};

/// The corners of a face in order around it.
const AROUND: [(f64, f64); 4] = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];

impl<S: Scalar> BoxPair<S> {
    /// The face of the other box that most opposes the touching face, clipped to it: each corner near enough is a
    /// contact, midway between the two faces.
    pub(super) fn face_contact(&self, owner: usize, axis: usize, points: &mut Points<S>) {
        let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
        let size = self.size[owner];
        let side = S::ONE.copysign(self.offset[owner][axis]);
        let height = size[axis];
        let mut face = self.opposing_face(owner, axis, side);
        for sign in [S::ONE, -S::ONE] {
            face.clip((sign, S::ZERO), size[x]);
        }
        for sign in [S::ONE, -S::ONE] {
            face.clip((S::ZERO, sign), size[y]);
        }

        let pose = &self.pose[owner];
        let out = if owner == 0 { side } else { -side };
        let normal = pose.rotation.column(axis) * out;
        // Cutting at a corner leaves the same point twice.
        let radius = tolerance::<S>(1e-7, 100.0);
        let apart = radius * radius * (size[x] * size[x] + size[y] * size[y]);
        let mut accepted = Polygon::empty();
        for &p in face.corners() {
            let same = |q: &Vec3<S>| (q.x - p.x).squared() + (q.y - p.y).squared() < apart;
            if p.z > self.margin || accepted.corners().iter().any(same) {
                continue;
            }
            if points.is_full() {
                break;
            }
            accepted.push(p);
            let mut local = Vec3::ZERO;
            local[x] = p.x;
            local[y] = p.y;
            local[axis] = side * (height + S::new(0.5) * p.z);
            points.push(Point {
                position: pose.point(local),
                normal,
                distance: p.z,
            });
        }
    }

    /// The face of the other box that most opposes the face across `axis` of `owner`, in that face's frame.
    fn opposing_face(&self, owner: usize, axis: usize, side: S) -> Polygon<S> {
        let (rotation, other) = (&self.rotation[owner], self.size[1 - owner]);
        let slope = rotation.rows[axis];
        let mut most = 0;
        for k in 1..3 {
            if slope[k].abs() > slope[most].abs() {
                most = k;
            }
        }
        let facing = if side * slope[most] > S::ZERO {
            -S::ONE
        } else {
            S::ONE
        };
        let half = |k: usize| rotation.column(k) * other[k];
        let center = self.offset[owner] + half(most) * facing;
        let (u, v) = (half((most + 1) % 3), half((most + 2) % 3));
        let height = self.size[owner][axis];
        let mut face = Polygon::empty();
        for (along_u, along_v) in AROUND {
            let p = center + u * S::new(along_u) + v * S::new(along_v);
            let above = side * p[axis] - height;
            face.push(Vec3::new(p[(axis + 1) % 3], p[(axis + 2) % 3], above));
        }
        face
    }

    /// The nearest points of the two supporting edges, measured along the axis across them.
    pub(super) fn edge_contact(&self, i: usize, j: usize, points: &mut Points<S>) {
        let rotation = &self.rotation[0];
        let (n, _) = self.edge_axis(i, j).normalize();
        let n = n * S::ONE.copysign(n.dot(self.offset[0]));
        let direction = rotation.column(j);
        let mut first = Vec3::ZERO;
        first[i] = S::ONE;

        let (edges, count) = supporting_edges(self.size[0], n, i);
        let (others, other_count) = supporting_edges(self.size[1], -rotation.transpose_mul(n), j);
        let mut nearest = None;
        for &edge in &edges[..count] {
            for &other in &others[..other_count] {
                let other = self.offset[0] + *rotation * other;
                let lengths = (self.size[0][i], self.size[1][j]);
                let (p, q) = segments((edge, first), (other, direction), lengths);
                let gap = (q - p).norm_squared();
                if nearest.is_none_or(|(least, _, _)| gap < least) {
                    nearest = Some((gap, p, q));
                }
            }
        }
        let Some((_, p, q)) = nearest else { return };
        let distance = (q - p).dot(n);
        if distance <= self.reach {
            points.push(Point {
                position: self.pose[0].point((p + q) * S::new(0.5)),
                normal: self.pose[0].rotation * n,
                distance,
            });
        }
    }
}

/// The middle of the edge along `axis` that lies furthest along `n`; two, where `n` is across a face so nearly that
/// rounding decides between them.
fn supporting_edges<S: Scalar>(size: Vec3<S>, n: Vec3<S>, axis: usize) -> ([Vec3<S>; 2], usize) {
    let ambiguous = tolerance::<S>(1e-9, 100.0);
    let mut middle = size;
    middle[axis] = S::ZERO;
    let mut undecided = None;
    for k in [(axis + 2) % 3, (axis + 1) % 3] {
        middle[k] = middle[k].copysign(n[k]);
        if n[k].abs() < ambiguous {
            undecided = Some(k);
        }
    }
    let mut other = middle;
    match undecided {
        None => ([middle, middle], 1),
        Some(k) => {
            other[k] = -other[k];
            ([middle, other], 2)
        }
    }
}

/// The nearest points of two segments that are not parallel, each given by its middle, unit direction and half length.
fn segments<S: Scalar>(
    (p, u): (Vec3<S>, Vec3<S>),
    (q, v): (Vec3<S>, Vec3<S>),
    (half_u, half_v): (S, S),
) -> (Vec3<S>, Vec3<S>) {
    let offset = q - p;
    let (cosine, along_u, along_v) = (u.dot(v), u.dot(offset), v.dot(offset));
    let sine_squared = S::ONE - cosine * cosine;
    let free = if sine_squared < S::new(1e-15) {
        S::ZERO
    } else {
        (along_u - cosine * along_v) / sine_squared
    };
    let s = free.clamp(-half_u, half_u);
    let t = (cosine * s - along_v).clamp(-half_v, half_v);
    let s = (along_u + cosine * t).clamp(-half_u, half_u);
    (p + u * s, q + v * t)
}
