//! The point nearest to the origin in the convex hull of up to four vertices.

use super::pair::Vertex;
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// One to four vertices. If they were added one by one, the nearest point depends on all but perhaps the last.
#[derive(Clone, Debug)]
pub(super) struct Simplex<S> {
    vertices: ArrayVec<Vertex<S>, 4>,
    /// The weights of the vertices in the nearest point.
    weights: [S; 4],
}

impl<S: Scalar> Simplex<S> {
    pub(super) fn new(vertex: Vertex<S>) -> Self {
        let mut vertices = ArrayVec::new_const();
        vertices.push(vertex);
        Simplex {
            vertices,
            weights: [S::ONE, S::ZERO, S::ZERO, S::ZERO],
        }
    }
    /// Creates a simplex of at most four vertices without solving for the nearest point.
    pub(super) fn unsolved(vertices: &[Vertex<S>]) -> Self {
        let mut simplex = Simplex::new(vertices[0]);
        simplex.vertices.extend(vertices[1..].iter().copied());
        simplex
    }
    pub(super) fn vertices(&self) -> &[Vertex<S>] {
        &self.vertices
    }
    /// Returns the nearest point as points on the first and the second body, each in its own frame.
    pub(super) fn nearest(&self) -> (Vec3<S>, Vec3<S>) {
        let mut solved = Simplex::new(self.vertices[0]);
        for vertex in &self.vertices()[1..] {
            solved.add(*vertex);
        }
        let mut nearest = (Vec3::ZERO, Vec3::ZERO);
        for (vertex, &weight) in solved.vertices().iter().zip(&solved.weights) {
            nearest.0 += vertex.a * weight;
            nearest.1 += vertex.b * weight;
        }
        nearest
    }

    /// Adds a vertex and drops those that the nearest point does not need. Returns that point, or `None` if the origin
    /// is inside.
    pub(super) fn add(&mut self, vertex: Vertex<S>) -> Option<Vec3<S>> {
        self.vertices.push(vertex);
        let nearest = match self.vertices.len() {
            2 => on_segment((1, self.w(1)), (0, self.w(0))),
            3 => self.on_triangle(2, 0, 1),
            _ => self.on_tetrahedron()?,
        };
        self.retain_nearest(&nearest);
        Some(nearest.point)
    }

    fn retain_nearest(&mut self, nearest: &Nearest<S>) {
        let mut weights = [S::ZERO; 4];
        for (&index, &weight) in nearest.of.iter().zip(&nearest.weights) {
            weights[index] += weight;
        }
        let mut kept = 0;
        for (k, weight) in weights.into_iter().enumerate() {
            if weight > S::ZERO {
                if kept < k {
                    self.vertices[kept] = self.vertices[k];
                }
                self.weights[kept] = weight;
                kept += 1;
            }
        }
        // No vertex is left if no weight is a number.
        self.vertices.truncate(kept.max(1));
    }

    fn w(&self, index: usize) -> Vec3<S> {
        self.vertices[index].w
    }

    fn on_triangle(&self, i: usize, j: usize, k: usize) -> Nearest<S> {
        on_triangle([i, j, k].map(|k| (k, self.w(k))))
    }

    /// Returns the nearest point on the three faces at the new vertex, of those that the origin is beyond; `None` if it
    /// is beyond none.
    fn on_tetrahedron(&self) -> Option<Nearest<S>> {
        let new = self.w(3);
        let mut best: Option<Nearest<S>> = None;
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let normal = (self.w(i) - new).cross(self.w(j) - new);
            let origin = -new.dot(normal);
            let opposite = (self.w(k) - new).dot(normal);
            if origin * opposite > S::ZERO {
                continue;
            }
            let nearest = self.on_triangle(3, i, j);
            best = Some(best.map_or(nearest, |best| best.nearer(nearest)));
        }
        best
    }
}

fn on_segment<S: Scalar>((i, p): (usize, Vec3<S>), (j, q): (usize, Vec3<S>)) -> Nearest<S> {
    let along = q - p;
    let ahead = -p.dot(along);
    if ahead <= S::ZERO {
        return Nearest::vertex(i, p);
    }
    let square = along.norm_squared();
    if ahead >= square {
        return Nearest::vertex(j, q);
    }
    Nearest::edge((i, p), (j, q), ahead, square)
}

/// Returns the point of a triangle nearest to the origin, by the regions of space in which a corner, an edge or the
/// inside is nearest (Ericson, Real-Time Collision Detection, 5.1.5). The corners have indices.
pub(super) fn on_triangle<S: Scalar>(
    [(i, a), (j, b), (k, c)]: [(usize, Vec3<S>); 3],
) -> Nearest<S> {
    let (ab, ac) = (b - a, c - a);
    let zero = S::ZERO;
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= zero && d2 <= zero {
        return Nearest::vertex(i, a);
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= zero && d4 <= d3 {
        return Nearest::vertex(j, b);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= zero && d1 >= zero && d3 <= zero {
        return Nearest::edge((i, a), (j, b), d1, d1 - d3);
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= zero && d5 <= d6 {
        return Nearest::vertex(k, c);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= zero && d2 >= zero && d6 <= zero {
        return Nearest::edge((i, a), (k, c), d2, d2 - d6);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= zero && d4 >= d3 && d5 >= d6 {
        let (ahead, behind) = (d4 - d3, d5 - d6);
        return Nearest::edge((j, b), (k, c), ahead, ahead + behind);
    }
    let (sum, normal) = (va + vb + vc, ab.cross(ac));
    let square = normal.norm_squared();
    if !(sum > zero && square > zero) {
        // The triangle has no area.
        let (a, b, c) = ((i, a), (j, b), (k, c));
        let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| on_segment(p, q));
        return sides[1..]
            .iter()
            .fold(sides[0], |best, side| best.nearer(*side));
    }
    let (v, w) = (vb / sum, vc / sum);
    // Projection onto the normal keeps the point's direction, which the weighted sum would lose.
    Nearest {
        point: normal * (normal.dot(a) / square),
        of: [i, j, k],
        weights: [S::ONE - v - w, v, w],
    }
}

/// A point as the weighted sum of some vertices.
#[derive(Clone, Copy)]
pub(super) struct Nearest<S> {
    pub point: Vec3<S>,
    of: [usize; 3],
    weights: [S; 3],
}

impl<S: Scalar> Nearest<S> {
    /// Returns true if the point is on no side of a triangle.
    pub(super) fn is_inside(&self) -> bool {
        self.of[1] != self.of[2]
    }
    fn vertex(i: usize, p: Vec3<S>) -> Self {
        Nearest {
            point: p,
            of: [i, i, i],
            weights: [S::ONE, S::ZERO, S::ZERO],
        }
    }
    /// Returns the point at the fraction `ahead` / `whole` from one vertex to another.
    fn edge((i, p): (usize, Vec3<S>), (j, q): (usize, Vec3<S>), ahead: S, whole: S) -> Self {
        if whole <= S::ZERO {
            return Nearest::vertex(i, p);
        }
        let t = ahead / whole;
        Nearest {
            point: p + (q - p) * t,
            of: [i, j, j],
            weights: [S::ONE - t, t, S::ZERO],
        }
    }
    fn nearer(self, other: Self) -> Self {
        if other.point.norm_squared() < self.point.norm_squared() {
            other
        } else {
            self
        }
    }
}
