//! Which vertices of a hull may be the farthest along a direction: few enough to compare all of them.
//!
//! Directions are told apart by comparisons alone: the signs of their coordinates, which is larger than which, and in which half
//! or quarter of the largest each is. Those of one sector lie between a few corners. Where a vertex has a neighbor that is
//! farther along all corners, it is so along all directions between them. Vertices without such a neighbor are the sector's
//! candidates; they are connected by edges, so walking over neighbours finds them.

use super::lists::Lists;
use clench_math::Vec3;

/// Of more candidates than this one is kept, to climb from.
const MAX_CANDIDATES: usize = 32;
/// Hulls of more vertices have sectors of quarters, others of halves.
const FINE_FROM: usize = 128;
/// Which coordinates are the largest, the second and the least.
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
    /// By the sector's code; none where there is no such sector.
    candidates: Lists,
}

impl Sectors {
    /// `farthest` finds the vertex that is farthest along a direction, from a vertex that may be near it.
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

    /// Vertices among which the one is that is farthest along a direction, in fours (some twice); if there is but one, it may be
    /// only near; none for a direction that is zero or NaN.
    #[inline]
    pub(super) fn candidates(&self, direction: Vec3<f64>) -> &[u32] {
        self.candidates.get(code(direction, self.fine))
    }
}

/// The sector of a direction. No branches: which way it points cannot be predicted.
#[inline]
fn code(d: Vec3<f64>, fine: bool) -> usize {
    let [x, y, z] = d.to_array().map(f64::abs);
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let most = larger(larger(x, y), z);
    let pack =
        |x: bool, y: bool, z: bool| usize::from(x) | usize::from(y) << 1 | usize::from(z) << 2;
    let beyond = |share: f64| {
        let least = share * most;
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

/// The corners of each sector, of which there are `steps` along half an edge of a cube.
fn all_corners(steps: usize) -> Vec<Vec<Vec3<f64>>> {
    let at = |k: usize| k as f64 / steps as f64;
    let steps_below = |i: usize| (0..=i).map(move |j| (i, j));
    // Where a face of a cube about the origin is met, from its middle: to the right, and not as far up.
    let mut cells: Vec<Vec<[f64; 3]>> = Vec::new();
    for (i, j) in (0..steps).flat_map(steps_below) {
        let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        let corners = square.into_iter().filter(|(i, j)| j <= i);
        cells.push(corners.map(|(i, j)| [1.0, at(i), at(j)]).collect());
    }
    // No comparison tells apart three that are equal.
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

/// The vertices that may be farthest between some directions, of which `first` is one.
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
