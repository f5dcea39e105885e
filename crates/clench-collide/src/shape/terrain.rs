//! Terrain: a height field on a base.

use super::cuboid::Cuboid;
use super::solid::{Homogeneous, Solid};
use crate::height_field::HeightField;
use crate::ray::line::Line;
use crate::ray::terrain::height_field;
use clench_math::{Double, Mask, Real, Vec3};

/// Terrain over a rectangle, on a base, the same in every environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terrain<'a, T> {
    /// The heights; without them the terrain touches nothing.
    pub field: Option<&'a HeightField>,
    /// The half lengths along x and y; a quarter of the elevation plus half of the base (as in MuJoCo), m.
    pub size: Vec3<T>,
}

impl<'a, T: Real> Solid<T> for Terrain<'a, T> {
    type InDouble = Terrain<'a, Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Terrain {
            field: self.field,
            size: self.size.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        self.size
    }

    /// Uses that neither elevation nor base is more than four times the z size.
    #[inline(always)]
    fn bounding_radius(&self) -> T {
        let s = self.size;
        Vec3::new(s.x, s.y, s.z * T::new(4.0)).norm()
    }

    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        let s = self.size;
        s.x * d.x.abs() + s.y * d.y.abs() + s.z * T::new(4.0) * d.z.abs()
    }

    #[inline(always)]
    fn contains(&self, _: Vec3<T>) -> T::Mask {
        T::Mask::splat(false)
    }

    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        line.in_each_lane(|line| height_field(self.field?, line.origin, line.along))
    }
}

/// Approximates a height field by a box, as MuJoCo does.
impl Homogeneous for Terrain<'_, f64> {
    fn measure(&self, shell: bool) -> f64 {
        self.as_box().measure(shell)
    }

    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        self.as_box().moments(mass, shell)
    }
}

impl Terrain<'_, f64> {
    fn as_box(&self) -> Cuboid<f64> {
        Cuboid {
            half_lengths: self.size,
        }
    }
}
