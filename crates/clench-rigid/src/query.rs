//! Questions about where geoms are: what a ray hits, and how far apart two geoms are.

use crate::Precision;
use crate::contact::shape;
use crate::error::SimError;
use crate::known::Extent;
use crate::sim::{Sim, no_such};
use clench_collide::{
    Asset, Hit, Pose, Ray, Separation, Shape, ShapeKind, allowance, distance, ray,
};
use clench_math::Vec3;

/// Which geoms a ray can hit. Those that cannot be seen, it never hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayFilter {
    /// For each group whether its geoms are hit; groups beyond these count as the nearest of them.
    pub groups: [bool; 6],
    /// Whether geoms are hit that are fixed to the world.
    pub fixed: bool,
    /// A body whose geoms are not hit, such as the one that a sensor sits on.
    pub excluded_body: Option<usize>,
}

impl Default for RayFilter {
    /// Everything.
    fn default() -> Self {
        RayFilter {
            groups: [true; 6],
            fixed: true,
            excluded_body: None,
        }
    }
}

/// Where a ray hits first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit<T> {
    /// The geom.
    pub geom: usize,
    /// From the ray's origin, in lengths of its direction.
    pub distance: T,
    /// The unit vector out of the geom there, in world coordinates.
    pub normal: Vec3<T>,
}

impl<T: Precision> Sim<T> {
    /// The geom that a ray hits first, where geoms are as in [`refresh`](Self::refresh), as MuJoCo's `mj_ray`: planes are hit from above and within their size (where that is positive), meshes on their own triangles, from
    /// either side. A ray that begins inside another shape hits it where it leaves (MuJoCo's rays inside a height field also
    /// end where the terrain meets its base). A direction without length hits nothing.
    ///
    /// # Errors
    /// As [`refresh`](Self::refresh).
    pub fn ray(
        &mut self,
        origin: Vec3<T>,
        direction: Vec3<T>,
        filter: &RayFilter,
    ) -> Result<Option<RayHit<T>>, SimError> {
        self.know(Extent::Positions)?;
        let ray = Ray { origin, direction };
        let mut best: Option<RayHit<T>> = None;
        for geom in 0..self.model().geoms.len() {
            if !self.is_hit_by(geom, filter) || self.misses(geom, &ray) {
                continue;
            }
            let hit = self.cast(geom, &ray);
            if hit.distance < best.map_or(T::INFINITY, |best| best.distance) {
                best = Some(RayHit {
                    geom,
                    distance: hit.distance,
                    normal: hit.normal,
                });
            }
        }
        Ok(best)
    }

    /// How far apart two geoms are, where they are as in [`refresh`](Self::refresh), whatever they collide with, as MuJoCo's
    /// `mj_geomDistance`: signed, with the nearest points, the first geom's first. Nothing if they are further apart than `limit`
    /// metres, which may be infinite, or have no distance: two planes or height fields, or a mesh that is flat. A mesh counts
    /// as its convex hull.
    ///
    /// # Errors
    /// A geom that the model does not have; else as [`refresh`](Self::refresh).
    pub fn distance(
        &mut self,
        geom1: usize,
        geom2: usize,
        limit: T,
    ) -> Result<Option<Separation<T>>, SimError> {
        let count = self.model().geoms.len();
        if let Some(index) = [geom1, geom2].into_iter().find(|geom| *geom >= count) {
            return Err(no_such("geom", index, count));
        }
        self.know(Extent::Positions)?;
        let (a, b) = (self.solid(geom1), self.solid(geom2));
        let (pose_a, pose_b) = (self.pose(geom1), self.pose(geom2));
        Ok(distance(&a, &pose_a, &b, &pose_b, limit))
    }

    fn is_hit_by(&self, geom: usize, filter: &RayFilter) -> bool {
        let model = self.model();
        let geom = &model.geoms[geom];
        let fixed = model.bodies[geom.body].weld == 0;
        let group = geom.group.clamp(0, filter.groups.len() as i32 - 1) as usize;
        geom.visible
            && filter.groups[group]
            && (filter.fixed || !fixed)
            && filter.excluded_body != Some(geom.body)
    }

    /// Whether a ray passes a geom's bounding sphere by.
    fn misses(&self, geom: usize, cast: &Ray<T>) -> bool {
        if self.model().geoms[geom].kind == ShapeKind::Plane {
            return false;
        }
        let pose = self.pose(geom);
        // From far away a ray is known to so much.
        let rounding = (pose.position - cast.origin).norm() * T::EPSILON * T::new(8.0);
        let radius = self.params().geom_rbound[geom] * allowance::<T>() + rounding;
        let sphere = Shape::new(ShapeKind::Sphere, Vec3::new(radius, T::ZERO, T::ZERO));
        ray(&sphere, &pose, cast).distance == T::INFINITY
    }

    fn cast(&self, geom: usize, cast: &Ray<T>) -> Hit<T> {
        let model = self.model();
        let pose = self.pose(geom);
        match model.geoms[geom].mesh {
            Some(mesh) => model.meshes[mesh].triangles().ray(&pose, cast),
            None => ray(&shape(model, self.params(), geom), &pose, cast),
        }
    }

    /// The shape of a geom, with a hull even if it does not collide.
    fn solid(&self, geom: usize) -> Shape<'_, T> {
        let model = self.model();
        let shape = shape(model, self.params(), geom);
        match model.geoms[geom].mesh {
            Some(mesh) => Shape {
                asset: model.meshes[mesh]
                    .any_hull()
                    .map_or(Asset::None, Asset::Hull),
                ..shape
            },
            None => shape,
        }
    }

    fn pose(&self, geom: usize) -> Pose<T> {
        let position = &self.workspace().position;
        Pose {
            position: position.geom_xpos[geom],
            rotation: position.geom_xmat[geom],
        }
    }
}
