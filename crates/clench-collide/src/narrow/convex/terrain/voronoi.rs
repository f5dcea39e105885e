//! Convex vertices and edges of terrain that touch a body, and the test that a direction is in their Voronoi region,
//! that is, a normal of the field there.

use super::grid::{Node, Triangle, same_direction};
use crate::narrow::convex::pair::Gap;
use clench_math::{Scalar, Vec3};

/// A corner, an edge or the face of a triangle, and the gap along a normal there.
pub(super) struct VoronoiFeature<S> {
    pub gap: Gap<S>,
    nodes: [Node; 3],
    /// True for each node that belongs to the feature.
    touches: [bool; 3],
}

/// The offsets from a grid point to those that share an edge with it.
const NEIGHBORS: [Node; 6] = [[0, 1], [1, 1], [1, 0], [0, -1], [-1, -1], [-1, 0]];

impl<S: Scalar> Triangle<'_, S> {
    /// Returns the feature that is furthest along the normal of a gap.
    pub(super) fn feature(&self, gap: Gap<S>) -> VoronoiFeature<S> {
        let n = gap.normal;
        let flat = n.z < -same_direction::<S>();
        let corners = self.corners.map(|corner| level(corner, flat));
        let reach = corners.map(|v| v.dot(n));
        let largest = reach[0].max(reach[1]).max(reach[2]);
        let size = (corners[1] - corners[0]).norm() + (corners[2] - corners[0]).norm();
        VoronoiFeature {
            gap,
            nodes: self.nodes,
            touches: reach.map(|r| r >= largest - size * same_direction()),
        }
    }

    /// Returns true if a feature's direction is a normal of the whole field there. It is not if the field continues
    /// beyond the prism's wall or rises beyond its edge.
    pub(super) fn admits_normal(&self, feature: &VoronoiFeature<S>) -> bool {
        let (n, touches) = (feature.gap.normal, feature.touches);
        let flat = n.z < -same_direction::<S>();
        let corners = self.corners.map(|corner| level(corner, flat));
        let below = |from: Vec3<S>, to: Option<Vec3<S>>| {
            to.is_none_or(|to| {
                let edge = level(to, flat) - from;
                edge.dot(n) <= edge.norm() * same_direction()
            })
        };
        match touches.iter().filter(|t| **t).count() {
            3 => true,
            2 => (0..3).all(|k| touches[k] || below(corners[(k + 1) % 3], self.across(k))),
            _ => (0..3).all(|k| {
                let [row, column] = self.nodes[k];
                let beside = |[r, c]: Node| below(corners[k], self.node([row + r, column + c]));
                !touches[k] || NEIGHBORS.into_iter().all(beside)
            }),
        }
    }

    /// Returns true if the triangle has all corners of a feature.
    pub(super) fn has(&self, feature: &VoronoiFeature<S>) -> bool {
        let mut corners = feature.nodes.iter().zip(feature.touches);
        corners.all(|(node, touches)| !touches || self.nodes.contains(node))
    }
}

/// Returns the point, or its projection onto the horizontal plane if the normal points downwards: the prism continues
/// downwards, so heights are irrelevant.
fn level<S: Scalar>(v: Vec3<S>, flat: bool) -> Vec3<S> {
    if flat {
        Vec3::new(v.x, v.y, S::ZERO)
    } else {
        v
    }
}
