//! The distance of two separate cores (Gilbert, Johnson & Keerthi 1988).
//!
//! The difference of the cores is a convex set of vectors w from the first to the second; its point v nearest to the
//! origin is their separation. Repeatedly, v is set to the nearest point of a simplex of vertices, and the vertex
//! furthest against v is added. For any unit n
//!
//! ```text
//! n·w(n)  ≤  distance  ≤  |v|,
//! ```
//!
//! so the loop knows its error bound. Curved bodies would take many iterations, each new vertex a little nearer to the
//! touching point. There Newton's method is used once the bounds are close, and the same bounds confirm its direction.

use super::{
    pair::{Gap, Pair},
    refine::{ActiveEdges, refine},
    simplex::Simplex,
};
use clench_math::Scalar;

/// The maximum number of iterations. Five to ten are usual.
pub(crate) const MAX_ITERATIONS: usize = 64;
/// The difference of the bounds, relative to the smaller body, below which Newton's method is tried.
const NEAR: f64 = 0.1;
/// The multiple of √ε, relative to the smaller body, below which the direction of v is noise.
const NOISE: f64 = 4.0;

/// The maximum difference of the bounds at the end of a search, relative to the smaller body.
pub(crate) const MAX_DIFFERENCE: f64 = 1e-6;

/// The result for two cores.
pub(super) enum Cores<S> {
    /// The cores are further apart than the limit, as this gap proves.
    Apart(Gap<S>),
    /// The largest gap.
    Near(Gap<S>),
    /// The cores overlap or touch.
    Overlap,
}

/// Computes the largest gap of the cores if it is at most `limit`. The simplex must be the vertex along `start`, and
/// becomes the vertices of the nearest points, or contains the origin, up to rounding, if the cores overlap.
///
/// Nearly coincident vertices form slivers, whose nearest point may be wrong. So the result is checked against the
/// bounds: if it contradicts them, another search starts from the best known direction, without Newton's method.
pub(super) fn gjk<S: Scalar>(
    pair: &Pair<S>,
    start: Gap<S>,
    limit: S,
    simplex: &mut Simplex<S>,
) -> Cores<S> {
    let mut best = start;
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
            best.refine_inexact(pair, simplex.vertices());
            Cores::Near(best)
        }
    }
}

/// The reason why a search has ended.
enum End<S> {
    /// A gap exceeds the limit.
    Beyond,
    /// The origin seems to be in the simplex.
    Inside,
    /// No point is nearer to the origin than this distance.
    Nearest(S),
}

/// Adds vertices until none is nearer; `newton` enables Newton's method.
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
        // Along v, not n, to avoid waiting for the square root.
        let vertex = pair.vertex(v);
        let n = v * (S::ONE / length);
        let gap = n.dot(vertex.w);
        let raw = Gap {
            normal: n,
            gap,
            is_exact: false,
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
            let previous = best.normal;
            best.improve(refine(pair, n, &active), pair.tolerance);
            if best.normal != previous {
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
