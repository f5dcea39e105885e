//! Three-dimensional vectors.

use crate::kernel;
use crate::real::{Double, Real, Scalar};
use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

/// A vector in space; its unit depends on the context.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<T> {
    /// First coordinate.
    pub x: T,
    /// Second coordinate.
    pub y: T,
    /// Third coordinate.
    pub z: T,
}

impl<T: Real> Vec3<T> {
    /// The zero vector.
    pub const ZERO: Self = Vec3::new(T::ZERO, T::ZERO, T::ZERO);

    /// Creates a vector from its coordinates.
    #[inline(always)]
    pub const fn new(x: T, y: T, z: T) -> Self {
        Vec3 { x, y, z }
    }
    /// Creates the same constant vector in every lane.
    #[inline(always)]
    pub fn from_f64(v: [f64; 3]) -> Self {
        Vec3::new(T::new(v[0]), T::new(v[1]), T::new(v[2]))
    }
    /// Creates the same vector in every lane.
    #[inline(always)]
    pub fn splat(v: Vec3<T::Scalar>) -> Self {
        Vec3::new(T::splat(v.x), T::splat(v.y), T::splat(v.z))
    }
    /// Returns the vector of lane `i`.
    #[inline(always)]
    pub fn lane(self, i: usize) -> Vec3<T::Scalar> {
        Vec3::new(self.x.lane(i), self.y.lane(i), self.z.lane(i))
    }
    /// Returns the vector of lane `i` in double precision.
    #[inline(always)]
    pub fn lane_in_double(self, i: usize) -> Vec3<Double<T>> {
        let [x, y, z] = [self.x, self.y, self.z].map(|x| x.lane_in_double(i));
        Vec3::new(x, y, z)
    }
    /// Creates a vector from an array.
    #[inline(always)]
    pub fn from_array(v: [T; 3]) -> Self {
        Vec3::new(v[0], v[1], v[2])
    }
    /// Returns the coordinates as an array.
    #[inline(always)]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }
    /// Reads the first three numbers of a slice.
    #[inline(always)]
    pub fn from_slice(v: &[T]) -> Self {
        Vec3::new(v[0], v[1], v[2])
    }
    /// Writes the first three numbers of a slice.
    #[inline(always)]
    pub fn write(self, out: &mut [T]) {
        out[..3].copy_from_slice(&self.to_array());
    }
    /// Computes the inner product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    /// Computes the vector product.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Vec3::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }
    /// Computes the product coordinate by coordinate.
    #[inline(always)]
    pub fn scale_by(self, o: Self) -> Self {
        Vec3::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }
    /// Computes the squared length.
    #[inline(always)]
    pub fn norm_squared(self) -> T {
        self.dot(self)
    }
    /// Computes the length.
    #[inline(always)]
    pub fn norm(self) -> T {
        self.norm_squared().sqrt()
    }
    /// Selects coordinate by coordinate: `yes` where the mask is true, else `no`.
    #[inline(always)]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Vec3::new(
            T::select(mask, yes.x, no.x),
            T::select(mask, yes.y, no.y),
            T::select(mask, yes.z, no.z),
        )
    }
    /// Returns a unit vector perpendicular to the unit vector `self`: the coordinate axis on which `self` is smallest
    /// (the first of equals), minus its part along `self`.
    #[kernel]
    pub fn any_perpendicular(self) -> Self {
        let (x, y, z) = (self.x.abs(), self.y.abs(), self.z.abs());
        let (o, i) = (T::ZERO, T::ONE);
        let (unit_x, unit_y, unit_z) = (Vec3::new(i, o, o), Vec3::new(o, i, o), Vec3::new(o, o, i));
        let y_or_z = Vec3::select(y.le(z), unit_y, unit_z);
        let axis = Vec3::select(x.le(y) & x.le(z), unit_x, y_or_z);
        (axis - self * self.dot(axis)).normalize().0
    }
    /// Returns the unit vector along `self` and the length; the x axis if the length is below 1e-15 (MuJoCo's
    /// `mjMINVAL`).
    #[inline(always)]
    pub fn normalize(self) -> (Self, T) {
        let norm = self.norm();
        let tiny = norm.lt(T::new(1e-15));
        let inverse = T::ONE / T::select(tiny, T::ONE, norm);
        let unit = Vec3::new(T::ONE, T::ZERO, T::ZERO);
        (Vec3::select(tiny, unit, self * inverse), norm)
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Vec3::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}
impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Vec3::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
impl<T: Real> Mul<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        Vec3::new(self.x * s, self.y * s, self.z * s)
    }
}
impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Vec3::new(-self.x, -self.y, -self.z)
    }
}
impl<T: Real> AddAssign for Vec3<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<T: Real> SubAssign for Vec3<T> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
impl<T> Index<usize> for Vec3<T> {
    type Output = T;
    #[inline(always)]
    fn index(&self, i: usize) -> &T {
        match i {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a Vec3 has no coordinate {i}"),
        }
    }
}
impl<T> IndexMut<usize> for Vec3<T> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut T {
        match i {
            0 => &mut self.x,
            1 => &mut self.y,
            2 => &mut self.z,
            _ => panic!("a Vec3 has no coordinate {i}"),
        }
    }
}

impl<S: Scalar> Vec3<S> {
    /// Rounds a vector in double precision.
    #[inline(always)]
    pub fn from_double(v: Vec3<S::Double>) -> Self {
        Vec3::from_array(v.to_array().map(S::from_double))
    }
}
