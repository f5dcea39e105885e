//! Rangefinders: the nearest geom along a site's z axis, geoms of the site's own body and invisible ones left out.

use super::Reading;
use crate::contact::shape;
use clench_collide::{Pose, Ray, ray};
use clench_math::Real;

impl<T: Real> Reading<'_, T> {
    /// The distance from a site to what its z axis hits, −1 where that is nothing.
    pub(super) fn range(&self, site: usize) -> T {
        let (model, pos) = (self.model, &self.ws.position);
        let line = Ray {
            origin: pos.site_xpos[site],
            direction: pos.site_xmat[site].column(2),
        };
        let own = model.sites[site].body;
        let infinite = T::new(f64::INFINITY);
        let mut nearest = infinite;
        for (g, geom) in model.geoms.iter().enumerate() {
            if geom.body == own || !geom.visible {
                continue;
            }
            let pose = Pose {
                position: pos.geom_xpos[g],
                rotation: pos.geom_xmat[g],
            };
            let hit = match geom.mesh {
                Some(mesh) => model.meshes[mesh].triangles().ray(&pose, &line),
                None => ray(&shape(model, self.params, g), &pose, &line),
            };
            nearest = nearest.min(hit.distance);
        }
        T::select(nearest.lt(infinite), nearest, -T::ONE)
    }
}
