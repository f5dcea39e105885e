//! The depth of a segment inside a cylinder.
//!
//! Moving by g(n) along the unit direction n just separates a cylinder (radius r, half length h, axis z) from a segment
//! (centre c, unit axis u, half length s), where
//!
//! ```text
//! g(n) = r |n across z| + h |n·z| + s |n·u| − n·c.
//! ```
//!
//! The depth is the least g. Where all terms are smooth the Hessian of g on the sphere has the eigenvalue −g < 0, so a
//! least g > 0 lies on a crease: at n = ±z; among the horizontal n; or among the n across u. The second family is the
//! distance from a point to the boundary of a stadium. In the third, with a = z × u, b = u × a (scaled to unit length),
//! n = a cos θ + b sin θ, x = tan θ, k = r |u·z|, and a, b oriented so that c·a, c·b ≥ 0, the slope of g has the sign
//! of
//!
//! ```text
//! F(x) = h |b·z| − c·b + (c·a) x − (r² − k²) x / √(r² + k² x²),
//! ```
//!
//! which is convex, so an interior minimum of g is the larger root of F, between the minimum of F and infinity.

use super::segment::Segment;
use clench_math::{Real, Scalar, Vec3, kernel};

/// The number of bisections of a right angle down to rounding error.
const HALVINGS: usize = 54;

/// Computes the depth of a segment in a cylinder about the origin along z, and the unit direction in which to move it
/// out.
#[kernel]
pub(super) fn penetration_depth<T: Real>(
    radius: T,
    half_length: T,
    segment: &Segment<T>,
) -> (T, Vec3<T>) {
    let Segment {
        center,
        axis,
        half_length: reach,
    } = *segment;
    let (zero, one) = (T::ZERO, T::ONE);
    let z = Vec3::new(zero, zero, one);
    let (a, _) = z.cross(axis).normalize();
    let a = towards(center, a);
    let b = towards(center, axis.cross(a).normalize().0);

    let candidates = [
        a,
        towards(center, z),
        b,
        radial_direction(segment, a),
        direction_across_segment(radius, half_length, segment, a, b),
    ];
    let mut best = (T::splat(T::Scalar::INFINITY), a);
    for n in candidates {
        let across = (n.x * n.x + n.y * n.y).sqrt();
        let sides = radius * across + half_length * n.z.abs() + reach * n.dot(axis).abs();
        let g = sides - n.dot(center);
        let less = g.lt(best.0);
        best = (T::select(less, g, best.0), Vec3::select(less, n, best.1));
    }
    best
}

/// Returns `n` or `-n`, whichever points to the side of `center`.
#[inline(always)]
fn towards<T: Real>(center: Vec3<T>, n: Vec3<T>) -> Vec3<T> {
    Vec3::select(n.dot(center).lt(T::ZERO), -n, n)
}

/// Returns the best horizontal direction: from the cylinder's axis to the nearest point of the segment, both projected
/// along the axis.
#[inline(always)]
fn radial_direction<T: Real>(segment: &Segment<T>, spare: Vec3<T>) -> Vec3<T> {
    let flat = |v: Vec3<T>| Vec3::new(v.x, v.y, T::ZERO);
    let (c, u) = (flat(segment.center), flat(segment.axis));
    let square = u.norm_squared().max(T::new(1e-15));
    let t = segment.clamp(-(c.dot(u)) / square);
    let nearest = c + u * t;
    let length = nearest.norm();
    let on_axis = length.lt(T::new(1e-12));
    let unit = nearest * (T::ONE / T::select(on_axis, T::ONE, length));
    Vec3::select(on_axis, spare, unit)
}

/// Returns the best direction across the segment, between `a` and `b`.
#[inline(always)]
fn direction_across_segment<T: Real>(
    radius: T,
    half_length: T,
    segment: &Segment<T>,
    a: Vec3<T>,
    b: Vec3<T>,
) -> Vec3<T> {
    let r2 = radius * radius;
    let k2 = r2 * segment.axis.z.squared();
    let level = half_length * b.z.abs() - segment.center.dot(b);
    let aside = segment.center.dot(a).max(radius * T::new(1e-9));
    // Bounds on θ as (cosine, sine): the minimum of F, where r² + k²x² = (r² (r² − k²) / c·a)^⅔, and a right angle.
    let stationary = ((r2 - k2).max(T::ZERO) * r2 / aside).powf(T::new(2.0 / 3.0));
    let rise = (stationary - r2).max(T::ZERO);
    let total = (rise + k2).sqrt();
    let flat = total.lt(T::new(1e-15));
    let inverse = T::ONE / T::select(flat, T::ONE, total);
    let mut low = (
        T::select(flat, T::ONE, k2.sqrt() * inverse),
        T::select(flat, T::ZERO, rise.sqrt() * inverse),
    );
    let mut high = (T::ZERO, T::ONE);
    for _ in 0..HALVINGS {
        let (cosine, sine) = (low.0 + high.0, low.1 + high.1);
        let inverse = T::ONE / (cosine * cosine + sine * sine).sqrt();
        let (cosine, sine) = (cosine * inverse, sine * inverse);
        let round = (r2 * cosine * cosine + k2 * sine * sine).sqrt();
        let slope = level * cosine + aside * sine - (r2 - k2) * sine * cosine / round;
        let rising = slope.gt(T::ZERO);
        high = (
            T::select(rising, cosine, high.0),
            T::select(rising, sine, high.1),
        );
        low = (
            T::select(rising, low.0, cosine),
            T::select(rising, low.1, sine),
        );
    }
    let (mut cosine, mut sine) = high;
    if T::IS_DUAL {
        // Bisection has no derivatives. A step of Newton's method from the root has.
        let [c, s] = [cosine, sine].map(|x| T::from_value(x.value()));
        let round = (r2 * c * c + k2 * s * s).sqrt();
        let slope = level * c + aside * s - (r2 - k2) * s * c / round;
        let turn = (c * c - s * s) / round + (r2 - k2) * (s * c / round).squared() / round;
        let bend = aside * c - level * s - (r2 - k2) * turn;
        let is_root = slope.abs().lt(T::new(1e-9) * (radius + half_length))
            & bend.gt(T::new(1e-9) * (radius + half_length));
        let mut angle = T::select(is_root, -slope / bend, T::ZERO);
        angle.set_value(T::ZERO.value());
        (cosine, sine) = (c - s * angle, s + c * angle);
    }
    let n = a * cosine + b * sine;
    n * (T::ONE / n.norm())
}

/// Returns the parameter of the segment's deepest point along the direction `outward` found by [`penetration_depth`]:
/// at an end, or, if the direction is across the segment, below the circle of the cap or the side. Between two parallel
/// flats any point is valid and it returns `otherwise`.
#[kernel]
pub(super) fn deepest<T: Real>(
    radius: T,
    half_length: T,
    segment: &Segment<T>,
    outward: Vec3<T>,
    otherwise: T,
) -> T {
    let tiny = T::new(1e-6);
    let (c, u) = (segment.center, segment.axis);
    let slope = outward.dot(u);
    let end = segment.half_length.copysign(-slope);

    let flat = |v: Vec3<T>| Vec3::new(v.x, v.y, T::ZERO);
    let level = flat(outward).norm();
    let upward = outward.z.abs();
    // The point of the circle of the cap furthest along the direction.
    let mut circle_point = flat(outward) * (radius / T::select(level.lt(tiny), T::ONE, level));
    circle_point.z = half_length.copysign(outward.z);
    let below_circle = u.dot(circle_point - c);
    let level_part = flat(u).norm_squared();
    let parallel = level_part.lt(tiny * tiny);
    let below_side = -(flat(c).dot(u)) / T::select(parallel, T::ONE, level_part);
    let below_side = T::select(parallel, otherwise, below_side);
    let across = T::select(upward.lt(tiny), below_side, below_circle);
    let across = T::select(level.lt(tiny), otherwise, across);
    T::select(slope.abs().lt(tiny), segment.clamp(across), end)
}
