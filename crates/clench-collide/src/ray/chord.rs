//! The interval of a line within a convex body.

use super::line::Line;
use clench_math::{Real, Scalar, Vec3};

/// The entry and exit distances of a line, and the outward normals there. It is empty if `exit` is less than `entry`.
#[derive(Clone, Copy)]
pub(crate) struct Chord<T> {
    pub entry: T,
    pub exit: T,
    pub entry_normal: Vec3<T>,
    pub exit_normal: Vec3<T>,
}

impl<T: Real> Chord<T> {
    /// Returns the whole line.
    #[inline(always)]
    pub(crate) fn whole() -> Self {
        Chord {
            entry: T::new(f64::NEG_INFINITY),
            exit: T::new(f64::INFINITY),
            entry_normal: Vec3::ZERO,
            exit_normal: Vec3::ZERO,
        }
    }

    /// Returns the interval within a ball.
    #[inline(always)]
    pub(crate) fn of_ball(line: &Line<T>, center: Vec3<T>, radius: T) -> Self {
        let offset = line.origin - center;
        let back = offset.dot(line.along);
        // Measured from the nearest point of the line, since the origin may be far away.
        let square = radius * radius - (offset - line.along * back).norm_squared();
        let half = square.max(T::ZERO).sqrt();
        Chord::whole().between(-back - half, -back + half, square.ge(T::ZERO))
    }

    /// Returns the interval within the unbounded cylinder about the z axis.
    #[inline(always)]
    pub(crate) fn of_tube(line: &Line<T>, radius: T) -> Self {
        let (o, u) = (line.origin, line.along);
        let square = u.x * u.x + u.y * u.y;
        let least = T::splat(T::Scalar::EPSILON * T::Scalar::EPSILON);
        let parallel = square.lt(least);
        let divisor = T::select(parallel, T::ONE, square);
        let back = (o.x * u.x + o.y * u.y) / divisor;
        let back = T::select(parallel, T::ZERO, back);
        let (x, y) = (o.x - u.x * back, o.y - u.y * back);
        let rest = radius * radius - x * x - y * y;
        let half = (rest.max(T::ZERO) / divisor).sqrt();
        let half = T::select(parallel, T::new(f64::INFINITY), half);
        Chord::whole().between(-back - half, -back + half, rest.ge(T::ZERO))
    }

    #[inline(always)]
    fn between(self, entry: T, exit: T, hit: T::Mask) -> Self {
        Chord {
            entry: T::select(hit, entry, T::new(f64::INFINITY)),
            exit: T::select(hit, exit, T::new(f64::NEG_INFINITY)),
            ..self
        }
    }

    /// Intersects with the slab between two planes across an axis.
    #[inline(always)]
    pub(crate) fn slab(self, line: &Line<T>, axis: usize, low: T, high: T) -> Self {
        let (o, u) = (line.origin[axis], line.along[axis]);
        let parallel = u.eq(T::ZERO);
        let within = o.ge(low) & o.le(high);
        let ahead = u.gt(T::ZERO);
        let infinity = T::new(f64::INFINITY);
        let divisor = T::select(parallel, T::ONE, u);
        let entry = (T::select(ahead, low, high) - o) / divisor;
        let exit = (T::select(ahead, high, low) - o) / divisor;
        let unbounded = T::select(within, -infinity, infinity);
        let mut out = Vec3::ZERO;
        out[axis] = T::ONE.copysign(u);
        self.intersect(
            (T::select(parallel, unbounded, entry), -out),
            (T::select(parallel, -unbounded, exit), out),
        )
    }

    /// Intersects with another interval: its entry and exit, each with a normal.
    #[inline(always)]
    pub(crate) fn intersect(
        self,
        (entry, entry_normal): (T, Vec3<T>),
        (exit, exit_normal): (T, Vec3<T>),
    ) -> Self {
        let (later, earlier) = (entry.gt(self.entry), exit.lt(self.exit));
        Chord {
            entry: T::select(later, entry, self.entry),
            exit: T::select(earlier, exit, self.exit),
            entry_normal: Vec3::select(later, entry_normal, self.entry_normal),
            exit_normal: Vec3::select(earlier, exit_normal, self.exit_normal),
        }
    }

    /// Returns the interval within the union of two bodies, which must be convex.
    #[inline(always)]
    pub(crate) fn or(self, other: Self) -> Self {
        let infinity = T::new(f64::INFINITY);
        let hits = self.entry.le(self.exit);
        let entry = T::select(hits, self.entry, infinity);
        let exit = T::select(hits, self.exit, -infinity);
        let hits = other.entry.le(other.exit);
        Chord {
            entry: entry.min(T::select(hits, other.entry, infinity)),
            exit: exit.max(T::select(hits, other.exit, -infinity)),
            ..self
        }
    }

    /// Returns the first crossing of the surface at or after the origin, and its normal. The distance is infinite if
    /// there is none.
    #[inline(always)]
    pub(crate) fn first(&self) -> (T, Vec3<T>) {
        let outside = self.entry.ge(T::ZERO);
        let hit = self.entry.le(self.exit) & self.exit.ge(T::ZERO);
        let distance = T::select(outside, self.entry, self.exit);
        (
            T::select(hit, distance, T::new(f64::INFINITY)),
            Vec3::select(outside, self.entry_normal, self.exit_normal),
        )
    }
}
