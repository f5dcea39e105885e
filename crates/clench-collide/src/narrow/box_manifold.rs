//! The contact points of two boxes, given the touching face.

use super::{
    box_box::{BoxPair, tolerance},
    per_lane::{Point, Points},
    polygon::Polygon,
};
use clench_math::{Scalar, Vec3};

/// The corners of a face, in order.
const CORNERS: [(f64, f64); 4] = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];

impl<S: Scalar> BoxPair<S> {
    /// Clips the face of the other box that most opposes the touching face. Each corner that is near enough is a
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
        // Clipping at a corner duplicates the point.
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

    /// Returns the face of the other box that most opposes the face across `axis` of `owner`, in that face's frame.
    fn opposing_face(&self, owner: usize, axis: usize, side: S) -> Polygon<S> {
        let (rotation, other) = (&self.rotation[owner], self.size[1 - owner]);
        let slope = rotation.rows[axis];
        let mut largest = 0;
        for k in 1..3 {
            if slope[k].abs() > slope[largest].abs() {
                largest = k;
            }
        }
        let facing = if side * slope[largest] > S::ZERO {
            -S::ONE
        } else {
            S::ONE
        };
        let half = |k: usize| rotation.column(k) * other[k];
        let center = self.offset[owner] + half(largest) * facing;
        let (u, v) = (half((largest + 1) % 3), half((largest + 2) % 3));
        let height = self.size[owner][axis];
        let mut face = Polygon::empty();
        for (along_u, along_v) in CORNERS {
            let p = center + u * S::new(along_u) + v * S::new(along_v);
            let above = side * p[axis] - height;
            face.push(Vec3::new(p[(axis + 1) % 3], p[(axis + 2) % 3], above));
        }
        face
    }
}
