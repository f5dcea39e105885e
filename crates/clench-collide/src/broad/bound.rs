//! Bounding sphere and bounding box of a shape.

use crate::pose::Pose;
use crate::shape::{Shape, Solid};
use clench_math::{Mask, Real, Scalar, Vec3};

/// Returns the factor, slightly more than 1, that enlarges bounding radii and margins. It keeps rounding from rejecting
/// a pair with contacts: the result of an environment must not depend on the other lanes.
#[inline(always)]
pub fn allowance<T: Real>() -> T {
    T::ONE + T::new(1e-6).max(T::splat(T::Scalar::EPSILON) * T::new(64.0))
}

/// A bounding sphere and box of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound<T> {
    /// The shape's origin in the world, m.
    pub center: Vec3<T>,
    /// The radius of a sphere about the centre that encloses the shape, m; infinite for a plane.
    pub radius: T,
    /// The half lengths of an axis-aligned box about the centre that encloses the shape, m; infinite for a plane.
    pub half: Vec3<T>,
    /// The normal, if the shape is a plane.
    pub plane: Option<Vec3<T>>,
}

impl<T: Real> Bound<T> {
    /// Computes the bound of a shape, enlarged by the [`allowance`].
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

/// Returns the extent of a shape from its origin along each coordinate axis.
#[inline(always)]
fn half_lengths<T: Real>(shape: &Shape<T>, pose: &Pose<T>) -> Vec3<T> {
    let [x, y, z] = pose.rotation.rows.map(|axis| shape.reach_along(axis));
    Vec3::new(x, y, z)
}

/// Returns the environments in which two shapes may be within `margin` metres of each other. Two planes never are.
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
