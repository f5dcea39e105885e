//! Merging of coplanar triangles to polygons.
//!
//! Files store 24 bits of a coordinate, so the triangles of a flat face differ slightly. Starting from the largest,
//! each triangle absorbs its neighbours whose corners are all near its plane. The plane of a face is then moved to the
//! furthest vertex along its normal, so that no vertex lies beyond it.

use super::lists::Lists;
use super::sectors::Sectors;
use super::surface::{MeshEdge, edges};
use super::{Crease, FEW_FACES, Hull, HullSurface};
use clench_math::Vec3;

/// The maximum distance of a corner from the plane of its face, relative to the size of the hull: some units in the
/// last place of 24-bit coordinates.
const COPLANAR: f64 = 1e-6;
const NONE: u32 = u32::MAX;

impl Hull {
    /// Creates the hull of a surface whose points have moved by an affine map, such as scaling, rotation or mirroring.
    /// `points` are the current positions of the points of the surface.
    ///
    /// # Panics
    /// Panics if `points` are fewer than those of the surface.
    pub fn new(surface: &HullSurface, points: &[Vec3<f64>]) -> Self {
        assert!(points.len() >= surface.point_count());
        let (vertices, triangles) = compact(surface, points);
        let sum = vertices.iter().fold(Vec3::ZERO, |sum, &v| sum + v);
        let center = sum * (1.0 / vertices.len() as f64);
        let edges = edges(&triangles);
        let (faces, face_of) = merge(&vertices, &triangles, &edges, center);

        let mut hull = Hull {
            neighbors: neighbors(vertices.len(), &edges),
            vertex_faces: faces_at(vertices.len(), &triangles, &face_of),
            corners: Lists::default(),
            normals: Vec::new(),
            offsets: Vec::new(),
            creases: Vec::new(),
            center,
            vertices,
            sectors: Sectors::default(),
        };
        hull.sectors = Sectors::new(&hull.vertices, &hull.neighbors, |direction, near| {
            hull.climb(direction, near)
        });
        for corners in faces {
            let normal = newell(&hull.vertices, &corners).normalize().0;
            let farthest = hull.support(normal);
            hull.offsets.push(hull.vertices[farthest].dot(normal));
            hull.normals.push(normal);
            hull.corners.push(corners);
        }
        if hull.normals.len() <= FEW_FACES {
            let creases = edges.iter().filter_map(|edge| hull.crease(edge, &face_of));
            hull.creases = creases.collect();
        }
        hull
    }

    /// Returns the crease at an edge between triangles, if any.
    fn crease(&self, edge: &MeshEdge, face_of: &[u32]) -> Option<Crease> {
        let faces = [edge.left, edge.right].map(|triangle| face_of[triangle] as usize);
        if faces[0] == faces[1] {
            return None;
        }
        let [start, end] = edge.ends.map(|vertex| self.vertices[vertex as usize]);
        let (along, _) = (end - start).normalize();
        let [m, n] = faces.map(|face| self.normals[face]);
        Some(Crease {
            start,
            along,
            moment: start.cross(along),
            faces,
            rotation: (m.dot(n), m.cross(n).norm()),
        })
    }
}

/// Returns the points on the surface, in their order, and its triangles as indices of these. If the points are
/// mirrored, it flips the triangles.
fn compact(surface: &HullSurface, points: &[Vec3<f64>]) -> (Vec<Vec3<f64>>, Vec<[u32; 3]>) {
    let mut number = vec![NONE; points.len()];
    for &corner in surface.triangles().as_flattened() {
        number[corner as usize] = 0;
    }
    let mut vertices = Vec::new();
    for (point, number) in points.iter().zip(&mut number) {
        if *number == 0 {
            *number = vertices.len() as u32;
            vertices.push(*point);
        }
    }
    let mut triangles: Vec<[u32; 3]> = (surface.triangles().iter())
        .map(|corners| corners.map(|c| number[c as usize]))
        .collect();
    let at = |c: u32| vertices[c as usize] - vertices[0];
    let volume: f64 = (triangles.iter())
        .map(|&[a, b, c]| at(a).dot(at(b).cross(at(c))))
        .sum();
    if volume < 0.0 {
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    (vertices, triangles)
}

/// Returns twice the area of a polygon, along its normal.
fn newell(vertices: &[Vec3<f64>], corners: &[u32]) -> Vec3<f64> {
    let first = vertices[corners[0] as usize];
    let arms = corners[1..].windows(2).map(|pair| {
        let [a, b] = [pair[0], pair[1]].map(|c| vertices[c as usize] - first);
        a.cross(b)
    });
    arms.fold(Vec3::ZERO, |sum, arm| sum + arm)
}

/// Returns the corners of each face, those of the largest triangles first, and the face of each triangle.
fn merge(
    vertices: &[Vec3<f64>],
    triangles: &[[u32; 3]],
    edges: &[MeshEdge],
    center: Vec3<f64>,
) -> (Vec<Vec<u32>>, Vec<u32>) {
    let size = (vertices.iter()).fold(0.0, |size, &v| f64::max(size, (v - center).norm()));
    let mut adjacent = vec![Vec::with_capacity(3); triangles.len()];
    for edge in edges {
        adjacent[edge.left].push(edge.right);
        adjacent[edge.right].push(edge.left);
    }
    let areas: Vec<Vec3<f64>> = triangles.iter().map(|t| newell(vertices, t)).collect();
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|t| areas[t].norm_squared());
        b.total_cmp(&a)
    });
    let mut face_of = vec![NONE; triangles.len()];
    let mut faces = Vec::new();
    for seed in order {
        if face_of[seed] != NONE {
            continue;
        }
        let normal = areas[seed].normalize().0;
        let foot = vertices[triangles[seed][0] as usize];
        let in_plane = |t: usize| {
            let near = |&c: &u32| normal.dot(vertices[c as usize] - foot).abs() <= COPLANAR * size;
            triangles[t].iter().all(near) && areas[t].dot(normal) >= 0.0
        };
        let number = faces.len() as u32;
        face_of[seed] = number;
        let mut members = vec![seed];
        let mut next = 0;
        while next < members.len() {
            for &t in &adjacent[members[next]] {
                if face_of[t] == NONE && in_plane(t) {
                    face_of[t] = number;
                    members.push(t);
                }
            }
            next += 1;
        }
        match outline(triangles, &members) {
            Some(corners) => faces.push(corners),
            // Rounding can make the triangles no disk. The seed then remains a face by itself.
            None => {
                members[1..].iter().for_each(|&t| face_of[t] = NONE);
                faces.push(triangles[seed].to_vec());
            }
        }
    }
    (faces, face_of)
}

/// Returns the boundary corners of triangles that form a disk.
fn outline(triangles: &[[u32; 3]], members: &[usize]) -> Option<Vec<u32>> {
    let mut halves: Vec<(u32, u32)> = Vec::with_capacity(3 * members.len());
    for &t in members {
        let [a, b, c] = triangles[t];
        halves.extend([(a, b), (b, c), (c, a)]);
    }
    halves.sort_unstable();
    let inner = |&(a, b): &(u32, u32)| halves.binary_search(&(b, a)).is_ok();
    let boundary: Vec<(u32, u32)> = halves.iter().copied().filter(|half| !inner(half)).collect();
    let (first, mut at) = *boundary.first()?;
    let mut corners = vec![first];
    while at != first && corners.len() < boundary.len() {
        corners.push(at);
        let next = boundary.binary_search_by_key(&at, |&(from, _)| from).ok()?;
        at = boundary[next].1;
    }
    (at == first && corners.len() == boundary.len()).then_some(corners)
}

fn neighbors(count: usize, edges: &[MeshEdge]) -> Lists {
    let mut pairs: Vec<[u32; 2]> = (edges.iter())
        .flat_map(|&MeshEdge { ends: [a, b], .. }| [[a, b], [b, a]])
        .collect();
    pairs.sort_unstable();
    lists(count, &pairs)
}

fn faces_at(count: usize, triangles: &[[u32; 3]], face_of: &[u32]) -> Lists {
    let mut pairs: Vec<[u32; 2]> = (triangles.iter().zip(face_of))
        .flat_map(|(corners, &face)| corners.map(|c| [c, face]))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    lists(count, &pairs)
}

/// Groups sorted pairs by their first numbers, below `count`.
fn lists(count: usize, pairs: &[[u32; 2]]) -> Lists {
    let mut lists = Lists::default();
    let mut rest = pairs;
    for i in 0..count as u32 {
        let (mine, others) = rest.split_at(rest.partition_point(|pair| pair[0] <= i));
        lists.push(mine.iter().map(|pair| pair[1]));
        rest = others;
    }
    lists
}
