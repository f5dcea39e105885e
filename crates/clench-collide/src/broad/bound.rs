//! A ball and a box about a shape.

use crate::shape::Solid;
use crate::{Pose, Shape};
use clench_math::{Mask, Real, Scalar, Vec3};

/// By how much bounding radii and margins are enlarged, a hair more than 1, so that rounding never rejects a pair in which the
/// narrow phase would find a point: what an environment gets must not depend on its neighbours in the lanes.
#[inline(always)]
pub fn allowance<T: Real>() -> T {
    T::ONE + T::new(1e-6).max(T::splat(T::Scalar::EPSILON) * T::new(64.0))
}

/// A ball and a box that hold a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound<T> {
    /// The shape's origin in the world, m.
    pub center: Vec3<T>,
    /// Radius of a ball about the centre that holds the shape, m; infinite for a plane.
    pub radius: T,
    /// Half lengths of a box about the centre, along the coordinate axes, that holds the shape, m; infinite for a plane.
    pub half: Vec3<T>,
    /// The normal of a plane.
    pub plane: Option<Vec3<T>>,
}

impl<T: Real> Bound<T> {
    /// The bound of a shape, larger by the [`allowance`].
    #[inline(always)]
    pub fn new(shape: &Shape<T>, pose: &Pose<T>) -> Self {
        Bound {
            center: pose.position,
            radius: shape.bounding_radius() * allowance(),
            half: half_lengths(shape, pose) * allowance(),
            plane: matches!(shape, Shape::Plane(_)).then(|| pose.axis()),
        }
    }
}

/// How far a shape reaches from its origin along the coordinate axes.
#[inline(always)]
fn half_lengths<T: Real>(shape: &Shape<T>, pose: &Pose<T>) -> Vec3<T> {
    let [x, y, z] = pose.rotation.rows.map(|axis| shape.reach_along(axis));
    Vec3::new(x, y, z)
}

/// In which environments two shapes are near enough that they may be within `margin` metres of each other. Two planes
/// never are.
#[inline(always)]
pub fn near<T: Real>(a: &Bound<T>, b: &Bound<T>, margin: T) -> T::Mask {
    let offset = b.center - a.center;
    let margin = margin * allowance();
    match (a.plane, b.plane) {
        (None, None) => {
            let reach = a.radius + b.radius + margin;
            let apart = |axis: usize| offset[axis].abs().le(a.half[axis] + b.half[axis] + margin);
            offset.norm_squared().le(reach * reach) & apart(0) & apart(1) & apart(2)
        }
        (Some(normal), None) => normal.dot(offset).le(b.radius + margin),
        (None, Some(normal)) => (-normal.dot(offset)).le(a.radius + margin),
        (Some(_), Some(_)) => T::Mask::splat(false),
    }
}
