//! Unit quaternions as rotations, in MuJoCo's order (w, x, y, z).

use crate::{Mat3, Real, Vec3, kernel};
use std::ops::Mul;

/// The length below which a vector has no axis.
const TINY: f64 = 1e-15;

/// A quaternion. As a rotation it maps local coordinates to the outer frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quat<T> {
    /// Real part.
    pub w: T,
    /// First imaginary part.
    pub x: T,
    /// Second imaginary part.
    pub y: T,
    /// Third imaginary part.
    pub z: T,
}

impl<T: Real> Default for Quat<T> {
    #[inline(always)]
    fn default() -> Self {
        Quat::IDENTITY
    }
}

impl<T: Real> Quat<T> {
    /// The identity rotation.
    pub const IDENTITY: Self = Quat::new(T::ONE, T::ZERO, T::ZERO, T::ZERO);

    /// Creates a quaternion from its four parts.
    #[inline(always)]
    pub const fn new(w: T, x: T, y: T, z: T) -> Self {
        Quat { w, x, y, z }
    }
    /// Creates the same constant in every lane, (w, x, y, z).
    #[inline(always)]
    pub fn from_f64(q: [f64; 4]) -> Self {
        Quat::new(T::new(q[0]), T::new(q[1]), T::new(q[2]), T::new(q[3]))
    }
    /// Creates the same quaternion in every lane.
    #[inline(always)]
    pub fn splat(q: Quat<T::Scalar>) -> Self {
        Quat::new(T::splat(q.w), T::splat(q.x), T::splat(q.y), T::splat(q.z))
    }
    /// Returns the quaternion of lane `i`.
    #[inline(always)]
    pub fn lane(self, i: usize) -> Quat<T::Scalar> {
        Quat::new(
            self.w.lane(i),
            self.x.lane(i),
            self.y.lane(i),
            self.z.lane(i),
        )
    }
    /// Reads the first four numbers of a slice.
    #[inline(always)]
    pub fn from_slice(q: &[T]) -> Self {
        Quat::new(q[0], q[1], q[2], q[3])
    }
    /// Returns the array (w, x, y, z).
    #[inline(always)]
    pub fn to_array(self) -> [T; 4] {
        [self.w, self.x, self.y, self.z]
    }
    /// Writes the first four numbers of a slice.
    #[inline(always)]
    pub fn write(self, out: &mut [T]) {
        out[..4].copy_from_slice(&self.to_array());
    }
    /// Returns the imaginary part.
    #[inline(always)]
    pub fn imaginary(self) -> Vec3<T> {
        Vec3::new(self.x, self.y, self.z)
    }
    /// Creates the rotation by `angle` radians about a unit axis.
    #[inline(always)]
    pub fn from_axis_angle(axis: Vec3<T>, angle: T) -> Self {
        let (s, c) = (angle * T::new(0.5)).sin_cos();
        Quat::new(c, axis.x * s, axis.y * s, axis.z * s)
    }
    /// Computes the unit quaternion of a rotation matrix (columns: the local axes).
    ///
    /// The matrix gives four rows of 4 q qᵀ, each a multiple of q. The row of `w` is used if the trace is positive,
    /// else that of the largest imaginary part, whose sign is then positive (MuJoCo's `mju_mat2Quat`).
    #[kernel]
    pub fn from_matrix(m: &Mat3<T>) -> Self {
        let [a, b, c] = m.rows;
        let one = T::ONE;
        let (wx, wy, wz) = (c.y - b.z, a.z - c.x, b.x - a.y);
        let (xy, xz, yz) = (a.y + b.x, a.z + c.x, b.z + c.y);
        let trace = a.x + b.y + c.z;
        let from_w = Quat::new(one + trace, wx, wy, wz);
        let from_x = Quat::new(wx, one + a.x - b.y - c.z, xy, xz);
        let from_y = Quat::new(wy, xy, one - a.x + b.y - c.z, yz);
        let from_z = Quat::new(wz, xz, yz, one - a.x - b.y + c.z);
        let y_or_z = Quat::select(b.y.gt(c.z), from_y, from_z);
        let imaginary = Quat::select(a.x.gt(b.y) & a.x.gt(c.z), from_x, y_or_z);
        Quat::select(trace.gt(T::ZERO), from_w, imaginary).normalize()
    }
    /// Computes the shortest rotation from the unit vector `from` to the unit vector `to`.
    ///
    /// For opposite vectors the axis is the coordinate axis on which `from` is smallest, made perpendicular to `from`;
    /// for `from` = z it is x.
    #[kernel]
    pub fn from_two_vectors(from: Vec3<T>, to: Vec3<T>) -> Self {
        let half = T::new(0.5);
        let (cosine, sine) = ((from + to).norm() * half, (to - from).norm() * half);
        let (axis, length) = from.cross(to).normalize();
        let axis = Vec3::select(length.lt(T::new(1e-10)), from.any_perpendicular(), axis);
        Quat::new(cosine, axis.x * sine, axis.y * sine, axis.z * sine).normalize()
    }
    /// Returns the inverse rotation.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Quat::new(self.w, -self.x, -self.y, -self.z)
    }
    /// Scales to unit length. Returns the identity if the length is below 1e-15.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let norm = (self.w * self.w + self.x * self.x + self.y * self.y + self.z * self.z).sqrt();
        let tiny = norm.lt(T::new(1e-15));
        let inverse = T::ONE / T::select(tiny, T::ONE, norm);
        let unit = Quat::new(
            self.w * inverse,
            self.x * inverse,
            self.y * inverse,
            self.z * inverse,
        );
        Quat::select(tiny, Quat::IDENTITY, unit)
    }
    /// Selects part by part: `yes` where the mask is true, else `no`.
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Quat::new(
            T::select(mask, yes.w, no.w),
            T::select(mask, yes.x, no.x),
            T::select(mask, yes.y, no.y),
            T::select(mask, yes.z, no.z),
        )
    }
    /// Rotates a vector to the outer frame.
    #[inline(always)]
    pub fn rotate(self, v: Vec3<T>) -> Vec3<T> {
        let u = self.imaginary();
        let t = u.cross(v) * T::new(2.0);
        v + t * self.w + u.cross(t)
    }
    /// Returns the rotation matrix of a unit quaternion.
    #[inline(always)]
    pub fn to_matrix(self) -> Mat3<T> {
        let two = T::new(2.0);
        let (w, x, y, z) = (self.w, self.x, self.y, self.z);
        let one = T::ONE;
        Mat3::from_rows(
            Vec3::new(
                one - two * (y * y + z * z),
                two * (x * y - w * z),
                two * (x * z + w * y),
            ),
            Vec3::new(
                two * (x * y + w * z),
                one - two * (x * x + z * z),
                two * (y * z - w * x),
            ),
            Vec3::new(
                two * (x * z - w * y),
                two * (y * z + w * x),
                one - two * (x * x + y * y),
            ),
        )
    }
    /// Returns the rotation vector: axis times angle, with the angle in (−π, π].
    #[inline(always)]
    pub fn to_rotation_vector(self) -> Vec3<T> {
        let (axis, sine) = self.imaginary().normalize();
        let mut angle = T::new(2.0) * sine.atan2(self.w);
        let pi = T::new(std::f64::consts::PI);
        angle = T::select(angle.gt(pi), angle - pi - pi, angle);
        let vector = axis * angle;
        if T::IS_DUAL {
            // Without an axis the vector is ±2 times the imaginary part, which has derivatives.
            let small = self.imaginary() * T::new(2.0).copysign(self.w);
            return Vec3::select(sine.lt(T::new(TINY)), small, vector);
        }
        vector
    }
    /// Returns the local rotation vector from `other` to `self`: `other · exp(difference) = self` (MuJoCo's
    /// `mju_subQuat`).
    #[inline(always)]
    pub fn difference(self, other: Self) -> Vec3<T> {
        (other.conjugate() * self).to_rotation_vector()
    }
    /// Creates the rotation of a rotation vector (axis times angle, rad).
    #[inline(always)]
    pub fn from_rotation_vector(v: Vec3<T>) -> Self {
        let (axis, angle) = v.normalize();
        let rotation = Quat::from_axis_angle(axis, angle);
        if T::IS_DUAL {
            // Without an axis the imaginary part is half the vector, which has derivatives.
            let half = v * T::new(0.5);
            let small = Quat::new(T::ONE, half.x, half.y, half.z);
            return Quat::select(angle.lt(T::new(TINY)), small, rotation);
        }
        rotation
    }
    /// Integrates a constant local angular velocity (rad/s) from `self` for `time` seconds.
    #[inline(always)]
    pub fn integrate(self, angular_velocity: Vec3<T>, time: T) -> Self {
        let (axis, speed) = angular_velocity.normalize();
        if T::IS_DUAL {
            let rotation = Quat::from_rotation_vector(angular_velocity * time);
            return (self * rotation).normalize();
        }
        (self * Quat::from_axis_angle(axis, speed * time)).normalize()
    }
}

impl<T: Real> Mul for Quat<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Quat::new(
            self.w * o.w - self.x * o.x - self.y * o.y - self.z * o.z,
            self.w * o.x + self.x * o.w + self.y * o.z - self.z * o.y,
            self.w * o.y - self.x * o.z + self.y * o.w + self.z * o.x,
            self.w * o.z + self.x * o.y - self.y * o.x + self.z * o.w,
        )
    }
}
