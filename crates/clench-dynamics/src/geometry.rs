//! The geoms at their current poses, for queries by ray or shape, in lanes. Contact detection has its own path,
//! `contact`.

use crate::contact::{ALL_LANES, AssetLanes, exists, mask_of, mesh_in, shape, shape_in};
use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_collide::{Hit, Mesh, Pose, Ray, Shape, ShapeKind, UnitRay, ray};
use clench_math::{Mask, Real, Scalar, Vec3, kernel};

/// The geoms of a configuration.
#[derive(Clone, Copy)]
pub struct Geoms<'a, T: Real> {
    /// The model.
    pub model: &'a Model,
    /// Its parameters.
    pub params: &'a Params<T>,
    /// Poses of everything.
    pub position: &'a Positions<T>,
}

impl<'a, T: Real> Geoms<'a, T> {
    /// Returns the pose of a geom.
    pub fn pose(&self, geom: usize) -> Pose<T> {
        Pose {
            position: self.position.geom_xpos[geom],
            rotation: self.position.geom_xmat[geom],
        }
    }

    /// Returns the shape of a geom, with a hull even if it does not collide.
    pub fn solid(&self, geom: usize) -> Shape<'a, T> {
        match self.model.geoms[geom].mesh {
            Some(mesh) => Shape::Mesh(Mesh {
                hull: self.model.meshes[mesh].any_hull(),
                extent: self.params.geom_size[geom],
            }),
            None => shape(self.model, self.params, geom),
        }
    }

    /// Returns the index of the geom that a ray hits first, and the hit. The distance is infinite where it hits none.
    #[kernel]
    pub fn first_hit(&self, line: &Ray<T>, filter: &RayFilter) -> (T, Hit<T>) {
        let mut best = (
            T::ZERO,
            Hit {
                distance: T::new(f64::INFINITY),
                normal: Vec3::ZERO,
            },
        );
        let unit = UnitRay::of(line);
        for geom in 0..self.model.geoms.len() {
            if !self.is_hit_by(geom, filter) {
                continue;
            }
            let may_hit = self.may_hit(geom, &unit, best.1.distance);
            if !may_hit.any() {
                continue;
            }
            let hit = self.hit(geom, line);
            let nearer = may_hit & hit.distance.lt(best.1.distance);
            best.0 = T::select(nearer, T::new(geom as f64), best.0);
            best.1.distance = T::select(nearer, hit.distance, best.1.distance);
            best.1.normal = Vec3::select(nearer, hit.normal, best.1.normal);
        }
        best
    }

    fn is_hit_by(&self, geom: usize, filter: &RayFilter) -> bool {
        let geom = &self.model.geoms[geom];
        let fixed = self.model.bodies[geom.body].weld == 0;
        let group = geom.group.clamp(0, filter.groups.len() as i32 - 1) as usize;
        geom.visible
            && filter.groups[group]
            && (filter.fixed || !fixed)
            && filter.excluded_body != Some(geom.body)
    }

    /// Returns the lanes in which a ray may hit a geom's bounding sphere within the distance `within`.
    #[inline(always)]
    fn may_hit(&self, geom: usize, ray: &UnitRay<T>, within: T) -> T::Mask {
        if self.model.geoms[geom].kind == ShapeKind::Plane {
            return exists(self.params, geom);
        }
        let center = self.position.geom_xpos[geom];
        ray.may_intersect(center, self.params.geom_rbound[geom], within)
    }

    #[inline(always)]
    fn hit(&self, geom: usize, line: &Ray<T>) -> Hit<T> {
        let pose = self.pose(geom);
        let mut hit = Hit {
            distance: T::splat(T::Scalar::INFINITY),
            normal: Vec3::ZERO,
        };
        for (lanes, lane) in AssetLanes::new(self.model, self.params, [geom, geom]) {
            let own = match mesh_in(self.model, self.params, geom, lane) {
                Some(mesh) => self.model.meshes[mesh].triangles().ray(&pose, line),
                None => ray(&shape_in(self.model, self.params, geom, lane), &pose, line),
            };
            if lanes == ALL_LANES {
                return own;
            }
            let lanes = mask_of::<T>(lanes);
            hit.distance = T::select(lanes, own.distance, hit.distance);
            hit.normal = Vec3::select(lanes, own.normal, hit.normal);
        }
        hit
    }
}

/// The geoms that a ray can hit. A ray never hits invisible geoms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayFilter {
    /// True for each group whose geoms are hit. Groups outside 0 to 5 are clamped.
    pub groups: [bool; 6],
    /// True if geoms that are fixed to the world are hit.
    pub fixed: bool,
    /// A body whose geoms are not hit, such as that of a sensor.
    pub excluded_body: Option<usize>,
}

impl Default for RayFilter {
    /// Hits everything.
    fn default() -> Self {
        RayFilter {
            groups: [true; 6],
            fixed: true,
            excluded_body: None,
        }
    }
}

/// The first hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit<T> {
    /// The geom.
    pub geom: usize,
    /// The distance from the ray's origin, in lengths of its direction.
    pub distance: T,
    /// The outward unit normal of the geom there, in world coordinates.
    pub normal: Vec3<T>,
}
