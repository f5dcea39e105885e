//! A triangle of terrain with the ground below it: a convex body with six corners.

use crate::hull::FACE_COSINE;
use crate::shape::{Core, Feature, most_level};
use clench_math::{Scalar, Vec3};

/// Three top corners, counter-clockwise seen from above, and the three below them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prism<S> {
    corners: [Vec3<S>; 6],
}

/// The top, the bottom and the walls, counter-clockwise seen from outside.
pub(super) const FACES: [&[usize]; 5] = [
    &[0, 1, 2],
    &[5, 4, 3],
    &[0, 3, 4, 1],
    &[1, 4, 5, 2],
    &[2, 5, 3, 0],
];
/// For each edge: its ends, the face that traverses it from the first to the second, and the other face.
pub(super) const EDGES: [[usize; 4]; 9] = [
    [0, 1, 0, 2],
    [1, 2, 0, 3],
    [2, 0, 0, 4],
    [5, 4, 1, 3],
    [4, 3, 1, 2],
    [3, 5, 1, 4],
    [0, 3, 2, 4],
    [1, 4, 3, 2],
    [2, 5, 4, 3],
];
/// The z component, by [`FACE_COSINE`], above which a unit direction matches no wall.
pub(crate) const RISE: f64 = 0.1;
/// The neighbours of each corner.
const NEIGHBORS: [[usize; 3]; 6] = [
    [1, 2, 3],
    [2, 0, 4],
    [0, 1, 5],
    [4, 5, 0],
    [5, 3, 1],
    [3, 4, 2],
];

impl<S: Scalar> Prism<S> {
    /// Creates the prism between a triangle and the horizontal plane at `bottom`.
    pub(super) fn new(top: [Vec3<S>; 3], bottom: S) -> Self {
        let [p, q, r] = top;
        let below = |v: Vec3<S>| Vec3::new(v.x, v.y, bottom);
        Prism {
            corners: [p, q, r, below(p), below(q), below(r)],
        }
    }

    /// Returns the three top corners and those below them.
    pub(super) fn corners(&self) -> &[Vec3<S>; 6] {
        &self.corners
    }

    /// Returns the outward unit normals of the faces.
    pub(super) fn normals(&self) -> [Vec3<S>; 5] {
        let [p, q, r, ..] = self.corners;
        let wall = |from: Vec3<S>, to: Vec3<S>| {
            let outward = Vec3::new(to.y - from.y, from.x - to.x, S::ZERO);
            outward.normalize().0
        };
        [
            (q - p).cross(r - p).normalize().0,
            Vec3::new(S::ZERO, S::ZERO, -S::ONE),
            wall(p, q),
            wall(q, r),
            wall(r, p),
        ]
    }

    /// Returns the radius of a sphere about the origin that encloses the prism, m.
    pub(super) fn bounding_radius(&self) -> S {
        let largest = |along: [S; 4]| {
            along
                .into_iter()
                .fold(S::ZERO, |largest, x| largest.max(x.abs()))
        };
        let [p, q, r, below, ..] = self.corners;
        let [x, y] = [[p.x, q.x, r.x, p.x], [p.y, q.y, r.y, p.y]].map(largest);
        Vec3::new(x, y, largest([p.z, q.z, r.z, below.z])).norm()
    }

    /// Returns the index of the corner that is furthest along `d`.
    #[inline]
    fn furthest(&self, d: Vec3<S>) -> usize {
        let first = if d.z < S::ZERO { 3 } else { 0 };
        let mut best = (self.corners[first].dot(d), first);
        for k in [first + 1, first + 2] {
            let along = self.corners[k].dot(d);
            if along > best.0 {
                best = (along, k);
            }
        }
        best.1
    }
}

impl<S: Scalar> Core<S> for Prism<S> {
    #[inline]
    fn support(&self, _: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        self.corners[self.furthest(side)]
    }

    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        // The squares of a cosine's numerator and denominator.
        let mut best = (S::new(FACE_COSINE).squared(), S::ONE, None);
        // A direction that rises this steeply can only be the normal of the top.
        let faces = if d.z > S::new(RISE) {
            &FACES[..1]
        } else {
            &FACES[..]
        };
        for &face in faces {
            let [p, q, r] = [face[0], face[1], face[2]].map(|k| self.corners[k]);
            let normal = (q - p).cross(r - p);
            let (along, square) = (normal.dot(d), normal.norm_squared());
            if along > S::ZERO && along.squared() * best.1 >= best.0 * square {
                best = (along.squared(), square, Some((face, normal)));
            }
        }
        if let (_, _, Some((face, normal))) = best {
            let mut feature = Feature::along(normal.normalize().0);
            let corners = face.iter().map(|&k| self.corners[k]);
            feature.corners.extend(corners);
            return feature;
        }
        let first = self.furthest(d);
        let corner = self.corners[first];
        let ends = NEIGHBORS[first].into_iter().map(|k| (k, self.corners[k]));
        let mut feature = Feature::corner(d, corner);
        let end = most_level(corner, ends, d).map(|(_, end)| end);
        feature.corners.extend(end);
        feature
    }
}
