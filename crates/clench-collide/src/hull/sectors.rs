//! Candidates for the furthest vertex of a hull along a direction, few enough to compare all of them.
//!
//! Directions are classified by comparisons alone: the signs of their coordinates, their order by size, and the half or
//! quarter of the largest that each is in. The directions of a sector lie between a few corners. A vertex with a
//! neighbour that is further along all corners is never the furthest between them. The other vertices are the sector's
//! candidates. Edges connect them, so traversing neighbours finds them.

use super::lists::Lists;
use clench_math::Vec3;

/// The maximum number of candidates. Beyond it, only one is stored, to climb from.
const MAX_CANDIDATES: usize = 32;
/// The number of vertices above which sectors use quarters instead of halves.
const FINE_FROM: usize = 128;
/// The orders of the coordinates: largest, second, smallest.
const ORDERS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [2, 1, 0],
    [1, 0, 2],
];

#[derive(Clone, Default, PartialEq)]
pub(super) struct Sectors {
    fine: bool,
    /// The candidates by sector code; empty for codes without a sector.
    candidates: Lists,
}

impl Sectors {
    /// Creates the sectors. `farthest` finds the furthest vertex along a direction, from a vertex near it.
    pub(super) fn new(
        vertices: &[Vec3<f64>],
        neighbors: &Lists,
        farthest: impl Fn(Vec3<f64>, usize) -> usize,
    ) -> Self {
        let fine = vertices.len() > FINE_FROM;
        let mut lists = Vec::new();
        let mut last = 0;
        for corners in all_corners(if fine { 4 } else { 2 }) {
            let middle = corners.iter().fold(Vec3::ZERO, |sum, &corner| sum + corner);
            last = farthest(middle, last);
            let code = code(middle, fine);
            lists.resize(lists.len().max(code + 1), Vec::new());
            lists[code] = candidates(vertices, neighbors, &corners, last as u32);
        }
        let mut candidates = Lists::default();
        lists.into_iter().for_each(|list| candidates.push(list));
        Sectors { fine, candidates }
    }

    /// Returns candidates that include the furthest vertex along a direction, padded by duplicates to a multiple of
    /// four. A single one may be only near it. Empty if the direction is zero or NaN.
    #[inline]
    pub(super) fn candidates(&self, direction: Vec3<f64>) -> &[u32] {
        self.candidates.get(code(direction, self.fine))
    }
}

/// Returns the sector of a direction. It has no branches, since directions are unpredictable.
#[inline]
fn code(d: Vec3<f64>, fine: bool) -> usize {
    let [x, y, z] = d.to_array().map(f64::abs);
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let largest = larger(larger(x, y), z);
    let pack =
        |x: bool, y: bool, z: bool| usize::from(x) | usize::from(y) << 1 | usize::from(z) << 2;
    let beyond = |share: f64| {
        let least = share * largest;
        pack(x > least, y > least, z > least)
    };
    let signs = pack(d.x < 0.0, d.y < 0.0, d.z < 0.0);
    let order = pack(x > y, y > z, z > x);
    let half = beyond(0.5);
    let code = signs | order << 3 | half << 6;
    if fine {
        code | (beyond(0.75) | (beyond(0.25) & !half)) << 9
    } else {
        code
    }
}

/// Returns the corners of each sector, with `steps` sectors along half an edge of a cube.
fn all_corners(steps: usize) -> Vec<Vec<Vec3<f64>>> {
    let at = |k: usize| k as f64 / steps as f64;
    let steps_below = |i: usize| (0..=i).map(move |j| (i, j));
    // Cells of one eighth of a cube's face, from its middle: coordinates (1, i, j) with j ≤ i.
    let mut cells: Vec<Vec<[f64; 3]>> = Vec::new();
    for (i, j) in (0..steps).flat_map(steps_below) {
        let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        let corners = square.into_iter().filter(|(i, j)| j <= i);
        cells.push(corners.map(|(i, j)| [1.0, at(i), at(j)]).collect());
    }
    // The cell of three equal coordinates, which have no order.
    cells.push(vec![[1.0; 3]]);
    let mut all = Vec::new();
    for signs in 0..8 {
        for order in ORDERS {
            all.extend(cells.iter().map(|cell| {
                let turned = cell.iter().map(|corner| {
                    let mut direction = Vec3::ZERO;
                    for (k, &length) in order.into_iter().zip(corner) {
                        direction[k] = if signs >> k & 1 == 1 { -length } else { length };
                    }
                    direction
                });
                turned.collect()
            }));
        }
    }
    all
}

/// Returns the vertices that may be furthest along a direction between `corners`; `first` is one of them.
fn candidates(
    vertices: &[Vec3<f64>],
    neighbors: &Lists,
    corners: &[Vec3<f64>],
    first: u32,
) -> Vec<u32> {
    let surpassed = |v: u32| {
        neighbors.get(v as usize).iter().any(|&other| {
            let further = vertices[other as usize] - vertices[v as usize];
            corners.iter().all(|corner| further.dot(*corner) > 0.0)
        })
    };
    let mut found = vec![first];
    let mut next = 0;
    while next < found.len() {
        for &v in neighbors.get(found[next] as usize) {
            if !found.contains(&v) && !surpassed(v) {
                found.push(v);
            }
        }
        next += 1;
        if found.len() > MAX_CANDIDATES {
            return vec![first];
        }
    }
    found.resize(found.len().next_multiple_of(4), first);
    found
}
