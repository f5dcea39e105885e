//! Capsule–capsule: the nearest points of two segments.
//!
//! With unit axes u₁, u₂, offset d from the first centre to the second and w = u₁ × u₂, the lines are nearest at
//!
//!     t₁ = (d × u₂)·w / |w|²   on the first line,
//!
//! and the second parameter is the projection of that point. Clamping each to its segment in turn, and projecting once
//! more, gives the nearest points of the segments. The triple product keeps its digits where the axes are nearly
//! parallel. Below an angle of 1e-4 (MuJoCo 4.0's limit) they count as parallel and touch at two of their ends.

use super::{
    Placed,
    ball::{Ball, across_axes, ball_ball},
};
use crate::Contacts;
use clench_math::{Mask, Real, Vec3};

/// The squared sine of the angle below which capsules are parallel.
const PARALLEL: f64 = 1e-8;

/// The middle line of a capsule and its radius.
#[derive(Clone, Copy)]
struct Segment<T> {
    center: Vec3<T>,
    axis: Vec3<T>,
    half_length: T,
    radius: T,
}

impl<T: Real> Segment<T> {
    #[inline(always)]
    fn new(capsule: Placed<T>) -> Self {
        Segment {
            center: capsule.pose.position,
            axis: capsule.pose.axis(),
            half_length: capsule.shape.size.y,
            radius: capsule.shape.size.x,
        }
    }
    #[inline(always)]
    fn clamp(&self, along: T) -> T {
        along.clamp(-self.half_length, self.half_length)
    }
    #[inline(always)]
    fn ball(&self, along: T) -> Ball<T> {
        Ball {
            center: self.center + self.axis * along,
            radius: self.radius,
        }
    }
    /// The ball on this segment nearest to a point.
    #[inline(always)]
    fn nearest(&self, point: Vec3<T>) -> Ball<T> {
        self.ball(self.clamp(self.axis.dot(point - self.center)))
    }
}

pub(super) fn capsule_capsule<T: Real>(
    a: Placed<T>,
    b: Placed<T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let (first, second) = (Segment::new(a), Segment::new(b));
    let offset = second.center - first.center;
    let across = first.axis.cross(second.axis);
    let sine_squared = across.norm_squared();
    let parallel = sine_squared.lt(T::new(PARALLEL));

    let inverse = T::ONE / T::select(parallel, T::ONE, sine_squared);
    let s = first.clamp(offset.cross(second.axis).dot(across) * inverse);
    let cosine = first.axis.dot(second.axis);
    let free = cosine * s - second.axis.dot(offset);
    let t = second.clamp(free);
    let again = first.clamp(first.axis.dot(offset) + cosine * t);
    let s = T::select(free.eq(t), s, again);
    let normal = || across_axes(a, b);
    ball_ball(
        first.ball(s),
        second.ball(t),
        normal,
        margin,
        !parallel,
        out,
    );
    if parallel.any() {
        parallel_capsules(first, second, normal, margin, parallel, out);
    }
}

/// The first two contacts among: each end of the first capsule with what is nearest on the second, and the reverse.
fn parallel_capsules<T: Real>(
    first: Segment<T>,
    second: Segment<T>,
    normal: impl Fn() -> Vec3<T>,
    margin: T,
    parallel: T::Mask,
    out: &mut Contacts<T>,
) {
    let mut found = T::ZERO;
    let mut add = |one: Ball<T>, other: Ball<T>| {
        let wanted = parallel & found.lt(T::new(2.0));
        if wanted.any() {
            let active = ball_ball(one, other, &normal, margin, wanted, out);
            found += T::select(active, T::ONE, T::ZERO);
        }
    };
    for sign in [1.0, -1.0] {
        let end = first.ball(first.half_length * T::new(sign));
        add(end, second.nearest(end.center));
    }
    for sign in [1.0, -1.0] {
        let end = second.ball(second.half_length * T::new(sign));
        add(first.nearest(end.center), end);
    }
}
