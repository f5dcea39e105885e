//! How far one convex shape juts out of another.
//!
//! With the support function h(u) of a body, how far it reaches along the unit direction u, the body A juts out of B by
//!
//! ```text
//! max over unit u of  f(u) = h_A(u) − h_B(u).
//! ```
//!
//! Where that is positive it is the directed Hausdorff distance, how far the point of A that is furthest from B is away from it. Where A lies
//! inside B it is less the clearance between the surface of A and that of B. The gradient of f is the difference of the two points that reach
//! furthest along u.
//!
//! f is a difference of convex functions and can have several maxima. MuJoCo 4.0 climbs from the six axes of B and takes the best that it
//! meets within its bounds; so does this, step by step, since its answers are what a file means: bounds that are tight may stop it short.

use crate::{Pose, Shape};
use clench_math::{Mat3, Scalar, Vec3};

/// How far the search for a maximum goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ascent {
    /// Most directions that are tried from each start; at least one is.
    pub iterations: usize,
    /// Slope, as a share of the value, and angle of a step, rad, below which a climb ends.
    pub tolerance: f64,
}

/// The angle of a climb's first steps, rad. Each that leads down halves it.
const FIRST_STEP: f64 = 0.5;
/// Vectors shorter than this have no direction.
const LEAST: f64 = 1e-15;
/// The same of the square of a length.
const LEAST_SQUARED: f64 = LEAST * LEAST;

/// How far `inner` juts out of `outer`, m: negative where it lies inside, by its clearance. Nothing if one of them is not a bounded convex
/// shape: a plane, a height field, a mesh without a hull.
///
/// It may fall short of the truth where the search ends early or finds a lower one of several maxima, and never exceeds it.
///
/// ```
/// use clench_collide::{Ascent, Pose, Shape, ShapeKind, protrusion};
/// use clench_math::Vec3;
///
/// let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.1, 0.0, 0.0));
/// let crate_ = Shape::new(ShapeKind::Box, Vec3::new(0.5, 0.5, 0.5));
/// let aside = |x| Pose { position: Vec3::new(x, 0.0, 0.0), ..Pose::IDENTITY };
/// let out = |x| {
///     let search = Ascent { iterations: 35, tolerance: 1e-6 };
///     protrusion(&ball, &aside(x), &crate_, &Pose::IDENTITY, search).expect("both are bounded")
/// };
///
/// assert!((out(0.45) - 0.05_f64).abs() < 1e-12);
/// assert!((out(0.3) + 0.1).abs() < 1e-12);
/// ```
pub fn protrusion<S: Scalar>(
    inner: &Shape<S>,
    pose_inner: &Pose<S>,
    outer: &Shape<S>,
    pose_outer: &Pose<S>,
    search: Ascent,
) -> Option<S> {
    let place = turned(pose_inner, pose_outer);
    let furthest = |u| place.point(furthest(inner, place.rotation.transpose_mul(u)));
    is_bounded(inner).then(|| highest(furthest, outer, pose_outer, search))?
}

/// The same of points in place of a shape, in whose coordinates they are: how far the one that is furthest out juts out. Nothing without
/// points.
pub fn protrusion_of_points<S: Scalar>(
    points: &[Vec3<f64>],
    pose_points: &Pose<S>,
    outer: &Shape<S>,
    pose_outer: &Pose<S>,
    search: Ascent,
) -> Option<S> {
    let place = turned(pose_points, pose_outer);
    let furthest = |u| {
        let d = place.rotation.transpose_mul(u);
        let local = points.iter().map(|p| Vec3::from_f64(p.to_array()));
        let best = local.reduce(|best, p| if p.dot(d) > best.dot(d) { p } else { best });
        place.point(best.unwrap_or(Vec3::ZERO))
    };
    (!points.is_empty()).then(|| highest(furthest, outer, pose_outer, search))?
}

/// The first pose in coordinates of the world turned as the second is.
///
/// The climbs start along the axes of the outer shape, where whole edges and faces of boxes, cylinders and capsules are furthest. So turned
/// these axes are exact, and rounding does not choose among the corners, as it does in MuJoCo where the shape itself is turned.
fn turned<S: Scalar>(pose: &Pose<S>, by: &Pose<S>) -> Pose<S> {
    let columns = [0, 1, 2].map(|i| by.rotation.transpose_mul(pose.rotation.column(i)));
    Pose {
        position: by.rotation.transpose_mul(pose.position),
        rotation: Mat3 { rows: columns }.transpose(),
    }
}

/// The largest value of f that climbs from the six axes of a shape meet, with the points of the other that are furthest along directions, all
/// in the world turned as that shape.
fn highest<S: Scalar>(
    furthest_of_inner: impl Fn(Vec3<S>) -> Vec3<S>,
    outer: &Shape<S>,
    pose_outer: &Pose<S>,
    search: Ascent,
) -> Option<S> {
    if !is_bounded(outer) {
        return None;
    }
    let center = pose_outer.rotation.transpose_mul(pose_outer.position);
    let offset = |u: Vec3<S>| furthest_of_inner(u) - (furthest(outer, u) + center);
    let mut best = -S::INFINITY;
    for axis in 0..3 {
        let mut start = Vec3::ZERO;
        start[axis] = S::ONE;
        for start in [start, -start] {
            best = best.max(climb(offset, start, search));
        }
    }
    Some(best)
}

/// Whether a shape is a bounded convex body that [`protrusion`] can tell of.
fn is_bounded<S: Scalar>(shape: &Shape<S>) -> bool {
    match shape {
        Shape::Plane(_) | Shape::HeightField(_) => false,
        Shape::Mesh(mesh) => mesh.hull.is_some(),
        _ => true,
    }
}

/// The largest value of f that a climb on the unit sphere meets, with the gradient of f in `offset`.
///
/// While steps lead up they follow the slope. One that does not is taken back, and a shorter one follows the sum of the slope beyond and
/// the last direction, which leads along a ridge of f where the slope alone would cross it to and fro.
fn climb<S: Scalar>(offset: impl Fn(Vec3<S>) -> Vec3<S>, start: Vec3<S>, search: Ascent) -> S {
    let (least, tolerance) = (S::new(LEAST), S::new(search.tolerance));
    let mut best = -S::INFINITY;
    let (mut summit, mut along) = (start, Vec3::ZERO);
    let (mut u, mut step) = (start, S::new(FIRST_STEP));
    for _ in 0..search.iterations.max(1) {
        let gradient = offset(u);
        let value = gradient.dot(u);
        let slope = gradient - u * value;
        let steepness = slope.norm();
        if value > best {
            (best, summit) = (value, u);
            if steepness <= least || steepness <= value.abs() * tolerance {
                break;
            }
            along = slope * (S::ONE / steepness);
        } else {
            step *= S::new(0.5);
            if step < tolerance {
                break;
            }
            if steepness > least {
                along += slope * (S::ONE / steepness);
            }
            along -= summit * along.dot(summit);
            let length = along.norm();
            if length <= tolerance {
                break;
            }
            along = along * (S::ONE / length);
        }
        let next = summit + along * step;
        if next == summit {
            break; // The step is less than rounding.
        }
        u = next * (S::ONE / next.norm());
    }
    best
}

/// The point of a shape that is furthest along a unit direction, both in its own coordinates. Of several it is the one that MuJoCo takes.
fn furthest<S: Scalar>(shape: &Shape<S>, d: Vec3<S>) -> Vec3<S> {
    let toward = |half: S, along: S| if along >= S::ZERO { half } else { -half };
    match shape {
        Shape::Plane(_) | Shape::HeightField(_) => Vec3::ZERO,
        Shape::Sphere(sphere) => d * sphere.radius,
        Shape::Capsule(capsule) => {
            let end = Vec3::new(S::ZERO, S::ZERO, toward(capsule.half_length, d.z));
            d * capsule.radius + end
        }
        Shape::Ellipsoid(ellipsoid) => {
            let size = ellipsoid.semi_axes;
            let scaled = d.scale_by(size);
            if scaled.norm_squared() < S::new(LEAST_SQUARED) {
                Vec3::new(size.x, S::ZERO, S::ZERO)
            } else {
                scaled.scale_by(size * (S::ONE / scaled.norm()))
            }
        }
        Shape::Cylinder(cylinder) => {
            let across = d.x * d.x + d.y * d.y;
            let share = match across >= S::new(LEAST_SQUARED) {
                true => cylinder.radius / across.sqrt(),
                false => S::ZERO,
            };
            Vec3::new(d.x * share, d.y * share, toward(cylinder.half_length, d.z))
        }
        Shape::Box(cuboid) => {
            let h = cuboid.half_lengths;
            Vec3::new(toward(h.x, d.x), toward(h.y, d.y), toward(h.z, d.z))
        }
        Shape::Mesh(mesh) => mesh.hull.map_or(Vec3::ZERO, |hull| {
            let vertex = hull.support(Vec3::from_array(d.to_array().map(S::to_f64)));
            Vec3::from_f64(hull.vertices()[vertex].to_array())
        }),
    }
}
