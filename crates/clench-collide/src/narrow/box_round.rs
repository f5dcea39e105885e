//! A box against round shapes: sphere–box, and capsule–box as up to two spheres on the capsule's axis.
//!
//! Both work in the box's frame, where the nearest point of the box is a clamp of the coordinates. Once the capsule's
//! segment enters the box, no sphere on it yields the capsule's depth, and the general convex search is used.

use super::convex;
use super::per_lane::per_lane_where;
use super::placed::Placed;
use crate::contact::{ContactPoint, Contacts};
use crate::shape::{Capsule, Cuboid, Sphere};
use clench_math::{Mask, Real, Scalar, Vec3, kernel};

/// Clamps each coordinate to the box of half lengths `size`.
#[inline(always)]
fn clamp<T: Real>(p: Vec3<T>, size: Vec3<T>) -> Vec3<T> {
    Vec3::new(
        p.x.clamp(-size.x, size.x),
        p.y.clamp(-size.y, size.y),
        p.z.clamp(-size.z, size.z),
    )
}

#[inline(always)]
fn differ<M: Mask>(a: M, b: M) -> M {
    (a & !b) | (b & !a)
}

/// Returns the normal out of a ball whose centre is inside the box, through the nearest face, and that face's distance.
#[inline(always)]
fn nearest_face<T: Real>(center: Vec3<T>, size: Vec3<T>) -> (Vec3<T>, T) {
    let mut depth = T::new(f64::INFINITY);
    let mut normal = Vec3::ZERO;
    for axis in 0..3 {
        for inward in [T::ONE, -T::ONE] {
            let gap = (size[axis] + inward * center[axis]).abs();
            let nearer = gap.lt(depth);
            let mut out = Vec3::ZERO;
            out[axis] = inward;
            depth = T::select(nearer, gap, depth);
            normal = Vec3::select(nearer, out, normal);
        }
    }
    (normal, depth)
}

/// Adds the contact of a ball with the box; `center` is in the box's frame.
#[inline(always)]
fn ball_box<T: Real>(
    center: Vec3<T>,
    radius: T,
    b: Placed<Cuboid<T>, T>,
    margin: T,
    wanted: T::Mask,
    out: &mut Contacts<T>,
) {
    let size = b.shape.half_lengths;
    let offset = clamp(center, size) - center;
    let squared = offset.norm_squared();
    let reach = radius + margin;
    let near = squared.le(reach * reach) & wanted;
    if !near.any() {
        return;
    }
    let length = squared.sqrt();
    let inside = length.le(T::new(1e-15));
    let mut normal = offset * (T::ONE / T::select(inside, T::ONE, length));
    let mut distance = length - radius;
    if inside.any() {
        let (face_normal, depth) = nearest_face(center, size);
        normal = Vec3::select(inside, face_normal, normal);
        distance = T::select(inside, -depth - radius, distance);
    }
    let active = near & distance.le(margin);
    let position = center + normal * (radius + distance * T::new(0.5));
    let normal = b.pose.rotation * normal;
    out.push(ContactPoint::new(
        b.pose.point(position),
        normal,
        distance,
        active,
    ));
}

#[kernel]
pub(super) fn sphere_box<T: Real>(
    a: Placed<Sphere<T>, T>,
    b: Placed<Cuboid<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let center = b.pose.local(a.pose.position);
    let all = T::Mask::splat(true);
    ball_box(center, a.shape.radius, b, margin, all, out);
}

#[kernel]
pub(super) fn capsule_box<T: Real>(
    a: Placed<Capsule<T>, T>,
    b: Placed<Cuboid<T>, T>,
    margin: T,
    out: &mut Contacts<T>,
) {
    let center = b.pose.local(a.pose.position);
    let half = b.pose.rotation.transpose_mul(a.pose.axis()) * a.shape.half_length;
    let (radius, size) = (a.shape.radius, b.shape.half_lengths);
    let beyond = |i: usize| center[i].abs() - half[i].abs() - size[i];
    let near = (beyond(0).max(beyond(1)).max(beyond(2)) - radius).le(margin);
    if !near.any() {
        return;
    }
    let sunk = near & enters(center, half, size);
    if sunk.any() {
        per_lane_where(sunk, a, b, margin, out, |_, a, b, margin, points| {
            // The bodies overlap, so no direction separates them.
            let _ = convex::points(a.any(), b.any(), margin, None, points);
        });
    }
    let beside = near & !sunk;
    if beside.any() {
        let nearest = Nearest::find(center, half, size);
        let (far, lies_along) = nearest.second(half, size);
        ball_box(
            center + half * nearest.along,
            radius,
            b,
            margin,
            beside,
            out,
        );
        let again = beside & lies_along;
        if again.any() {
            ball_box(center + half * far, radius, b, margin, again, out);
        }
    }
}

/// Returns the lanes in which a segment, centre + x·half with x in [−1, 1], has a point in the box: between all three
/// pairs of its faces for some x.
#[inline(always)]
fn enters<T: Real>(center: Vec3<T>, half: Vec3<T>, size: Vec3<T>) -> T::Mask {
    let (mut from, mut to) = (-T::ONE, T::ONE);
    let mut between = T::Mask::splat(true);
    for i in 0..3 {
        let (c, h) = (center[i], half[i]);
        let level = h.abs().lt(T::new(1e-15));
        let inverse = T::ONE / T::select(level, T::ONE, h.abs());
        let middle = -(c * inverse).copysign(c * h);
        let reach = size[i] * inverse;
        between &= !level | c.abs().le(size[i]);
        from = T::select(level, from, from.max(middle - reach));
        to = T::select(level, to, to.min(middle + reach));
    }
    between & from.le(to)
}

/// The point of a capsule's segment, centre + x·half with x in [−1, 1], nearest to a box.
struct Nearest<T: Real> {
    /// The parameter x.
    along: T,
    /// The nearest point of the box.
    point: Vec3<T>,
    /// For each axis, true if `point` is at its limit: none inside the box, one on a face, two on an edge, three at a
    /// corner.
    limit: [T::Mask; 3],
    squared_distance: T,
}

impl<T: Real> Nearest<T> {
    /// Finds the nearest of the ends, to a face or inside the box, and the points nearest to the edges.
    #[inline(always)]
    fn find(center: Vec3<T>, half: Vec3<T>, size: Vec3<T>) -> Self {
        let mut best = Nearest {
            along: T::ZERO,
            point: Vec3::ZERO,
            limit: [T::Mask::splat(false); 3],
            squared_distance: T::new(f64::INFINITY),
        };
        for along in [-T::ONE, T::ONE] {
            let end = center + half * along;
            let point = clamp(end, size);
            let x = end.x.abs().gt(size.x);
            let y = end.y.abs().gt(size.y);
            let z = end.z.abs().gt(size.z);
            let over_face = !((x & y) | (x & z) | (y & z));
            let squared_distance = (point - end).norm_squared();
            let nearer = over_face & squared_distance.lt(best.squared_distance);
            best.take(nearer, along, point, [x, y, z], squared_distance);
        }
        for axis in 0..3 {
            for corner in 0..4 {
                best.try_edge(center, half, size, axis, corner);
            }
        }
        best
    }

    #[inline(always)]
    fn take(&mut self, nearer: T::Mask, along: T, point: Vec3<T>, limit: [T::Mask; 3], squared: T) {
        self.along = T::select(nearer, along, self.along);
        self.point = Vec3::select(nearer, point, self.point);
        self.squared_distance = T::select(nearer, squared, self.squared_distance);
        for (old, new) in self.limit.iter_mut().zip(limit) {
            *old = (nearer & new) | (!nearer & *old);
        }
    }

    /// Tries the edge along `axis` through one of the four `corner`s across it: nearest points of two segments, both
    /// parameters in [−1, 1], by clamping in turn.
    #[inline(always)]
    fn try_edge(
        &mut self,
        center: Vec3<T>,
        half: Vec3<T>,
        size: Vec3<T>,
        axis: usize,
        corner: usize,
    ) {
        let (one, two) = ((axis + 1) % 3, (axis + 2) % 3);
        let sign = |bit: usize| T::new(if corner & bit != 0 { 1.0 } else { -1.0 });
        let mut middle = Vec3::ZERO;
        middle[one] = size[one] * sign(1);
        middle[two] = size[two] * sign(2);
        let offset = middle - center;

        // Normal equations of |offset + edge·y − half·x|² with y along the edge and x along the capsule.
        let edge_squared = size[axis] * size[axis];
        let mixed = -size[axis] * half[axis];
        let half_squared = half.norm_squared();
        let edge_side = -size[axis] * offset[axis];
        let half_side = half.dot(offset);
        let determinant = edge_squared * half_squared - mixed * mixed;
        // Parallel edges are handled by the ends of the segment and the edges across.
        let apart = determinant.abs().ge(T::new(1e-15));
        let inverse = T::ONE / T::select(apart, determinant, T::ONE);

        let unit = |v: T| v.clamp(-T::ONE, T::ONE);
        let free_y = (half_squared * edge_side - mixed * half_side) * inverse;
        let y = unit(free_y);
        let free_x = T::select(
            free_y.eq(y),
            (edge_squared * half_side - mixed * edge_side) * inverse,
            (half_side - mixed * y) / half_squared,
        );
        let x = unit(free_x);
        let moved = !free_x.eq(x);
        let free_again = (edge_side - mixed * x) / edge_squared;
        let again = unit(free_again);
        // MuJoCo treats the point as the corner once any clamp was active, and searches the second point from there.
        let first_met = !free_y.eq(y);
        let again_met = moved & !free_again.eq(again);
        let at_corner = first_met | again_met;
        let met = T::select(again_met, again, y);
        let y = T::select(moved, again, y);

        let mut point = middle;
        point[axis] = size[axis] * y;
        let squared = (point - center - half * x).norm_squared();
        let nearer = apart & squared.lt(self.squared_distance - T::new(1e-15));
        point[axis] = T::select(at_corner, size[axis] * met, point[axis]);
        let mut limit = [T::Mask::splat(true); 3];
        limit[axis] = at_corner;
        self.take(nearer, x, point, limit, squared);
    }

    /// Returns the parameter of a second contact, which stabilizes a capsule lying along the box, and its lanes.
    ///
    /// It moves from the nearest point along the capsule, over the face that it is most nearly parallel to (or along
    /// the edge), to the end of the capsule or of the box: the furthest possible contact. The direction and the
    /// relevant sides of the box depend on the nearest point and, for each axis, on whether moving forward leads
    /// inward. A capsule that points at the box from outside has no second contact.
    #[inline(always)]
    fn second(&self, half: Vec3<T>, size: Vec3<T>) -> (T, T::Mask) {
        let limit = self.limit;
        let mut inward = [T::Mask::splat(false); 3];
        for (i, inward) in inward.iter_mut().enumerate() {
            *inward = differ(half[i].gt(T::ZERO), self.point[i].gt(T::ZERO));
        }
        let sign = |mask: T::Mask| T::select(mask, T::ONE, -T::ONE);
        let mut sense = T::ZERO;
        let mut walls = [T::Mask::splat(false); 3];
        let total = half.norm_squared();
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // An end above face i: towards the other end, within the face.
            let face = limit[i] & !limit[j] & !limit[k];
            sense = T::select(face, -self.along, sense);
            walls[j] |= face;
            walls[k] |= face;
            // On an edge along i, unless both directions lead off or both sides lead in: over the flatter of its two
            // faces.
            let edge = !limit[i] & limit[j] & limit[k] & differ(inward[j], inward[k]);
            let over_j = edge & half[j].abs().le(half[k].abs());
            let over_k = edge & !over_j;
            sense = T::select(over_j, sign(inward[k]), sense);
            sense = T::select(over_k, sign(inward[j]), sense);
            walls[i] |= edge;
            walls[k] |= over_j;
            walls[j] |= over_k;
            // At a corner where only axis i leads the other way: along the edge i, or else over the face across it.
            let corner = limit[0]
                & limit[1]
                & limit[2]
                & differ(inward[i], inward[j])
                & differ(inward[i], inward[k]);
            let steep = half[i].squared().gt(total * T::new(0.5));
            let along_edge = corner & steep;
            let over_face = corner & !steep;
            sense = T::select(along_edge, sign(inward[i]), sense);
            sense = T::select(over_face, -sign(inward[i]), sense);
            walls[i] |= along_edge;
            walls[j] |= over_face;
            walls[k] |= over_face;
        }
        // A side that the capsule is parallel to, up to rounding, is no limit.
        let least = total.sqrt() * T::splat(T::Scalar::EPSILON) * T::new(1e4);
        let mut length = T::ONE - sense * self.along;
        for i in 0..3 {
            let step = sense * half[i];
            let exit = (size[i].copysign(step) - self.point[i]) / step;
            let counts = walls[i] & exit.gt(T::ZERO) & step.abs().gt(least);
            length = T::select(counts, exit.min(length), length);
        }
        (self.along + sense * length, !sense.eq(T::ZERO))
    }
}
