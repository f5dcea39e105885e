//! Contact frames: a normal and two tangents.
//!
//! The choice of tangents affects the result: the edges of a friction pyramid lie along them. It follows MuJoCo
//! (`mju_makeFrame`).

use clench_math::{Mask, Mat3, Real, Scalar, Vec3};

/// Computes the contact frame whose first tangent is the y axis made orthogonal to the unit `normal`, or the z axis if
/// the normal is within 60° of the y axis. Rows: normal, tangents.
#[inline(always)]
pub fn frame_from_normal<T: Real>(normal: Vec3<T>) -> Mat3<T> {
    let (n, zero, one) = (normal, T::ZERO, T::ONE);
    let use_y = n.y.abs().lt(T::new(0.5));
    let start = Vec3::select(
        use_y,
        Vec3::new(zero, one, zero),
        Vec3::new(zero, zero, one),
    );
    // The chosen axis is at least 30° away from the normal, so the division is safe.
    let tangent = start - n * T::select(use_y, n.y, n.z);
    let tangent = tangent * (one / tangent.norm());
    Mat3::from_rows(n, tangent, n.cross(tangent))
}

/// Computes the contact frame whose first tangent is the unit vector `direction` made orthogonal to the unit `normal`.
///
/// If the two are parallel, the first tangent is the x axis made orthogonal to the normal, or the y axis if the normal
/// is near the x axis. (MuJoCo uses the x axis itself, which is the same for a horizontal floor.)
#[inline(always)]
pub fn frame_along<T: Real>(normal: Vec3<T>, direction: Vec3<T>) -> Mat3<T> {
    // Below this length the remainder of the direction is mostly rounding error.
    let least = T::splat(T::Scalar::EPSILON * T::Scalar::new(1e4));
    let mut tangent = across(normal, direction);
    let parallel = tangent.norm_squared().lt(least * least);
    if parallel.any() {
        let near_x = normal.x.abs().gt(T::new(0.9));
        let x = Vec3::new(T::ONE, T::ZERO, T::ZERO);
        let y = Vec3::new(T::ZERO, T::ONE, T::ZERO);
        tangent = Vec3::select(
            parallel,
            across(normal, Vec3::select(near_x, y, x)),
            tangent,
        );
    }
    let tangent = tangent * (T::ONE / tangent.norm());
    Mat3::from_rows(normal, tangent, normal.cross(tangent))
}

/// Returns the component of `v` orthogonal to the unit `normal`.
#[inline(always)]
fn across<T: Real>(normal: Vec3<T>, v: Vec3<T>) -> Vec3<T> {
    v - normal * normal.dot(v)
}
