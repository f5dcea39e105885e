//! Quickhull (Barber, Dobkin and Huhdanpaa 1996) with exact predicates.
//!
//! Start from a tetrahedron and assign each other point to a triangle that it is strictly outside of. While a triangle
//! has such points, take the furthest, remove the triangles visible from it and close the hole with a cone from it to
//! the horizon. The sign of a determinant decides if a point is outside; where a rounded distance leaves it open,
//! `robust` computes it exactly. So the triangles visible from a point form a disk, and the surface stays closed and
//! convex, however thin or fine it is. Rounded distances also choose the order.

use super::error::HullError;
use clench_math::Vec3;
use robust::{Coord3D, orient3d};

/// The ratio of thickness to extent below which points are flat: the rounding error of a plane rotated in `f64`.
const FLAT: f64 = 1e-14;
/// The error of a distance from a triangle's plane, in units of ε times the extent of the points and the products in
/// the triangle's normal. Counting the roundings gives at most 6.
const ROUNDING: f64 = 16.0;
const NONE: u32 = u32::MAX;

/// A triangle of the growing surface.
struct Facet {
    /// The corners, counter-clockwise from outside.
    corners: [u32; 3],
    /// The facet across the edge from each corner to the next.
    across: [u32; 3],
    normal: Vec3<f64>,
    /// The bound of the error of distances from its plane.
    slack: f64,
    /// The points that are strictly outside and belong to no other facet.
    outside: Vec<u32>,
    /// The distance and index of the furthest of them.
    farthest: (f64, u32),
    alive: bool,
    /// The last round that checked its visibility.
    visited: u32,
}

/// An edge between a facet visible from a point and one that is not.
#[derive(Clone, Copy)]
struct HorizonRidge {
    from: u32,
    to: u32,
    /// The facet behind it, and the index of the edge in that facet.
    behind: (u32, usize),
}

pub(super) struct Quickhull<'a> {
    points: &'a [Vec3<f64>],
    /// The maximum difference of a coordinate between two points.
    extent: f64,
    facets: Vec<Facet>,
    /// The facets that may have points outside.
    pending: Vec<u32>,
    round: u32,
    /// The new facet of a round that starts at each point.
    starting_at: Vec<u32>,
}

/// Returns the triangles of the hull of the points `among`. `max_vertices` limits the number of corners.
///
/// # Errors
/// Returns an error if the points have no volume.
pub(super) fn triangles(
    points: &[Vec3<f64>],
    among: &[u32],
    max_vertices: Option<usize>,
) -> Result<Vec<[u32; 3]>, HullError> {
    let mut hull = Quickhull {
        points,
        extent: extent(points, among),
        facets: Vec::new(),
        pending: Vec::new(),
        round: 0,
        starting_at: vec![NONE; points.len()],
    };
    hull.start(simplex(points, among)?, among);
    let mut corners = 4;
    while max_vertices.is_none_or(|max_vertices| corners < max_vertices)
        && let Some(facet) = hull.next(max_vertices.is_some())
    {
        hull.add(facet)?;
        corners += 1;
    }
    let alive = hull.facets.iter().filter(|facet| facet.alive);
    let mut triangles: Vec<[u32; 3]> = alive.map(|facet| smallest_first(facet.corners)).collect();
    triangles.sort_unstable();
    Ok(triangles)
}

/// Returns the maximum difference of a coordinate between two points.
fn extent(points: &[Vec3<f64>], among: &[u32]) -> f64 {
    let along = |axis: usize| {
        let coordinates = among.iter().map(|&i| points[i as usize][axis]);
        let (low, high) = coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high - low
    };
    along(0).max(along(1)).max(along(2))
}

fn smallest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    }
}

/// Returns the side of `d`: 1 strictly outside, 0 in the plane, -1 inside of the triangle a, b, c.
pub(super) fn side(points: &[Vec3<f64>], [a, b, c]: [u32; 3], d: u32) -> i32 {
    let coord = |i: u32| {
        let Vec3 { x, y, z } = points[i as usize];
        Coord3D { x, y, z }
    };
    let determinant = orient3d(coord(a), coord(b), coord(c), coord(d));
    i32::from(determinant < 0.0) - i32::from(determinant > 0.0)
}

/// Returns four points that span a nearly maximal volume. The first three are counter-clockwise and the last is inside
/// of their triangle.
fn simplex(points: &[Vec3<f64>], among: &[u32]) -> Result<[u32; 4], HullError> {
    let at = |i: u32| points[i as usize];
    let largest = |measure: &dyn Fn(Vec3<f64>) -> f64| {
        among.iter().fold((f64::NEG_INFINITY, 0), |best, &i| {
            let value = measure(at(i));
            if value > best.0 { (value, i) } else { best }
        })
    };
    let extent = |axis: usize| {
        let (high, b) = largest(&|p| p[axis]);
        let (low, a) = largest(&|p| -p[axis]);
        (high + low, a, b)
    };
    let (size, a, b) = (1..3).fold(extent(0), |best, axis| {
        let found = extent(axis);
        if found.0 > best.0 { found } else { best }
    });
    if size <= 0.0 {
        return Err(HullError::Point);
    }
    let (along, length) = (at(b) - at(a)).normalize();
    let (width, c) = largest(&|p| along.cross(p - at(a)).norm());
    if width <= FLAT * length {
        return Err(HullError::Line);
    }
    let (normal, _) = (at(b) - at(a)).cross(at(c) - at(a)).normalize();
    let (height, d) = largest(&|p| normal.dot(p - at(a)).abs());
    if height <= FLAT * length {
        return Err(HullError::Plane);
    }
    match side(points, [a, b, c], d) {
        0 => Err(HullError::Plane),
        1 => Ok([a, c, b, d]),
        _ => Ok([a, b, c, d]),
    }
}

impl Facet {
    /// Returns the distance of a point from the plane, rounded; positive outside.
    #[inline(always)]
    fn distance(&self, points: &[Vec3<f64>], point: u32) -> f64 {
        let offset = points[point as usize] - points[self.corners[0] as usize];
        self.normal.dot(offset)
    }

    /// Returns true if a point is strictly outside.
    #[inline(always)]
    fn is_visible(&self, points: &[Vec3<f64>], point: u32) -> bool {
        let distance = self.distance(points, point);
        if distance.abs() > self.slack {
            return distance > 0.0;
        }
        side(points, self.corners, point) > 0
    }
}

impl Quickhull<'_> {
    fn at(&self, point: u32) -> Vec3<f64> {
        self.points[point as usize]
    }

    fn facet(&self, corners: [u32; 3], across: [u32; 3]) -> Facet {
        let [a, b, c] = corners.map(|i| self.at(i));
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        let length = normal.norm();
        let product = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        let products = product(1, 2) + product(2, 0) + product(0, 1);
        Facet {
            corners,
            across,
            normal: normal * (1.0 / length),
            // Without an area the distance is no number, and no comparison with it is true.
            slack: ROUNDING * f64::EPSILON * self.extent * (products / length),
            outside: Vec::new(),
            farthest: (f64::NEG_INFINITY, NONE),
            alive: true,
            visited: 0,
        }
    }

    fn start(&mut self, [a, b, c, d]: [u32; 4], among: &[u32]) {
        let facets = [
            ([a, b, c], [1, 2, 3]),
            ([b, a, d], [0, 3, 2]),
            ([c, b, d], [0, 1, 3]),
            ([a, c, d], [0, 2, 1]),
        ];
        for (corners, across) in facets {
            let facet = self.facet(corners, across);
            self.facets.push(facet);
        }
        self.assign(among, 0);
    }

    /// Assigns each point to the first facet from `first` on that it is outside of; drops inside points.
    fn assign(&mut self, candidates: &[u32], first: usize) {
        for &point in candidates {
            let visible_from = |facet: &&mut Facet| facet.is_visible(self.points, point);
            if let Some(facet) = self.facets[first..].iter_mut().find(visible_from) {
                let distance = facet.distance(self.points, point);
                facet.outside.push(point);
                if distance > facet.farthest.0 || facet.farthest.1 == NONE {
                    facet.farthest = (distance, point);
                }
            }
        }
        self.pending.extend(first as u32..self.facets.len() as u32);
    }

    /// Returns a facet that has points outside: any, or the one with the furthest.
    fn next(&mut self, farthest: bool) -> Option<u32> {
        let facets = &self.facets;
        let open = |&f: &u32| facets[f as usize].alive && !facets[f as usize].outside.is_empty();
        if farthest {
            self.pending.retain(open);
            let distance = |f: u32| facets[f as usize].farthest.0;
            let farther = |a: &u32, b: &u32| distance(*a).total_cmp(&distance(*b));
            return self.pending.iter().copied().max_by(farther);
        }
        while let Some(facet) = self.pending.pop() {
            if open(&facet) {
                return Some(facet);
            }
        }
        None
    }

    /// Adds the furthest point of a facet to the hull.
    fn add(&mut self, facet: u32) -> Result<(), HullError> {
        let point = self.facets[facet as usize].farthest.1;
        let mut orphans = Vec::new();
        let horizon = self.remove_visible(facet, point, &mut orphans);
        let first = self.facets.len();
        for (i, edge) in horizon.iter().enumerate() {
            self.starting_at[edge.from as usize] = (first + i) as u32;
        }
        for edge in &horizon {
            let next = self.starting_at[edge.to as usize];
            let new = self.facet([edge.from, edge.to, point], [edge.behind.0, next, NONE]);
            self.facets.push(new);
        }
        for (i, edge) in horizon.iter().enumerate() {
            let new = (first + i) as u32;
            let next = self.starting_at[edge.to as usize];
            let (behind, side) = edge.behind;
            let closed = next != NONE && self.facets[next as usize].across[2] == NONE;
            if !closed {
                return Err(HullError::Broken);
            }
            self.facets[next as usize].across[2] = new;
            self.facets[behind as usize].across[side] = new;
        }
        for edge in &horizon {
            self.starting_at[edge.from as usize] = NONE;
        }
        orphans.retain(|&orphan| orphan != point);
        self.assign(&orphans, first);
        Ok(())
    }

    /// Removes the facets visible from a point, starting with one that is, and returns the horizon of the hole.
    fn remove_visible(
        &mut self,
        from: u32,
        point: u32,
        orphans: &mut Vec<u32>,
    ) -> Vec<HorizonRidge> {
        self.round += 1;
        let mut horizon = Vec::new();
        let mut stack = vec![from];
        self.facets[from as usize].visited = self.round;
        self.facets[from as usize].alive = false;
        while let Some(f) = stack.pop() {
            let (corners, across) = {
                let facet = &mut self.facets[f as usize];
                orphans.append(&mut facet.outside);
                (facet.corners, facet.across)
            };
            for (edge, &other) in across.iter().enumerate() {
                let neighbor = &mut self.facets[other as usize];
                if neighbor.alive && neighbor.visited != self.round {
                    neighbor.visited = self.round;
                    neighbor.alive = !neighbor.is_visible(self.points, point);
                    if !neighbor.alive {
                        stack.push(other);
                    }
                }
                if neighbor.alive {
                    let [from, to] = [corners[edge], corners[(edge + 1) % 3]];
                    let side = neighbor.corners.iter().position(|&c| c == to);
                    horizon.push(HorizonRidge {
                        from,
                        to,
                        behind: (other, side.unwrap_or(0)),
                    });
                }
            }
        }
        horizon
    }
}
