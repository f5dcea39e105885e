//! Polyhedra with numbered corners and faces.

use crate::hull::Hull;
use clench_math::{Scalar, Vec3};

/// A core with flat faces, or a segment.
pub(super) enum Polyhedron<'a, S> {
    /// Half its length; the second end is at negative z.
    Segment(S),
    /// Half its lengths. Bits of a corner's number tell the axes along which it is negative; faces are numbered by axis
    /// and sign.
    Box(Vec3<S>),
    Hull(&'a Hull),
}

/// The polyhedra of a pair.
pub(super) type Polyhedra<'a, S> = [Polyhedron<'a, S>; 2];

impl<S: Scalar> Polyhedron<'_, S> {
    pub(super) fn corner_count(&self) -> usize {
        match self {
            Polyhedron::Segment(_) => 2,
            Polyhedron::Box(_) => 8,
            Polyhedron::Hull(hull) => hull.vertices().len(),
        }
    }

    pub(super) fn face_count(&self) -> usize {
        match self {
            Polyhedron::Segment(_) => 0,
            Polyhedron::Box(_) => 6,
            Polyhedron::Hull(hull) => hull.face_count(),
        }
    }

    /// Returns the position of a corner.
    pub(super) fn corner(&self, number: u32) -> Vec3<S> {
        let sign = |bit: u32| match number >> bit & 1 {
            0 => S::ONE,
            _ => -S::ONE,
        };
        match self {
            Polyhedron::Segment(half) => Vec3::new(S::ZERO, S::ZERO, sign(0) * *half),
            Polyhedron::Box(h) => Vec3::new(sign(0), sign(1), sign(2)).scale_by(*h),
            Polyhedron::Hull(hull) => Vec3::from_f64(hull.vertices()[number as usize].to_array()),
        }
    }

    /// Returns true if a condition holds for all corners that share an edge with a corner.
    pub(super) fn all_neighbors(&self, number: u32, mut holds: impl FnMut(u32) -> bool) -> bool {
        match self {
            Polyhedron::Segment(_) => holds(number ^ 1),
            Polyhedron::Box(_) => (0..3).all(|axis| holds(number ^ 1 << axis)),
            Polyhedron::Hull(hull) => hull.neighbors(number as usize).iter().all(|&k| holds(k)),
        }
    }

    /// Returns the edge from a corner to the neighbour that is furthest along a direction, by its ends in order.
    pub(super) fn furthest_edge(&self, corner: u32, along: Vec3<S>) -> [u32; 2] {
        let mut best = (-S::INFINITY, corner);
        self.all_neighbors(corner, |k| {
            let reach = along.dot(self.corner(k));
            if reach > best.0 {
                best = (reach, k);
            }
            true
        });
        [corner.min(best.1), corner.max(best.1)]
    }

    /// Returns the face at a corner that is most nearly perpendicular to a unit vector, if any is.
    pub(super) fn face_across(&self, corner: u32, direction: Vec3<S>) -> Option<u32> {
        match self {
            Polyhedron::Segment(_) => None,
            Polyhedron::Box(_) => {
                let [x, y, z] = direction.to_array().map(S::abs);
                let axis = if x > y && x > z {
                    0
                } else {
                    1 + u32::from(z > y)
                };
                Some(2 * axis + (corner >> axis & 1))
            }
            Polyhedron::Hull(hull) => {
                let along = Vec3::from_array(direction.to_array().map(S::to_f64));
                let face = hull.face_across(corner as usize, along)?;
                Some(face as u32)
            }
        }
    }

    /// Returns true if a corner lies on a face.
    pub(super) fn is_on(&self, face: u32, corner: u32) -> bool {
        match self {
            Polyhedron::Segment(_) => false,
            Polyhedron::Box(_) => 2 * (face / 2) + (corner >> (face / 2) & 1) == face,
            Polyhedron::Hull(hull) => hull.faces_at(corner as usize).contains(&face),
        }
    }

    /// Returns the outward unit normal of a face and its offset along it.
    pub(super) fn plane(&self, face: u32) -> (Vec3<S>, S) {
        match self {
            Polyhedron::Segment(_) => (Vec3::ZERO, S::ZERO),
            Polyhedron::Box(h) => {
                let axis = (face / 2) as usize;
                let mut normal = Vec3::ZERO;
                normal[axis] = S::ONE - S::new(f64::from(2 * (face % 2)));
                (normal, h[axis])
            }
            Polyhedron::Hull(hull) => {
                let normal = Vec3::from_f64(hull.normal(face as usize).to_array());
                (normal, S::new(hull.offset(face as usize)))
            }
        }
    }
}
