//! Sphere–cylinder and capsule–cylinder, from the signed distance of a point to a cylinder.

use super::ball::across_axes;
use super::penetration::{deepest, penetration_depth};
use super::placed::Placed;
use super::segment::Segment;
use crate::contact::{ContactPoint, Contacts};
use crate::shape::{Capsule, Cylinder, Sphere};
use clench_math::{Mask, Real, Scalar, Vec3, kernel};

/// The maximum steps to the nearest point of a segment. Four to eight are usual; this many bisections leave only
/// rounding.
const STEPS: usize = 54;
/// The sine of the tilt (5°) below which a capsule lies along a cap or a side.
pub(crate) const LEVEL_SINE: f64 = 0.087;

/// A cylinder in its own frame.
#[derive(Clone, Copy)]
struct LocalCylinder<T> {
    radius: T,
    half_length: T,
    /// The outward direction, across the axis, for points on the axis.
    fallback: Vec3<T>,
}

impl<T: Real> LocalCylinder<T> {
    /// Creates `b` in its own frame, for contact with `a`.
    #[inline(always)]
    fn new<A>(a: Placed<A, T>, b: Placed<Cylinder<T>, T>) -> Self {
        LocalCylinder {
            radius: b.shape.radius,
            half_length: b.shape.half_length,
            fallback: -b.pose.rotation.transpose_mul(across_axes(a, b)),
        }
    }

    /// Returns the signed distance of a point to the surface, and its gradient: the unit outward direction.
    #[inline(always)]
    fn distance(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        let from_axis = (p.x * p.x + p.y * p.y).sqrt();
        let above_cap = p.z.abs() - self.half_length;
        let off_side = from_axis - self.radius;
        let (up, out) = (above_cap.max(T::ZERO), off_side.max(T::ZERO));
        let length = (up * up + out * out).sqrt();
        // Inside, the nearer of cap and side; beyond both, the circle where they meet.
        let within = length.lt(T::new(1e-15));
        let cap = T::select(above_cap.gt(off_side), T::ONE, T::ZERO);
        let inverse = T::ONE / T::select(within, T::ONE, length);
        let along = T::select(within, cap, up * inverse);
        let across = T::select(within, T::ONE - cap, out * inverse);

        let on_axis = from_axis.lt(T::new(1e-15));
        let scale = across / T::select(on_axis, T::ONE, from_axis);
        let radial = Vec3::new(p.x * scale, p.y * scale, T::ZERO);
        let mut outward = Vec3::select(on_axis, self.fallback * across, radial);
        outward.z = T::select(p.z.gt(T::ZERO), along, -along);
        let signed = T::select(within, above_cap.max(off_side), length);
        (signed, outward)
    }
}

/// Adds the contact of a ball with the cylinder `b`, given the centre, and the signed distance and outward direction of
/// the centre, in the cylinder's frame.
#[inline(always)]
fn add_ball<T: Real>(
    center: Vec3<T>,
    radius: T,
    (signed, outward): (T, Vec3<T>),
    b: Placed<Cylinder<T>, T>,
    active: T::Mask,
    out: &mut Contacts<T>,
) {
    if active.any() {
        let distance = signed - radius;
        let position = center - outward * (radius + distance * T::new(0.5));
        let normal = -(b.pose.rotation * outward);
        out.push(ContactPoint::new(
            b.pose.point(position),
            normal,
            distance,
            active,
        ));
    }
}

#[kernel]
pub(super) fn sphere_cylinder<T: Real>(
    a: Placed<Sphere<T>, T>,
    b: Placed<Cylinder<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let radius = a.shape.radius;
    let center = b.pose.local(a.pose.position);
    let nearest = LocalCylinder::new(a, b).distance(center);
    let active = (nearest.0 - radius).le(margin);
    add_ball(center, radius, nearest, b, active, out);
}

/// Adds the deepest point and, if the capsule lies along the cap or the side, both ends of that interval.
///
/// Once the capsule's segment enters the cylinder, the signed distance of its points is no longer the depth of the
/// capsule; [`penetration_depth`] is.
#[kernel]
pub(super) fn capsule_cylinder<T: Real>(
    a: Placed<Capsule<T>, T>,
    b: Placed<Cylinder<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let cylinder = LocalCylinder::new(a, b);
    let radius = a.shape.radius;
    let segment = Segment {
        center: b.pose.local(a.pose.position),
        axis: b.pose.rotation.transpose_mul(a.pose.axis()),
        half_length: a.shape.half_length,
    };
    let near = (cylinder.min_distance(&segment) - radius).le(margin);
    if !near.any() {
        return;
    }
    let nearest = cylinder.nearest_on(&segment);
    let least = cylinder.distance(segment.at(nearest)).0;
    let active = near & (least - radius).le(margin);
    if !active.any() {
        return;
    }
    let rounding = T::splat(T::Scalar::EPSILON) * T::new(8.0);
    let scale = radius + cylinder.radius;
    let entered = least.le(rounding * scale);
    let beside = active & !entered;
    if beside.any() {
        let ends = cylinder.overlap(&segment, nearest);
        // If the two are parallel, an end is as deep as any point between.
        let level = least + rounding.max(T::new(1e-9)) * scale;
        let mut first = nearest;
        for end in ends {
            let as_deep = cylinder.distance(segment.at(end)).0.le(level);
            first = T::select(as_deep, end, first);
        }
        for (k, t) in [first, ends[0], ends[1]].into_iter().enumerate() {
            let wanted = if k == 0 {
                beside
            } else {
                beside & !t.eq(first)
            };
            let center = segment.at(t);
            let surface = cylinder.distance(center);
            let active = wanted & (surface.0 - radius).le(margin);
            add_ball(center, radius, surface, b, active, out);
        }
    }
    let inside = active & entered;
    if inside.any() {
        let (radius_b, half_b) = (cylinder.radius, cylinder.half_length);
        let (depth, outward) = penetration_depth(radius_b, half_b, &segment);
        let center = segment.at(deepest(radius_b, half_b, &segment, outward, nearest));
        add_ball(center, radius, (-depth, outward), b, inside, out);
    }
}

impl<T: Real> LocalCylinder<T> {
    /// Returns a cheap lower bound of a segment's distance: the larger of its distances beyond the caps and beyond the
    /// side.
    #[inline(always)]
    fn min_distance(&self, segment: &Segment<T>) -> T {
        let (c, u) = (segment.center, segment.axis);
        let beyond_caps = c.z.abs() - segment.half_length * u.z.abs() - self.half_length;
        let square = (u.x * u.x + u.y * u.y).max(T::new(1e-15));
        let t = -(c.x * u.x + c.y * u.y) / square;
        let p = segment.at(segment.clamp(t));
        let beyond_side = (p.x * p.x + p.y * p.y).sqrt() - self.radius;
        beyond_caps.max(beyond_side)
    }

    /// Returns the parameter of the segment's point nearest to the cylinder; any point inside if it enters.
    ///
    /// With the distances s beyond the side and h beyond the caps, clamped to zero, ½(s² + h²) is convex along the
    /// segment. Newton's method finds the zero of its slope s s' + h h'. A step that leaves the bracket, or is more
    /// than half as long as the one before, is replaced by bisection.
    #[inline(always)]
    fn nearest_on(&self, segment: &Segment<T>) -> T {
        let whole = segment.half_length;
        let (mut low, mut high) = (-whole, whole);
        let at_low = self.slope(segment, low).0.ge(T::ZERO);
        let at_high = self.slope(segment, high).0.le(T::ZERO);
        let mut found = at_low | at_high;
        let mut t = T::select(at_low, low, T::select(at_high, high, T::ZERO));
        let mut last = whole + whole;
        let enough = (whole + self.radius + self.half_length) * T::splat(T::Scalar::EPSILON);
        for _ in 0..STEPS {
            if found.all() {
                break;
            }
            let (slope, bend) = self.slope(segment, t);
            let rising = slope.gt(T::ZERO);
            high = T::select(rising, t, high);
            low = T::select(rising, low, t);
            let step = -slope / bend.max(T::splat(T::Scalar::MIN_POSITIVE));
            let newton = t + step;
            let converges = step.abs().le(T::new(0.5) * last);
            let newton_serves = converges & newton.ge(low) & newton.le(high);
            let next = T::select(newton_serves, newton, (low + high) * T::new(0.5));
            last = (next - t).abs();
            t = T::select(found, t, next);
            found |= last.le(enough);
        }
        if T::IS_DUAL && !(at_low | at_high).any() {
            // Bisection has no derivatives. A step of Newton's method from the zero has. Where the slope is zero all
            // around, any point is valid, and the one found does not move.
            let fixed = T::from_value(t.value());
            let (slope, bend) = self.slope(segment, fixed);
            let mut refined = fixed - slope / bend;
            refined.set_value(t.value());
            t = T::select(bend.gt(T::new(1e-9)), refined, fixed);
        }
        t
    }

    /// Returns the first and second derivative of ½(s² + h²) along a segment.
    #[inline(always)]
    fn slope(&self, segment: &Segment<T>, t: T) -> (T, T) {
        let (p, u) = (segment.at(t), segment.axis);
        let from_axis = (p.x * p.x + p.y * p.y).sqrt();
        let inverse = T::ONE / from_axis.max(T::splat(T::Scalar::MIN_POSITIVE));
        let beyond_side = (from_axis - self.radius).max(T::ZERO);
        let beyond_cap = (p.z.abs() - self.half_length).max(T::ZERO);
        let outward = (p.x * u.x + p.y * u.y) * inverse;
        let upward = u.z.copysign(u.z * p.z);
        let around = (u.x * u.x + u.y * u.y - outward * outward) * inverse;
        let side = outward * outward + beyond_side * around;
        let bend = T::select(beyond_side.gt(T::ZERO), side, T::ZERO)
            + T::select(beyond_cap.gt(T::ZERO), upward * upward, T::ZERO);
        (beyond_side * outward + beyond_cap * upward, bend)
    }

    /// Returns the ends of the interval of a segment along the cap or the side, whichever the point at `nearest` faces
    /// more; that point twice if the segment is tilted against it.
    #[inline(always)]
    fn overlap(&self, segment: &Segment<T>, nearest: T) -> [T; 2] {
        let (c, u) = (segment.center, segment.axis);
        let tiny = T::new(1e-15);
        // Above the cap: |c + u t|² ≤ radius² in the plane of the cap.
        let square = (u.x * u.x + u.y * u.y).max(tiny);
        let middle = -(c.x * u.x + c.y * u.y) / square;
        let miss = c.x * u.y - c.y * u.x;
        let reach = (self.radius.squared() * square - miss * miss)
            .max(T::ZERO)
            .sqrt()
            / square;
        // Beside the side: |c + u t| ≤ half length along the axis.
        let slope = T::select(u.z.abs().lt(tiny), tiny, u.z);
        let level = -c.z / slope;
        let extent = self.half_length / slope.abs();

        let (_, outward) = self.distance(segment.at(nearest));
        let cap = outward.z.squared().gt(T::new(0.5));
        let middle = T::select(cap, middle, level);
        let reach = T::select(cap, reach, extent);
        let tilt = T::select(cap, u.z.squared(), u.x * u.x + u.y * u.y);
        let along = tilt.le(T::new(LEVEL_SINE * LEVEL_SINE));
        let whole = segment.half_length;
        let low = (middle - reach).max(-whole).min(nearest);
        let high = (middle + reach).min(whole).max(nearest);
        [low, high].map(|end| T::select(along, end, nearest))
    }
}
