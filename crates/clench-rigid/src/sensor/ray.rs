//! Rangefinders: the nearest geom along a site's z axis, geoms of the site's own body and invisible ones left out.

use super::Reading;
use crate::query::RayFilter;
use clench_collide::Ray;
use clench_math::Real;

impl<T: Real> Reading<'_, T> {
    /// The distance from a site to what its z axis hits, −1 where that is nothing.
    pub(super) fn range(&self, site: usize) -> T {
        let pos = &self.ws.position;
        let line = Ray {
            origin: pos.site_xpos[site],
            direction: pos.site_xmat[site].column(2),
        };
        let filter = RayFilter {
            excluded_body: Some(self.model.sites[site].body),
            ..RayFilter::default()
        };
        let (_, hit) = self.geoms().first_hit(&line, &filter);
        let found = hit.distance.lt(T::new(f64::INFINITY));
        T::select(found, hit.distance, -T::ONE)
    }
}
