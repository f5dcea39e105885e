//! Which vertices of a hull may be the farthest along a direction: few enough to look at all of them.
//!
//! Directions are told apart by where they meet a cube about the origin, each side of which is divided into squares. Where a
//! vertex has a neighbor that is farther along the directions to all four corners of a square, it is so along all between
//! them. Vertices without such a neighbor are the square's candidates; they hang together, so walking finds them.

use super::Lists;
use clench_math::Vec3;

/// Squares along an edge of the cube, at most.
const MOST_ACROSS: usize = 12;
/// Of more candidates than this one is kept, to climb from.
const MOST_CANDIDATES: usize = 32;
/// Squares reach over their sides by this part, as rounding may take a direction for one beside.
const OVER: f64 = 1e-9;

#[derive(Clone, Default, PartialEq)]
pub(super) struct Squares {
    /// Squares along an edge of the cube.
    across: u32,
    /// Of each square of each side.
    candidates: Lists,
}

impl Squares {
    /// About as many squares as vertices; `farthest` finds the vertex that is farthest along a direction, from a vertex that may
    /// be near it.
    pub fn new(
        vertices: &[Vec3<f64>],
        neighbors: &Lists,
        farthest: impl Fn(Vec3<f64>, usize) -> usize,
    ) -> Self {
        let across = ((vertices.len() as f64 / 6.0).sqrt() as usize).clamp(1, MOST_ACROSS);
        let mut candidates = Lists::default();
        let mut last = 0;
        for square in 0..6 * across * across {
            let corners = corners(square, across);
            let middle = corners.iter().fold(Vec3::ZERO, |sum, &c| sum + c);
            last = farthest(middle, last);
            let surpassed = |v: usize| {
                neighbors.get(v).iter().any(|&other| {
                    let further = vertices[other as usize] - vertices[v];
                    corners.iter().all(|corner| further.dot(*corner) > 0.0)
                })
            };
            let mut found = vec![last as u32];
            let mut next = 0;
            while next < found.len() && found.len() <= MOST_CANDIDATES {
                for &v in neighbors.get(found[next] as usize) {
                    if !found.contains(&v) && !surpassed(v as usize) {
                        found.push(v);
                    }
                }
                next += 1;
            }
            if found.len() > MOST_CANDIDATES {
                found.truncate(1);
            } else {
                let whole = found.len().next_multiple_of(4);
                found.resize(whole, found[0]);
            }
            candidates.push(found);
        }
        Squares {
            across: across as u32,
            candidates,
        }
    }

    /// Vertices among which the one is that is farthest along a direction, in fours (some twice); if there is but one, it may be
    /// only near.
    ///
    /// No branches: which way a direction points cannot be predicted.
    #[inline]
    pub fn candidates(&self, d: Vec3<f64>) -> &[u32] {
        let [x, y, z] = d.to_array().map(f64::abs);
        let longer = |a: f64, b: f64| if b > a { b } else { a };
        let of_two = longer(x, y);
        let axis = if z > of_two { 2 } else { usize::from(y > x) };
        let scale = 0.5 * f64::from(self.across);
        let inverse = scale / longer(of_two, z);
        // A direction that is zero or no number falls into the first square.
        let square = |u: f64| ((u * inverse + scale) as u32).min(self.across - 1);
        let around = [d.x, d.y, d.z, d.x, d.y];
        let side = 2 * axis as u32 + u32::from(around[axis] < 0.0);
        let (i, j) = (square(around[axis + 1]), square(around[axis + 2]));
        let place = (side * self.across + i) * self.across + j;
        self.candidates.get(place as usize)
    }
}

/// The directions to the corners of a square.
fn corners(square: usize, across: usize) -> [Vec3<f64>; 4] {
    let (side, i, j) = (
        square / across / across,
        square / across % across,
        square % across,
    );
    let axis = side / 2;
    [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| {
        let at = |k: usize, end: usize| {
            let over = OVER * (2 * end) as f64 - OVER;
            2.0 * ((k + end) as f64 + over) / across as f64 - 1.0
        };
        let mut direction = Vec3::ZERO;
        direction[axis] = if side % 2 == 0 { 1.0 } else { -1.0 };
        direction[(axis + 1) % 3] = at(i, u);
        direction[(axis + 2) % 3] = at(j, v);
        direction
    })
}
