//! The convex hull of points: its corners and triangles.

use super::error::HullError;
use super::quickhull::{side, triangles};
use clench_math::Vec3;

/// The maximum coordinate (m); products of larger ones overflow.
const MAX_COORDINATE: f64 = 1e60;
/// The minimum coordinate (m); smaller ones, whose products underflow, count as zero.
const MIN_COORDINATE: f64 = 1e-60;
/// The minimum coordinate relative to the largest. Files have smaller ones for zero; rotations of the hull would round
/// away an edge between points that only these distinguish, and a climb would end at the wrong one.
const NOISE: f64 = 1e-12;

/// The surface of a convex hull: triangles of point indices.
#[derive(Clone, Debug, PartialEq)]
pub struct HullSurface {
    triangles: Vec<[u32; 3]>,
    /// The number of input points.
    points: usize,
}

impl HullSurface {
    /// Returns the triangles as indices of points, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// Returns the number of input points.
    pub(super) fn point_count(&self) -> usize {
        self.points
    }
}

/// Computes the convex hull of points: exact in their coordinates, however thin it is, and without corners that lie
/// within an edge or a face. Coordinates below 1e-12 of the largest count as zero.
///
/// `max_vertices` limits the number of corners. The furthest points are added first, so the others lie only slightly
/// outside.
///
/// # Errors
/// Returns an error if a coordinate is not finite (or beyond 1e60 m), if the points lie in a plane or line (up to 1e-14
/// of their extent), or if there are fewer than four points or allowed vertices.
pub fn convex_hull(
    points: &[Vec3<f64>],
    max_vertices: Option<usize>,
) -> Result<HullSurface, HullError> {
    if points.len() < 4 {
        return Err(HullError::TooFew(points.len()));
    }
    if points.len() >= u32::MAX as usize {
        return Err(HullError::TooMany(points.len()));
    }
    if let Some(bound) = max_vertices.filter(|&bound| bound < 4) {
        return Err(HullError::Bound(bound));
    }
    let usable = |p: &Vec3<f64>| p.to_array().iter().all(|x| x.abs() <= MAX_COORDINATE);
    if let Some(bad) = points.iter().position(|p| !usable(p)) {
        return Err(HullError::NotFinite(bad));
    }
    let all = points.iter().flat_map(|p| p.to_array());
    let largest = all.fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let least = MIN_COORDINATE.max(NOISE * largest);
    let flush = |x: f64| if x.abs() < least { 0.0 } else { x };
    let points: Vec<Vec3<f64>> = (points.iter())
        .map(|p| Vec3::new(flush(p.x), flush(p.y), flush(p.z)))
        .collect();

    let mut among: Vec<u32> = (0..points.len() as u32).collect();
    loop {
        let triangles = triangles(&points, &among, max_vertices)?;
        let between = between(&points, &triangles);
        if between.is_empty() {
            return Ok(HullSurface {
                triangles,
                points: points.len(),
            });
        }
        if max_vertices.is_none() {
            // The hull of these corners is that of all points.
            among = corners(&triangles);
        }
        among.retain(|i| between.binary_search(i).is_err());
    }
}

/// Returns the corners of triangles, ascending.
fn corners(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut corners: Vec<u32> = triangles.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// Returns the corners that lie within an edge or a face, ascending: fewer than three bent edges meet there.
fn between(points: &[Vec3<f64>], triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut bent: Vec<u32> = Vec::with_capacity(3 * triangles.len());
    for edge in edges(triangles) {
        let opposite = triangles[edge.right]
            .into_iter()
            .find(|corner| !edge.ends.contains(corner));
        if opposite.is_none_or(|corner| side(points, triangles[edge.left], corner) != 0) {
            bent.extend(edge.ends);
        }
    }
    bent.sort_unstable();
    let mut corners = corners(triangles);
    let meeting = |c: u32| bent.partition_point(|&b| b <= c) - bent.partition_point(|&b| b < c);
    corners.retain(|&corner| meeting(corner) < 3);
    corners
}

/// An edge between two triangles.
pub(super) struct MeshEdge {
    pub ends: [u32; 2],
    /// The triangle that traverses it from its first end to its second.
    pub left: usize,
    pub right: usize,
}

/// Returns the edges of a closed surface.
pub(super) fn edges(triangles: &[[u32; 3]]) -> Vec<MeshEdge> {
    let mut halves: Vec<(u32, u32, bool, usize)> = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            halves.push((from.min(to), from.max(to), from > to, t));
        }
    }
    halves.sort_unstable();
    let pairs = halves.chunks_exact(2);
    pairs
        .map(|pair| MeshEdge {
            ends: [pair[0].0, pair[0].1],
            left: pair[0].3,
            right: pair[1].3,
        })
        .collect()
}
