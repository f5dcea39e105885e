//! Rays, hits, and rays in the frame of a shape.

use crate::pose::Pose;
use clench_math::{Real, Scalar, Vec3};

/// A ray in the frame of a shape, with a direction of unit length.
#[derive(Clone, Copy)]
pub(crate) struct Line<T> {
    pub(crate) origin: Vec3<T>,
    pub(crate) along: Vec3<T>,
}

impl<T: Real> Line<T> {
    /// Returns the line of a ray, and the divisor of its distances.
    #[inline(always)]
    pub(super) fn of(pose: &Pose<T>, ray: &Ray<T>) -> (Self, Unit<T>) {
        let (direction, unit) = Unit::of(ray.direction);
        let line = Line {
            origin: pose.local(ray.origin),
            along: pose.rotation.transpose_mul(direction) * (T::ONE / unit.length),
        };
        (line, unit)
    }

    /// Returns the point at a distance.
    #[inline(always)]
    pub(crate) fn at(&self, distance: T) -> Vec3<T> {
        self.origin + self.along * distance
    }

    /// Computes hits that branch too much for lanes lane by lane. `cast` returns the distance and the normal of a hit.
    pub(crate) fn in_each_lane(
        &self,
        cast: impl Fn(&Line<f64>) -> Option<(f64, Vec3<f64>)>,
    ) -> (T, Vec3<T>) {
        let Hit {
            mut distance,
            mut normal,
        } = Hit::<T>::none();
        for lane in 0..T::LANES {
            let of = |v: Vec3<T>| Vec3::from_array(v.to_array().map(|x| x.lane(lane).to_f64()));
            let line = Line {
                origin: of(self.origin),
                along: of(self.along),
            };
            let sum = line.origin + line.along;
            if !sum.to_array().iter().all(|x| x.is_finite()) {
                continue;
            }
            if let Some((found, n)) = cast(&line) {
                distance.set_lane(lane, T::Scalar::new(found));
                for axis in 0..3 {
                    normal[axis].set_lane(lane, T::Scalar::new(n[axis]));
                }
                if T::IS_DUAL && n.dot(line.along) != 0.0 {
                    let point = line.at(found);
                    distance += self.distance_to_plane(point, n) - T::new(found);
                    distance.set_value(T::new(found).value());
                }
            }
        }
        (distance, normal)
    }

    /// Returns the distance to the plane through a point across a normal. The facets of surfaces that are hit lane by
    /// lane are flat, so it has the derivatives of the distance to the facet.
    fn distance_to_plane(&self, point: Vec3<f64>, normal: Vec3<f64>) -> T {
        let [point, normal] = [point, normal].map(|v| Vec3::from_f64(v.to_array()));
        normal.dot(point - self.origin) / normal.dot(self.along)
    }
}

/// The length of a direction, as a product that neither overflows nor underflows.
#[derive(Clone, Copy)]
pub(super) struct Unit<T: Real> {
    /// The largest component of the direction, and the length in units of it.
    pub(super) largest: T,
    pub(super) length: T,
    /// The lanes in which the direction has a length.
    leads: T::Mask,
}

impl<T: Real> Unit<T> {
    /// Scales a direction by its largest component; returns z if it is zero.
    #[inline(always)]
    pub(super) fn of(d: Vec3<T>) -> (Vec3<T>, Self) {
        let largest = d.x.abs().max(d.y.abs()).max(d.z.abs());
        let leads = largest.ge(T::splat(T::Scalar::MIN_POSITIVE))
            & d.x.is_finite()
            & d.y.is_finite()
            & d.z.is_finite();
        let largest = T::select(leads, largest, T::ONE);
        let up = Vec3::new(T::ZERO, T::ZERO, T::ONE);
        let scaled = Vec3::new(d.x / largest, d.y / largest, d.z / largest);
        let direction = Vec3::select(leads, scaled, up);
        let unit = Unit {
            largest,
            length: direction.norm(),
            leads,
        };
        (direction, unit)
    }

    /// Returns the hit at a distance with a local normal, if valid.
    #[inline(always)]
    pub(super) fn hit(&self, pose: &Pose<T>, distance: T, normal: Vec3<T>) -> Hit<T> {
        let normal = pose.rotation * normal;
        let distance = distance / self.length / self.largest;
        let none = Hit::none();
        let is_hit = self.leads
            & distance.ge(T::ZERO)
            & distance.is_finite()
            & normal.norm_squared().gt(T::new(0.5));
        Hit {
            distance: T::select(is_hit, distance, none.distance),
            normal: Vec3::select(is_hit, normal, none.normal),
        }
    }
}

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T> {
    /// The start of the ray, in world coordinates, m.
    pub origin: Vec3<T>,
    /// The direction. Its length is the unit of distances along the ray.
    pub direction: Vec3<T>,
}

/// The hit of a ray on a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<T> {
    /// The distance from the origin, in lengths of the ray's direction; infinite if there is no hit.
    pub distance: T,
    /// The outward unit normal, in world coordinates; zero if there is no hit.
    pub normal: Vec3<T>,
}

impl<T: Real> Hit<T> {
    /// Returns no hit.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Hit {
            distance: T::new(f64::INFINITY),
            normal: Vec3::ZERO,
        }
    }
}
