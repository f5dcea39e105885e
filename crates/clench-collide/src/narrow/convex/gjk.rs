//! Distance of two cores that are apart (Gilbert, Johnson & Keerthi 1988).
//!
//! The difference of the cores is a convex set of vectors w from the first to the second, and its point v nearest to the
//! origin is the way from one to the other. A simplex of its vertices is kept: v is the simplex' nearest point, the vertex
//! that is furthest against v is added, and so on. For any unit n
//!
//! ```text
//! n·w(n)  ≤  distance  ≤  |v|,
//! ```
//!
//! so the loop knows how far it may be off. Against curved bodies it would take many iterations, each new vertex a little nearer to
//! the touching point; there Newton's method takes over as soon as the bounds are near each other, and its direction is
//! confirmed by the same bounds.

use super::{
    pair::{Gap, Pair},
    refine::{ActiveEdges, refine},
    simplex::Simplex,
};
use clench_math::{Scalar, Vec3};

/// The search ends after this many iterations, whether its answer is certain or not. Five to ten are usual.
const MAX_ITERATIONS: usize = 64;
/// Newton's method is tried once the bounds differ by less than this share of the smaller body.
const NEAR: f64 = 0.1;
/// The multiple of √ε, as a share of the larger coordinates, below which the direction of v is noise.
const NOISE: f64 = 4.0;

/// The share of the smaller body by which the bounds may differ at the end of a search.
const MAX_DIFFERENCE: f64 = 1e-6;

/// What is known of two cores.
pub(super) enum Cores<S> {
    /// Further apart than the limit, as this gap shows.
    Apart(Gap<S>),
    /// The largest gap.
    Near(Gap<S>),
    /// They overlap or touch.
    Overlap,
}

/// The distance of the cores if it is at most `limit`. The simplex begins with the vertex along `start`, and ends as what the
/// nearest points are made of, or holds the origin, but for rounding, where the cores overlap.
///
/// Vertices that nearly coincide make slivers, whose nearest point may be false. So the end of a search is checked against the bounds:
/// where it contradicts them, another search begins with the best direction known, without Newton's vertices.
pub(super) fn gjk<S: Scalar>(
    pair: &Pair<S>,
    start: Vec3<S>,
    limit: S,
    simplex: &mut Simplex<S>,
) -> Cores<S> {
    let mut best = Gap {
        normal: start,
        gap: start.dot(simplex.vertices()[0].w),
        settled: false,
    };
    let mut end = search(pair, limit, pair.curved, simplex, &mut best);
    let contradicted = match end {
        End::Beyond => false,
        End::Inside => best.gap > pair.tolerance,
        End::Nearest(length) => length - best.gap > pair.smallest * S::new(MAX_DIFFERENCE),
    };
    if contradicted {
        *simplex = Simplex::new(pair.vertex(best.normal));
        end = search(pair, limit, false, simplex, &mut best);
    }
    match end {
        End::Beyond => Cores::Apart(best),
        End::Inside if best.gap <= pair.tolerance => Cores::Overlap,
        End::Inside | End::Nearest(_) => {
            best.settle(pair, simplex.vertices());
            Cores::Near(best)
        }
    }
}

/// Why a search has ended.
enum End<S> {
    /// A gap beyond the limit.
    Beyond,
    /// The origin seems to be in the simplex.
    Inside,
    /// Nothing is nearer to the origin than a point at this distance.
    Nearest(S),
}

/// Adds vertices until nothing is nearer; `newton` helps with curved bodies.
fn search<S: Scalar>(
    pair: &Pair<S>,
    limit: S,
    newton: bool,
    simplex: &mut Simplex<S>,
    best: &mut Gap<S>,
) -> End<S> {
    let mut v = simplex.vertices()[0].w;
    let touching = pair.smallest * S::EPSILON.sqrt() * S::new(NOISE);
    for _ in 0..MAX_ITERATIONS {
        if best.gap > limit {
            return End::Beyond;
        }
        let square = v.norm_squared();
        let length = square.sqrt();
        if length <= touching {
            return End::Inside;
        }
        if length - best.gap <= pair.tolerance {
            return End::Nearest(length);
        }
        // Along v, not n: so the processor need not wait for the square root.
        let vertex = pair.vertex(v);
        let n = v * (S::ONE / length);
        let gap = n.dot(vertex.w);
        let raw = Gap {
            normal: n,
            gap,
            settled: false,
        };
        best.improve(raw, pair.tolerance);
        if length - gap <= pair.tolerance {
            return End::Nearest(length);
        }
        let Some(nearest) = simplex.add(vertex) else {
            return End::Inside;
        };
        if nearest.norm_squared() >= square {
            // Rounding hides any further progress.
            return End::Nearest(length);
        }
        v = nearest;
        if newton && length - gap < pair.smallest * S::new(NEAR) {
            let active = ActiveEdges::of(pair, simplex.vertices());
            let known = best.normal;
            best.improve(refine(pair, n, &active), pair.tolerance);
            if best.normal != known {
                for vertex in active.vertices(pair, best.normal) {
                    match simplex.add(vertex) {
                        Some(nearest) => v = nearest,
                        None => return End::Inside,
                    }
                }
            }
        }
    }
    End::Nearest(v.norm())
}
