//! Features of a core that lie against a plane: a face, an edge or a corner.

use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// The maximum number of corners of a feature. A hull face with more is represented by every second, third, ... of them
/// and the furthest one.
pub(crate) const MAX_CORNERS: usize = 24;

/// The sine of the tilt (5°) up to which an edge counts as lying against the plane, as a face does.
pub(crate) const EDGE_SINE: f64 = 0.087;

/// A face (counter-clockwise seen from outside), an edge (two corners) or a corner of a core.
pub(crate) struct Feature<S> {
    pub corners: ArrayVec<Vec3<S>, MAX_CORNERS>,
    /// The outward normal of a face.
    pub normal: Vec3<S>,
    /// The radius of a round cap about the z axis, which the corners only sample.
    pub radius: Option<S>,
}

impl<S: Scalar> Feature<S> {
    /// Creates a feature without corners; its normal is `d`, the direction along which it is furthest.
    #[inline]
    pub(crate) fn along(d: Vec3<S>) -> Self {
        Feature {
            corners: ArrayVec::new(),
            normal: d,
            radius: None,
        }
    }

    /// Creates a corner.
    #[inline]
    pub(crate) fn corner(d: Vec3<S>, corner: Vec3<S>) -> Self {
        let mut feature = Feature::along(d);
        feature.corners.push(corner);
        feature
    }

    /// Creates the edge along `axis` through a corner.
    #[inline]
    pub(crate) fn edge(d: Vec3<S>, mut corner: Vec3<S>, axis: usize) -> Self {
        let mut feature = Feature::along(d);
        for sign in [-S::ONE, S::ONE] {
            corner[axis] = corner[axis].copysign(sign);
            feature.corners.push(corner);
        }
        feature
    }
}

/// Returns the edge from a corner to one of some numbered ends that is most nearly perpendicular to the unit direction
/// `d`; `None` if no edge is level enough.
pub(crate) fn most_level<S: Scalar>(
    corner: Vec3<S>,
    ends: impl Iterator<Item = (usize, Vec3<S>)>,
    d: Vec3<S>,
) -> Option<(usize, Vec3<S>)> {
    // The squared rise and the squared length of the best edge; the root of their quotient is its sine.
    let mut best = (S::new(EDGE_SINE).squared(), S::ONE, None);
    for (number, end) in ends {
        let edge = end - corner;
        let (rise, length) = (edge.dot(d).squared(), edge.norm_squared());
        if rise * best.1 <= best.0 * length {
            best = (rise, length, Some((number, end)));
        }
    }
    best.2
}
