//! Any two convex shapes, by their support functions: how far apart or how deep they are, along which normal, and the points
//! where they touch.

mod body;
mod epa;
mod feature;
mod gjk;
mod pair;
mod patch;
mod polytope;
mod refine;
mod simplex;
mod view;

use super::{
    Placed,
    one_by_one::{Points, one_by_one},
};
use crate::Contacts;
use clench_math::{Real, Scalar};
use epa::epa;
pub(super) use feature::MOST_CORNERS;
use gjk::{Cores, gjk};
use pair::Pair;
use patch::patch;

/// The contacts of two shapes that are bounded and convex.
pub(super) fn convex<T: Real>(a: Placed<T>, b: Placed<T>, margin: T, out: &mut Contacts<T>) {
    one_by_one(a, b, margin, out, points);
}

fn points<S: Scalar>(a: Placed<S>, b: Placed<S>, margin: S, points: &mut Points<S>) {
    let pair = Pair::new(a, b);
    let radii = pair.a.radius + pair.b.radius;
    let (best, simplex) = match gjk(&pair, margin + radii) {
        Cores::Apart => return,
        Cores::Near(best, simplex) => (best, simplex),
        Cores::Overlap(simplex) => epa(&pair, &simplex),
    };
    if best.gap - radii <= margin {
        patch(&pair, a, best, &simplex, margin, points);
    }
}
