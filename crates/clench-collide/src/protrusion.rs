//! The distance by which one convex shape protrudes from another.
//!
//! With the support function h(u) of a body, its extent along the unit direction u, the body A protrudes from B by
//!
//! ```text
//! max over unit u of  f(u) = h_A(u) − h_B(u).
//! ```
//!
//! If positive, it is the directed Hausdorff distance: that of B to the furthest point of A. If A lies inside B, it is
//! minus the clearance between the surfaces. The gradient of f is the difference of the two support points along u.
//!
//! f is a difference of convex functions and can have several maxima. MuJoCo 4.0 climbs from the six axes of B and
//! returns the best value found within its limits. This code repeats it step by step, since models rely on its values:
//! tight limits may stop it early.

use crate::pose::Pose;
use crate::shape::Shape;
use clench_math::{Mat3, Scalar, Vec3};

/// The limits of the search for a maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ascent {
    /// The maximum number of directions tried from each start; at least one is tried.
    pub iterations: usize,
    /// The tolerance that ends a climb: for the slope, relative to the value, and for a step's angle, rad.
    pub tolerance: f64,
}

/// The angle of a climb's first steps, rad. Each step that decreases the value halves it.
pub(crate) const FIRST_STEP: f64 = 0.5;
/// The minimum length of a vector that has a direction.
const LEAST: f64 = 1e-15;
/// The square of `LEAST`.
const LEAST_SQUARED: f64 = LEAST * LEAST;

/// Computes the distance by which `inner` protrudes from `outer`, m; minus its clearance if it lies inside. Returns
/// `None` unless both are bounded convex shapes: not a plane, a height field, or a mesh without a hull.
///
/// The result never exceeds the true value. It is smaller if the search ends early or finds a lower local maximum.
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
    let pose = rotated(pose_inner, pose_outer);
    let furthest = |u| pose.point(furthest(inner, pose.rotation.transpose_mul(u)));
    is_bounded(inner).then(|| highest(furthest, outer, pose_outer, search))?
}

/// Computes the same for points in the coordinates of `pose_points`: the protrusion of the outermost. Returns `None`
/// without points.
pub fn protrusion_of_points<S: Scalar>(
    points: &[Vec3<f64>],
    pose_points: &Pose<S>,
    outer: &Shape<S>,
    pose_outer: &Pose<S>,
    search: Ascent,
) -> Option<S> {
    let pose = rotated(pose_points, pose_outer);
    let furthest = |u| {
        let d = pose.rotation.transpose_mul(u);
        let local = points.iter().map(|p| Vec3::from_f64(p.to_array()));
        let best = local.reduce(|best, p| if p.dot(d) > best.dot(d) { p } else { best });
        pose.point(best.unwrap_or(Vec3::ZERO))
    };
    (!points.is_empty()).then(|| highest(furthest, outer, pose_outer, search))?
}

/// Returns the first pose in world coordinates rotated to the axes of the second.
///
/// The climbs start along the axes of the outer shape, where whole edges and faces of boxes, cylinders and capsules are
/// furthest. In the rotated coordinates these axes are exact, so rounding does not choose among the corners, as it does
/// in MuJoCo, which rotates the shape itself.
fn rotated<S: Scalar>(pose: &Pose<S>, by: &Pose<S>) -> Pose<S> {
    let columns = [0, 1, 2].map(|i| by.rotation.transpose_mul(pose.rotation.column(i)));
    Pose {
        position: by.rotation.transpose_mul(pose.position),
        rotation: Mat3 { rows: columns }.transpose(),
    }
}

/// Returns the largest value of f found by climbing from the six axes of `outer`, given the support points of the inner
/// shape, all in world coordinates rotated to the axes of `outer`.
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

/// Returns true for a bounded convex body.
fn is_bounded<S: Scalar>(shape: &Shape<S>) -> bool {
    match shape {
        Shape::Plane(_) | Shape::HeightField(_) => false,
        Shape::Mesh(mesh) => mesh.hull.is_some(),
        _ => true,
    }
}

/// Returns the largest value of f that a climb on the unit sphere finds; `offset` computes the gradient of f.
///
/// While steps increase f, they follow the slope. A step that does not is reverted, and a shorter one follows the sum
/// of the slope found there and the last direction. This follows a ridge of f, which the slope alone would cross back
/// and forth.
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
            break; // The step is smaller than rounding.
        }
        u = next * (S::ONE / next.norm());
    }
    best
}

/// Returns the point of a shape that is furthest along a unit direction, both in local coordinates. Among several, it
/// returns the one that MuJoCo chooses.
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
