//! Box–box: separating axes, then one box's face clipped to the other's, or two crossing edges.
//!
//! Two boxes are apart exactly if a face normal of either, or a cross product of their edges, separates them. If they
//! overlap, the axis of largest separation defines the depth and the kind of contact. A face yields up to eight points,
//! two edges one point, or the patch of nearly level faces. The tie-breaking rules, which affect how stacks rest, and
//! their numbers follow MuJoCo 4.0's collider.
//!
//! If the boxes are apart, the axis yields their distance only if a corner is over a face; otherwise the nearest points
//! are found as for any convex shapes.

use super::convex;
use super::per_lane::{Points, per_lane_where};
use super::placed::Placed;
use super::separating_axis::SeparatingAxis;
use crate::contact::Contacts;
use crate::pose::Pose;
use crate::shape::Cuboid;
use clench_math::{Mask, Mat3, Real, Scalar, Vec3, kernel};

/// The margin by which an edge pair must beat the best face, relative to its own separation, to break a tie.
pub(crate) const EDGE_BIAS: f64 = 1e-6;
/// The cosine (0.05°) from which an edge axis counts as the best face axis, since stacks rest on faces ...
pub(crate) const ALIAS_COSINE: f64 = 1.0 - 3.8e-7;
/// ... unless it is better by this fraction of the face's separation.
pub(crate) const ALIAS_SHARE: f64 = 0.05;
/// The angle up to which faces are level, rad.
const LEVEL: f64 = 1e-8;

/// Returns a rounding tolerance: MuJoCo's in double precision, at least `units` in the last place.
#[inline]
pub(super) fn tolerance<S: Scalar>(double: f64, units: f64) -> S {
    S::new(double).max(S::EPSILON * S::new(units))
}

/// Computes the contacts of two boxes. `axis`, the last separating direction, may prove at once that there are none; if
/// they are found to be apart, it is updated.
#[kernel]
pub(super) fn box_box<T: Real>(
    a: Placed<Cuboid<T>, T>,
    b: Placed<Cuboid<T>, T>,
    margin: T,
    axis: &mut SeparatingAxis<T>,
    out: &mut Contacts<T>,
) {
    let near = !axis.separates(a.any(), b.any(), margin);
    if !near.any() {
        return;
    }
    per_lane_where(near, a, b, margin, out, |lane, a, b, margin, found| {
        if let Err(direction) = points(a, b, margin, found) {
            axis.set(lane, direction);
        }
    });
}

/// Computes the contacts of one environment.
///
/// # Errors
/// Returns the separating direction as an error if the boxes are apart, in the frame of the first.
fn points<S: Scalar>(
    a: Placed<Cuboid<S>, S>,
    b: Placed<Cuboid<S>, S>,
    margin: S,
    points: &mut Points<S>,
) -> Result<(), Vec3<S>> {
    let boxes = BoxPair::new(a, b, margin);
    let (feature, separation) = boxes.touching_feature()?;
    match feature {
        TouchingFeature::Face { owner, axis } => {
            boxes.face_contact(owner, axis, points);
            let least = points
                .iter()
                .fold(S::INFINITY, |least, p| p.distance.min(least));
            if separation <= S::ZERO || least <= separation + boxes.slack {
                return Ok(());
            }
        }
        TouchingFeature::Edges(i, j) if separation <= S::ZERO => {
            let normal = boxes.edge_normal(i, j);
            convex::points_along((a.any(), b.any()), (normal, separation), margin, points);
            return Ok(());
        }
        TouchingFeature::Edges(..) => {}
    }
    points.clear();
    convex::points(a.any(), b.any(), margin, None, points)
}

/// One axis of each box.
type EdgePair = (usize, usize);

/// The touching features of two boxes.
#[derive(Clone, Copy)]
enum TouchingFeature {
    /// A face across `axis` of box `owner` (0 or 1).
    Face { owner: usize, axis: usize },
    /// An edge along an axis of each box.
    Edges(usize, usize),
}

/// Each box in the frame of the other.
pub(super) struct BoxPair<S> {
    pub pose: [Pose<S>; 2],
    /// The half lengths.
    pub size: [Vec3<S>; 2],
    /// The centre of the other box, in the frame of each.
    pub offset: [Vec3<S>; 2],
    /// The axes of the other box as columns, in the frame of each.
    pub rotation: [Mat3<S>; 2],
    pub margin: S,
    /// The rounding error of a separation.
    slack: S,
    /// The largest separation that counts as touching: the margin, plus some slack so that no pair is missed.
    reach: S,
}

impl<S: Scalar> BoxPair<S> {
    fn new(a: Placed<Cuboid<S>, S>, b: Placed<Cuboid<S>, S>, margin: S) -> Self {
        let pose = [*a.pose, *b.pose];
        let size = [a.shape.half_lengths, b.shape.half_lengths];
        let rotation = pose[0].rotation.transpose() * pose[1].rotation;
        let extent = |v: Vec3<S>| v.x + v.y + v.z;
        let slack = tolerance::<S>(1e-13, 8.0) * (extent(size[0]) + extent(size[1]));
        BoxPair {
            pose,
            size,
            offset: [
                pose[0].local(pose[1].position),
                pose[1].local(pose[0].position),
            ],
            rotation: [rotation, rotation.transpose()],
            margin,
            reach: margin + slack,
            slack,
        }
    }

    /// Returns the feature of largest separation.
    ///
    /// # Errors
    /// Returns its normal towards the second box, in the frame of the first, as an error if beyond reach.
    fn touching_feature(&self) -> Result<(TouchingFeature, S), Vec3<S>> {
        let (face, face_separation) = self.best_face()?;
        let (edges, separation) = self.best_edges(face_separation)?;
        let Some((i, j)) = edges else {
            return Ok((face, face_separation));
        };
        let (direction, _) = self.edge_axis(i, j).normalize();
        let along_face = match face {
            TouchingFeature::Face { owner: 0, axis } => direction[axis].abs(),
            TouchingFeature::Face { axis, .. } => {
                self.rotation[0].column(axis).dot(direction).abs()
            }
            TouchingFeature::Edges(..) => S::ZERO,
        };
        let share = S::new(ALIAS_SHARE) * face_separation.abs() + S::new(1e-15);
        let alias = along_face > S::new(ALIAS_COSINE) && separation < face_separation + share;
        Ok(match alias {
            true => (face, face_separation),
            false => (TouchingFeature::Edges(i, j), separation),
        })
    }

    /// Returns the face of largest separation.
    ///
    /// # Errors
    /// Returns the normal as an error if a face separates the boxes.
    fn best_face(&self) -> Result<(TouchingFeature, S), Vec3<S>> {
        let (owner, axis) = (0, 0);
        let first = self.face_separation(owner, axis);
        let mut best = (TouchingFeature::Face { owner, axis }, first);
        let mut chosen = (owner, axis);
        for owner in 0..2 {
            for axis in 0..3 {
                let separation = self.face_separation(owner, axis);
                if separation > self.reach {
                    return Err(self.face_normal(owner, axis));
                }
                let level = S::IS_DUAL && separation >= best.1 - self.slack;
                if separation > best.1
                    || (level && self.covers(owner, axis) && !self.covers(chosen.0, chosen.1))
                {
                    best = (TouchingFeature::Face { owner, axis }, separation);
                    chosen = (owner, axis);
                }
            }
        }
        Ok(best)
    }

    /// Returns true if a face of the other box lies level in the faces of box `owner` across `axis`. Of two level
    /// faces, the larger separation is that of the outer one if they turn.
    fn covers(&self, owner: usize, axis: usize) -> bool {
        let (size, other) = (self.size[owner], self.size[1 - owner]);
        let rows = &self.rotation[owner].rows;
        let level = (rows[axis].to_array().iter()).any(|x| x.abs() >= S::new(1.0 - LEVEL * LEVEL));
        let inside = |i: usize| {
            let row = rows[i];
            let extent = row.x.abs() * other.x + row.y.abs() * other.y + row.z.abs() * other.z;
            self.offset[owner][i].abs() + extent <= size[i] + self.slack
        };
        level && inside((axis + 1) % 3) && inside((axis + 2) % 3)
    }

    /// Returns the distance of the other box from the nearer face of box `owner` across `axis`.
    #[inline(always)]
    fn face_separation(&self, owner: usize, axis: usize) -> S {
        let (size, other) = (self.size[owner], self.size[1 - owner]);
        let row = self.rotation[owner].rows[axis];
        let extent = row.x.abs() * other.x + row.y.abs() * other.y + row.z.abs() * other.z;
        self.offset[owner][axis].abs() - size[axis] - extent
    }

    /// Returns the best edge pair that beats the best face, if any, and the largest separation.
    ///
    /// # Errors
    /// Returns the normal as an error if an edge pair separates the boxes.
    fn best_edges(&self, face: S) -> Result<(Option<EdgePair>, S), Vec3<S>> {
        let mut best = (None, face);
        let (rotation, offset, [a, b]) = (&self.rotation[0].rows, self.offset[0], self.size);
        for i in 0..3 {
            let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
            for j in 0..3 {
                // In the first box's frame the product is (0, -v, u) from axis i on. Up to signs, its components along
                // the second box's other axes are those of axis i along each one's successor.
                let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
                let (u, v) = (rotation[i1][j], rotation[i2][j]);
                let sine_squared = u * u + v * v;
                // The cross product of nearly parallel edges is noise, and the faces cover the case.
                if sine_squared < S::EPSILON * S::new(0.5) {
                    continue;
                }
                let extents = a[i1] * v.abs()
                    + a[i2] * u.abs()
                    + b[j1] * rotation[i][j2].abs()
                    + b[j2] * rotation[i][j1].abs();
                let beyond = (u * offset[i2] - v * offset[i1]).abs() - extents;
                let separation = beyond / sine_squared.sqrt();
                if separation > self.reach {
                    return Err(self.edge_normal(i, j));
                }
                let biased = separation - S::new(EDGE_BIAS) * separation.abs();
                if biased > best.1 && separation > face {
                    best = (Some((i, j)), separation);
                }
            }
        }
        Ok(best)
    }

    /// Returns the normal of a box's face towards the second box, in the first box's frame.
    fn face_normal(&self, owner: usize, axis: usize) -> Vec3<S> {
        let mut normal = Vec3::ZERO;
        normal[axis] = S::ONE;
        if owner == 1 {
            normal = self.rotation[0].column(axis);
        }
        normal * S::ONE.copysign(normal.dot(self.offset[0]))
    }

    /// Returns the cross product of axis `i` of the first box with axis `j` of the second, in the first box's frame.
    fn edge_axis(&self, i: usize, j: usize) -> Vec3<S> {
        let mut unit = Vec3::ZERO;
        unit[i] = S::ONE;
        unit.cross(self.rotation[0].column(j))
    }

    /// Returns the unit vector along that product, towards the second box.
    fn edge_normal(&self, i: usize, j: usize) -> Vec3<S> {
        let (n, _) = self.edge_axis(i, j).normalize();
        n * S::ONE.copysign(n.dot(self.offset[0]))
    }
}
