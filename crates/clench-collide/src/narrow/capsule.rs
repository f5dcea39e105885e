//! Capsule–capsule: the nearest points of two segments.
//!
//! With unit axes u₁, u₂, offset d from the first centre to the second and w = u₁ × u₂, the nearest points of the lines
//! are at
//!
//! ```text
//! t₁ = (d × u₂)·w / |w|²   on the first line,
//! ```
//!
//! and the second parameter is the projection of that point. Clamping each to its segment in turn, and projecting once
//! more, gives the nearest points of the segments. The triple product is accurate even if the axes are nearly parallel.
//! Below an angle of 1e-4 (MuJoCo 4.0's limit) they count as parallel and touch at both ends of their overlap; if they
//! do not overlap, both contacts are the same, as in MuJoCo.

use super::ball::{Ball, across_axes, ball_ball};
use super::placed::Placed;
use super::segment::Segment;
use crate::contact::Contacts;
use crate::shape::Capsule;
use clench_math::{Mask, Real, kernel};

/// The squared sine of the angle below which capsules are parallel.
const PARALLEL: f64 = 1e-8;

#[kernel]
pub(super) fn capsule_capsule<T: Real>(
    a: Placed<Capsule<T>, T>,
    b: Placed<Capsule<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let (first, second) = (Segment::of(a), Segment::of(b));
    let offset = second.center - first.center;
    let across = first.axis.cross(second.axis);
    let cosine = first.axis.dot(second.axis);
    let ahead = first.axis.dot(offset);
    let behind = second.axis.dot(offset);
    let sine_squared = across.norm_squared();
    let parallel = sine_squared.lt(T::new(PARALLEL));

    let inverse = T::ONE / T::select(parallel, T::ONE, sine_squared);
    let s = first.clamp(offset.cross(second.axis).dot(across) * inverse);
    let free = cosine * s - behind;
    let t = second.clamp(free);
    let s = T::select(free.eq(t), s, first.clamp(ahead + cosine * t));

    // Parallel: the start and end of the second segment on the first. Each is an end of one of them.
    let extent = second.half_length * cosine.abs();
    let end = second.half_length.copysign(cosine);
    for (sign, wanted) in [(-T::ONE, T::Mask::splat(true)), (T::ONE, parallel)] {
        if !wanted.any() {
            break;
        }
        let free = ahead + extent * sign;
        let overlap = first.clamp(free);
        let projected = second.clamp(cosine * overlap - behind);
        let s = T::select(parallel, overlap, s);
        let t = T::select(
            parallel,
            T::select(free.eq(overlap), end * sign, projected),
            t,
        );
        let one = Ball {
            center: first.at(s),
            radius: a.shape.radius,
        };
        let other = Ball {
            center: second.at(t),
            radius: b.shape.radius,
        };
        ball_ball(one, other, || across_axes(a, b), margin, wanted, out);
    }
}
