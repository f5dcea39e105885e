//! The shortest string between two points around, or through, a sphere or an infinite cylinder.
//!
//! The problem is planar: across the cylinder's axis, or through the sphere's centre and both points. The obstacle is a
//! circle of radius r about the origin. Let θ be the angle of the string about the origin, 0 ≤ θ ≤ 2π, and R₀, R₁ the
//! distances of its ends. From an end the tangent to the circle spans the angle φ = acos(r/R), so that
//!
//! ```text
//! arc = θ − φ₀ − φ₁        length = √(R₀² − r²) + r · arc + √(R₁² − r²)        if arc > 0
//! ```
//!
//! else the straight segment misses the circle and is the shortest string. Without a side site, θ is the angle between
//! the ends. With one outside the obstacle, the string turns in the direction and by the angle of the polyline from end
//! to side site to end (MuJoCo 4.0, XML reference of `sidesite`). A string along a cylinder is straight on the unrolled
//! surface: its height rises in proportion to the length in the plane.
//!
//! A side site inside the obstacle lets the string pass through: it touches the circle in at least one point. If the
//! segment misses the circle, that point x reflects it, at equal angles β to the normal. Seen from the origin, the ends
//! are β − asin(sin β · r/R) to either side of x, hence
//!
//! ```text
//! f(β) = asin(sin β · r/R₀) + asin(sin β · r/R₁) − 2β + θ = 0
//! ```
//!
//! Newton's method solves it from β = π/2 as in MuJoCo, to the same tolerance.

use clench_math::{Mask, Mat3, Real, Scalar, Vec3, kernel};

/// Lengths (and squared distances) below this count as zero (MuJoCo's `mjMINVAL`).
const MIN_LENGTH: f64 = 1e-15;
/// The tolerance of f, rad.
const TOLERANCE: f64 = 1e-6;
/// The same in roundings of the working precision, if that is coarser.
const TOLERANCE_ROUNDINGS: f64 = 16.0;
/// The maximum number of Newton steps.
const MAX_ITERATIONS: usize = 20;

/// The shape of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrapShape {
    /// A sphere.
    Sphere,
    /// An infinite cylinder along the third axis of its frame.
    Cylinder,
}

/// An obstacle of a string.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<T> {
    /// The shape.
    pub shape: WrapShape,
    /// The centre, or a point on the axis.
    pub centre: Vec3<T>,
    /// The axes of the frame.
    pub axes: Mat3<T>,
    /// The radius, m.
    pub radius: T,
    /// A point on the side where the string must pass, or inside if it must pass through.
    pub side: Option<Vec3<T>>,
}

/// The contact of a string with its obstacle.
#[derive(Clone, Copy, Debug)]
pub struct Wrapped<T: Real> {
    /// The lanes in which it touches; elsewhere it is straight.
    pub touches: T::Mask,
    /// The first and last point on the obstacle.
    pub points: [Vec3<T>; 2],
    /// The length between them.
    pub length: T,
}

/// A point of the plane.
#[derive(Clone, Copy, Debug)]
struct Planar<T> {
    x: T,
    y: T,
}

impl<T: Real> Planar<T> {
    #[inline(always)]
    fn new(x: T, y: T) -> Self {
        Planar { x, y }
    }
    #[inline(always)]
    fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y
    }
    #[inline(always)]
    fn cross(self, o: Self) -> T {
        self.x * o.y - self.y * o.x
    }
    /// Returns the angle from `self` to `o` seen from the origin, in [−π, π].
    #[inline(always)]
    fn angle_to(self, o: Self) -> T {
        self.cross(o).atan2(self.dot(o))
    }
    /// Returns `a · self` plus `b` times `self` rotated by a quarter turn.
    #[inline(always)]
    fn rotated(self, a: T, b: T) -> Self {
        Planar::new(self.x * a - self.y * b, self.y * a + self.x * b)
    }
    /// Returns the unit vector along it; the x axis if its length is zero.
    #[inline(always)]
    fn unit(self) -> Self {
        let norm = self.dot(self).sqrt();
        let none = norm.lt(T::new(MIN_LENGTH));
        let inverse = T::ONE / T::select(none, T::ONE, norm);
        Planar::new(
            T::select(none, T::ONE, self.x * inverse),
            T::select(none, T::ZERO, self.y * inverse),
        )
    }
    #[inline(always)]
    fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Planar::new(T::select(mask, yes.x, no.x), T::select(mask, yes.y, no.y))
    }
}

/// A string in the plane.
#[derive(Clone, Copy, Debug)]
struct PlanarWrap<T: Real> {
    touches: T::Mask,
    points: [Planar<T>; 2],
    arc_length: T,
}

/// Computes the shortest string between `ends` in the presence of `obstacle`.
#[kernel]
pub fn wrap<T: Real>(ends: [Vec3<T>; 2], obstacle: &Obstacle<T>) -> Wrapped<T> {
    let local = |point: Vec3<T>| obstacle.axes.transpose_mul(point - obstacle.centre);
    let ends = ends.map(local);
    let side = obstacle.side.map(local);
    let plane = match obstacle.shape {
        WrapShape::Sphere => plane_through(ends),
        WrapShape::Cylinder => [Mat3::IDENTITY.rows[0], Mat3::IDENTITY.rows[1]],
    };
    let project = |v: Vec3<T>| Planar::new(v.dot(plane[0]), v.dot(plane[1]));
    let flat = ends.map(project);
    let radius = obstacle.radius;
    let mut found = wrap_circle(flat, side.map(|side| project(side).unit()), radius);
    if let Some(side) = side {
        let inside = side.norm().lt(radius);
        if inside.any() {
            let through = through(flat, radius);
            found.touches = (inside & through.touches) | (found.touches & !inside);
            for (point, inner) in found.points.iter_mut().zip(through.points) {
                *point = Planar::select(inside, inner, *point);
            }
            found.arc_length = T::select(inside, T::ZERO, found.arc_length);
        }
    }
    let nonzero = |v: Vec3<T>| v.norm().ge(T::new(MIN_LENGTH));
    found.touches &= nonzero(ends[0]) & nonzero(ends[1]);
    let heights = match obstacle.shape {
        WrapShape::Sphere => [T::ZERO; 2],
        WrapShape::Cylinder => heights(ends, flat, &found),
    };
    let rise = heights[1] - heights[0];
    let axis = Mat3::IDENTITY.rows[2];
    let mut points = [Vec3::ZERO; 2];
    for i in 0..2 {
        let point = found.points[i];
        let point = plane[0] * point.x + plane[1] * point.y + axis * heights[i];
        points[i] = obstacle.centre + obstacle.axes * point;
    }
    Wrapped {
        touches: found.touches,
        points,
        length: match obstacle.shape {
            WrapShape::Sphere => found.arc_length,
            WrapShape::Cylinder => (found.arc_length.squared() + rise.squared()).sqrt(),
        },
    }
}

/// Returns two axes of the plane through the origin and both points, the first towards the first point. If all three
/// are collinear, the plane is MuJoCo's choice.
#[inline(always)]
fn plane_through<T: Real>([first, second]: [Vec3<T>; 2]) -> [Vec3<T>; 2] {
    let axis = first.normalize().0;
    let (normal, norm) = first.cross(second).normalize();
    let [x, y, z] = axis.to_array().map(T::abs);
    let along_y = y.gt(x) & y.gt(z);
    let along_z = z.gt(x) & z.gt(y);
    let other = Vec3::select(
        along_y,
        Vec3::from_f64([1.0, 0.0, 1.0]),
        Vec3::select(
            along_z,
            Vec3::from_f64([1.0, 1.0, 0.0]),
            Vec3::from_f64([0.0, 1.0, 1.0]),
        ),
    );
    let on_line = norm.lt(T::new(MIN_LENGTH));
    let normal = Vec3::select(on_line, axis.cross(other).normalize().0, normal);
    [axis, normal.cross(axis).normalize().0]
}

/// Computes the shortest string around the circle, in the direction of `side`.
#[inline(always)]
fn wrap_circle<T: Real>(ends: [Planar<T>; 2], side: Option<Planar<T>>, radius: T) -> PlanarWrap<T> {
    let [first, second] = ends;
    let angle_between = match side {
        None => first.angle_to(second),
        Some(side) => first.angle_to(side) + side.angle_to(second),
    };
    let sign = T::select(angle_between.ge(T::ZERO), T::ONE, -T::ONE);
    let squared_radius = radius * radius;
    let squared = ends.map(|end| end.dot(end));
    let tangents = squared.map(|r2| (r2 - squared_radius).max(T::ZERO).sqrt());
    let arc = angle_between.abs() - tangents[0].atan2(radius) - tangents[1].atan2(radius);
    let apart = Planar::new(second.x - first.x, second.y - first.y);
    let touches = squared[0].ge(squared_radius)
        & squared[1].ge(squared_radius)
        & radius.ge(T::new(MIN_LENGTH))
        & apart.dot(apart).ge(T::new(MIN_LENGTH))
        & arc.gt(T::ZERO);
    let mut points = ends;
    for (i, sign) in [sign, -sign].into_iter().enumerate() {
        let inverse = T::ONE / T::select(touches, squared[i], T::ONE);
        let across = sign * radius * tangents[i] * inverse;
        points[i] = ends[i].rotated(squared_radius * inverse, across);
    }
    PlanarWrap {
        touches,
        points,
        arc_length: radius * arc,
    }
}

/// Computes the string through the circle, straight if the segment meets it.
#[kernel]
fn through<T: Real>(ends: [Planar<T>; 2], radius: T) -> PlanarWrap<T> {
    let [first, second] = ends;
    let least = T::new(MIN_LENGTH);
    let distances = ends.map(|end| end.dot(end).sqrt());
    let outside = distances[0].gt(radius) & distances[1].gt(radius) & radius.ge(least);
    let touches = outside & !intersects_circle(ends, radius);
    let middle = Planar::new(first.x + second.x, first.y + second.y).unit();
    let ratios = distances.map(|d| radius / T::select(touches, d, T::ONE));
    let ratios = ratios.map(|ratio| T::select(touches, ratio, T::new(0.5)));
    let angle = first.cross(second).abs().atan2(first.dot(second));
    let (incidence, solved) = reflect(ratios, angle);
    // From the end that comes first in the sense of rotation.
    let ascending = first.cross(second).gt(T::ZERO);
    let from = Planar::select(ascending, first, second).unit();
    let ratio = T::select(ascending, ratios[0], ratios[1]);
    let (sine, cosine) = (incidence - asin(ratio * incidence.sin())).sin_cos();
    let point = Planar::select(solved, from.rotated(cosine, sine), middle).rotated(radius, T::ZERO);
    PlanarWrap {
        touches,
        points: [point; 2],
        arc_length: T::ZERO,
    }
}

/// Returns the lanes in which the segment's interior meets the circle.
#[inline(always)]
fn intersects_circle<T: Real>([first, second]: [Planar<T>; 2], radius: T) -> T::Mask {
    let along = Planar::new(second.x - first.x, second.y - first.y);
    let squared = along.dot(along);
    let apart = squared.gt(T::new(MIN_LENGTH));
    let share = -along.dot(first) / T::select(apart, squared, T::ONE);
    let nearest = Planar::new(first.x + along.x * share, first.y + along.y * share);
    let between = share.gt(T::ZERO) & share.lt(T::ONE);
    apart & between & nearest.dot(nearest).sqrt().le(radius)
}

/// Computes f(β) and its slope.
#[inline(always)]
fn rotated_by<T: Real>(ratios: [T; 2], angle: T, beta: T) -> (T, T) {
    let (two, least) = (T::new(2.0), T::new(MIN_LENGTH));
    let (sine, cosine) = beta.sin_cos();
    let (mut value, mut slope) = (T::ZERO, T::ZERO);
    for ratio in ratios {
        let a = ratio * sine;
        value += asin(a);
        slope += ratio * cosine / (T::ONE - a * a).max(least).sqrt();
    }
    (value - two * beta + angle, slope - two)
}

/// Computes β and the lanes in which it was found. Lanes stop individually.
#[inline(always)]
fn reflect<T: Real>(ratios: [T; 2], angle: T) -> (T, T::Mask) {
    let rounding = T::splat(T::Scalar::EPSILON) * T::new(TOLERANCE_ROUNDINGS);
    let tolerance = T::new(TOLERANCE).max(rounding);
    let least = T::new(MIN_LENGTH);
    let mut beta = T::new(std::f64::consts::FRAC_PI_2);
    let (mut value, mut slope) = rotated_by(ratios, angle, beta);
    let mut failed = value.gt(T::ZERO) | angle.lt(least);
    let mut busy = !failed & value.abs().gt(tolerance);
    for _ in 0..MAX_ITERATIONS {
        if !busy.any() {
            break;
        }
        let next = T::select(busy, beta - value / slope, beta);
        failed |= busy & next.gt(beta);
        beta = next;
        let (new_value, new_slope) = rotated_by(ratios, angle, beta);
        value = T::select(busy, new_value, value);
        slope = T::select(busy, new_slope, slope);
        busy &= !failed & value.abs().gt(tolerance);
    }
    (beta, !(failed | busy))
}

/// Returns the arc sine of a number in [−1, 1].
#[inline(always)]
fn asin<T: Real>(x: T) -> T {
    x.atan2((T::ONE - x * x).max(T::ZERO).sqrt())
}

/// Returns the heights along a cylinder's axis at which the string meets and leaves the surface.
#[inline(always)]
fn heights<T: Real>(ends: [Vec3<T>; 2], flat: [Planar<T>; 2], found: &PlanarWrap<T>) -> [T; 2] {
    let distance = |i: usize| {
        let apart = Planar::new(found.points[i].x - flat[i].x, found.points[i].y - flat[i].y);
        apart.dot(apart).sqrt()
    };
    let before = distance(0);
    let until = before + found.arc_length;
    let total = until + distance(1);
    let long = found.touches & total.gt(T::ZERO);
    let slope = (ends[1].z - ends[0].z) / T::select(long, total, T::ONE);
    [ends[0].z + slope * before, ends[0].z + slope * until]
}
