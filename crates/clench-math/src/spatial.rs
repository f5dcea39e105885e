//! Spatial algebra: motion and force vectors and rigid-body inertia about one common point, in world axes.
//!
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapter 2. A motion is an angular velocity and the velocity
//! of the body point at the reference point; a force is the moment about that point and a linear force.

use crate::{Mat3, Quat, Real, Vec3};
use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A spatial motion vector: velocity, acceleration or joint axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<T> {
    /// The angular part, rad/s.
    pub angular: Vec3<T>,
    /// The linear part at the reference point, m/s.
    pub linear: Vec3<T>,
}

/// A spatial force vector.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Force<T> {
    /// The moment about the reference point, N m.
    pub angular: Vec3<T>,
    /// The linear force, N.
    pub linear: Vec3<T>,
}

macro_rules! spatial_vector {
    ($name:ident) => {
        impl<T: Real> $name<T> {
            /// The zero vector.
            pub const ZERO: Self = $name {
                angular: Vec3::ZERO,
                linear: Vec3::ZERO,
            };
            /// Creates a vector from the angular and the linear part.
            #[inline(always)]
            pub const fn new(angular: Vec3<T>, linear: Vec3<T>) -> Self {
                $name { angular, linear }
            }
            /// Returns (angular, linear) as six numbers.
            #[inline(always)]
            pub fn to_array(self) -> [T; 6] {
                let (a, l) = (self.angular, self.linear);
                [a.x, a.y, a.z, l.x, l.y, l.z]
            }
        }
        impl<T: Real> Add for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                $name::new(self.angular + o.angular, self.linear + o.linear)
            }
        }
        impl<T: Real> Sub for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                $name::new(self.angular - o.angular, self.linear - o.linear)
            }
        }
        impl<T: Real> Mul<T> for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, s: T) -> Self {
                $name::new(self.angular * s, self.linear * s)
            }
        }
        impl<T: Real> Neg for $name<T> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                $name::new(-self.angular, -self.linear)
            }
        }
        impl<T: Real> AddAssign for $name<T> {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) {
                *self = *self + o;
            }
        }
        impl<T: Real> SubAssign for $name<T> {
            #[inline(always)]
            fn sub_assign(&mut self, o: Self) {
                *self = *self - o;
            }
        }
    };
}

spatial_vector!(Motion);
spatial_vector!(Force);

impl<T: Real> Motion<T> {
    /// Returns the motion whose component `c` of (angular, linear) is one and whose others are zero.
    #[inline(always)]
    pub fn component(c: usize) -> Self {
        let mut motion = Self::ZERO;
        if c < 3 {
            motion.angular[c] = T::ONE;
        } else {
            motion.linear[c - 3] = T::ONE;
        }
        motion
    }
    /// Computes the power of a force along this motion, W.
    #[inline(always)]
    pub fn dot(self, f: Force<T>) -> T {
        self.angular.dot(f.angular) + self.linear.dot(f.linear)
    }
    /// Computes the rate of change of the motion `m` when it moves with `self` (`self × m`).
    #[inline(always)]
    pub fn cross(self, m: Motion<T>) -> Motion<T> {
        Motion::new(
            self.angular.cross(m.angular),
            self.angular.cross(m.linear) + self.linear.cross(m.angular),
        )
    }
    /// Computes the rate of change of the force `f` when it moves with `self` (`self ×* f`).
    #[inline(always)]
    pub fn cross_force(self, f: Force<T>) -> Force<T> {
        Force::new(
            self.angular.cross(f.angular) + self.linear.cross(f.linear),
            self.angular.cross(f.linear),
        )
    }
    /// Returns the velocity of the point at `offset` from the reference point.
    #[inline(always)]
    pub fn velocity_at(self, offset: Vec3<T>) -> Vec3<T> {
        self.linear + self.angular.cross(offset)
    }
    /// Expresses the motion in a frame at `offset` that is rotated by `rotation`: about its origin, along its axes.
    #[inline(always)]
    pub fn in_frame(self, offset: Vec3<T>, rotation: Quat<T>) -> Self {
        let back = rotation.conjugate();
        Motion::new(
            back.rotate(self.angular),
            back.rotate(self.velocity_at(offset)),
        )
    }
}

/// Rigid-body inertia about a reference point: rotational inertia (symmetric), first moment and mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertia<T> {
    /// The rotational inertia about the reference point: xx, yy, zz, xy, xz, yz, kg m².
    pub rotational: [T; 6],
    /// The mass times the offset of the centre of mass from the reference point, kg m.
    pub moment: Vec3<T>,
    /// The mass, kg.
    pub mass: T,
}

impl<T: Real> Inertia<T> {
    /// The zero inertia.
    pub const ZERO: Self = Inertia {
        rotational: [T::ZERO; 6],
        moment: Vec3::ZERO,
        mass: T::ZERO,
    };

    /// Creates the inertia of a body with principal moments `diagonal` along the columns of `axes`, and its centre of
    /// mass at `offset` from the reference point.
    #[inline(always)]
    pub fn from_principal(diagonal: Vec3<T>, axes: &Mat3<T>, offset: Vec3<T>, mass: T) -> Self {
        let r = &axes.rows;
        let d = diagonal;
        let scaled = [r[0].scale_by(d), r[1].scale_by(d), r[2].scale_by(d)];
        let o = offset;
        Inertia {
            rotational: [
                scaled[0].dot(r[0]) + mass * (o.y * o.y + o.z * o.z),
                scaled[1].dot(r[1]) + mass * (o.x * o.x + o.z * o.z),
                scaled[2].dot(r[2]) + mass * (o.x * o.x + o.y * o.y),
                scaled[0].dot(r[1]) - mass * o.x * o.y,
                scaled[0].dot(r[2]) - mass * o.x * o.z,
                scaled[1].dot(r[2]) - mass * o.y * o.z,
            ],
            moment: o * mass,
            mass,
        }
    }
    /// Multiplies the rotational inertia by a vector.
    #[inline(always)]
    pub fn rotate(&self, v: Vec3<T>) -> Vec3<T> {
        let [xx, yy, zz, xy, xz, yz] = self.rotational;
        Vec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }
}

impl<T: Real> Mul<Motion<T>> for Inertia<T> {
    type Output = Force<T>;
    /// Computes the momentum of the body moving at `m` (or the force that gives it the acceleration `m`).
    #[inline(always)]
    fn mul(self, m: Motion<T>) -> Force<T> {
        Force::new(
            self.rotate(m.angular) + self.moment.cross(m.linear),
            m.linear * self.mass - self.moment.cross(m.angular),
        )
    }
}
impl<T: Real> AddAssign for Inertia<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        for i in 0..6 {
            self.rotational[i] += o.rotational[i];
        }
        self.moment += o.moment;
        self.mass += o.mass;
    }
}
