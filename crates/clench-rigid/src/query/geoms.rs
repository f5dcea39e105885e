//! Queries about geoms: ray casts and distances.

use crate::Precision;
use crate::sim::Sim;
use crate::validity::Computed;
use clench_collide::{Ray, Separation, distance};
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::geometry::{Geoms, RayFilter, RayHit};
use clench_math::{Real, Vec3};

impl<T: Precision> Sim<T> {
    /// Returns the first geom that a ray hits at the poses of [`refresh`](Self::refresh), as MuJoCo's `mj_ray`. Planes
    /// are hit from above and within their size (if that is positive), meshes on their own triangles, from either side.
    /// A ray that starts inside another shape hits it at its exit (MuJoCo's rays inside a height field also end where
    /// the terrain meets its base). A direction of zero length hits nothing.
    ///
    /// # Errors
    /// See [`refresh`](Self::refresh).
    pub fn ray(
        &mut self,
        origin: Vec3<T>,
        direction: Vec3<T>,
        filter: &RayFilter,
    ) -> Result<Option<RayHit<T>>, SimError> {
        self.require(Computed::Positions)?;
        let line = Ray {
            origin: Vec3::splat(origin),
            direction: Vec3::splat(direction),
        };
        let (geom, hit) = self.geoms().first_hit(&line, filter);
        let distance = hit.distance.lane(0);
        Ok((distance < T::INFINITY).then(|| RayHit {
            geom: geom.lane(0).to_f64() as usize,
            distance,
            normal: hit.normal.lane(0),
        }))
    }

    /// Returns the signed distance between two geoms at the poses of [`refresh`](Self::refresh), as MuJoCo's
    /// `mj_geomDistance`, with the nearest points, the first geom's first. Collision filters are ignored. Returns
    /// `None` if the geoms are further apart than `limit` metres, which may be infinite, or have no distance: two
    /// planes or height fields, or a flat mesh. A mesh is represented by its convex hull.
    ///
    /// # Errors
    /// Returns an error if there is no such geom, or as [`refresh`](Self::refresh) does.
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
        self.require(Computed::Positions)?;
        let geoms = self.geoms();
        let lane = |geom| (geoms.solid(geom).lane(0), geoms.pose(geom).lane(0));
        let [a, b] = [geom1, geom2].map(lane);
        Ok(distance(&a.0, &a.1, &b.0, &b.1, limit))
    }

    pub(super) fn geoms(&self) -> Geoms<'_, T::SingleEnv> {
        Geoms {
            model: self.model(),
            params: self.params(),
            position: &self.workspace().position,
        }
    }
}
