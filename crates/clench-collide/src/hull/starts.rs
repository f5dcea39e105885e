//! Where on a hull to begin climbing: near the end, whatever the direction.
//!
//! Directions are told apart by where they meet a cube about the origin, each side of which is divided into squares; of
//! each square the vertex that is farthest along its middle is known.

use clench_math::Vec3;

/// Squares along an edge of the cube, at most.
const MOST: usize = 8;

#[derive(Clone, Default, PartialEq)]
pub(super) struct Starts {
    /// Squares along an edge of the cube.
    across: usize,
    /// Of each square of each side.
    vertices: Vec<u32>,
}

impl Starts {
    /// About as many squares as vertices; `farthest` finds the vertex that is farthest along a direction, from a vertex that may
    /// be near it.
    pub fn new(count: usize, farthest: impl Fn(Vec3<f64>, usize) -> usize) -> Self {
        let across = ((count as f64 / 6.0).sqrt() as usize).clamp(1, MOST);
        let middle = |i: usize| (2 * i + 1) as f64 / across as f64 - 1.0;
        let mut vertices = Vec::with_capacity(6 * across * across);
        let mut last = 0;
        for side in 0..6 {
            for (i, j) in (0..across * across).map(|k| (k / across, k % across)) {
                let axis = side / 2;
                let mut direction = Vec3::ZERO;
                direction[axis] = if side % 2 == 0 { 1.0 } else { -1.0 };
                direction[(axis + 1) % 3] = middle(i);
                direction[(axis + 2) % 3] = middle(j);
                last = farthest(direction, last);
                vertices.push(last as u32);
            }
        }
        Starts { across, vertices }
    }

    /// A vertex near the one that is farthest along a direction.
    #[inline]
    pub fn near(&self, d: Vec3<f64>) -> usize {
        let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
        let (axis, along, u, v) = if x >= y && x >= z {
            (0, d.x, d.y, d.z)
        } else if y >= z {
            (1, d.y, d.z, d.x)
        } else {
            (2, d.z, d.x, d.y)
        };
        let side = 2 * axis + usize::from(along < 0.0);
        let scale = 0.5 * self.across as f64;
        let inverse = scale / along.abs();
        // A direction that is zero or no number falls into the first square.
        let square = |u: f64| ((u * inverse + scale) as usize).min(self.across - 1);
        let place = (side * self.across + square(u)) * self.across + square(v);
        self.vertices[place] as usize
    }
}
