//! Contact frames: a normal, completed by two tangents.
//!
//! Which tangents matters: a friction pyramid has its edges along them. The choice is MuJoCo's (`mju_makeFrame`).

use clench_math::{Mat3, Real, Vec3};

/// The frame of a contact whose first tangent is the y axis made orthogonal to the unit `normal`, or the z axis where
/// the normal is within 60° of the y axis. Rows: normal, tangents.
#[inline]
pub fn frame_from_normal<T: Real>(normal: Vec3<T>) -> Mat3<T> {
    let half = T::new(0.5);
    let y = Vec3::new(T::ZERO, T::ONE, T::ZERO);
    let z = Vec3::new(T::ZERO, T::ZERO, T::ONE);
    frame_along(normal, Vec3::select(normal.y.abs().lt(half), y, z))
}

/// The frame of a contact whose first tangent is the unit vector `direction` made orthogonal to the unit `normal`.
#[inline]
pub fn frame_along<T: Real>(normal: Vec3<T>, direction: Vec3<T>) -> Mat3<T> {
    let (tangent, _) = (direction - normal * normal.dot(direction)).normalize();
    Mat3::from_rows(normal, tangent, normal.cross(tangent))
}
