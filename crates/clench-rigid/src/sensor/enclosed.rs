//! Protrusion of objects from the volume of a site. Each lane is searched separately.

use super::read::Reading;
use clench_collide::{Ascent, Pose, Shape, protrusion, protrusion_of_points};
use clench_dynamics::model::FrameObject;
use clench_math::{Real, Scalar};

/// A shape and its pose.
type Placed<'a, S> = (Shape<'a, S>, Pose<S>);

impl<T: Real> Reading<'_, T> {
    /// Returns the maximum protrusion of an object from a site's volume, m; minus the smallest clearance if all of it
    /// is inside.
    pub(super) fn protrusion(&self, site: usize, object: FrameObject) -> T {
        let mut out = T::ZERO;
        for lane in 0..T::LANES {
            let volume = self.site_in_lane(site, lane);
            let mut largest = -T::Scalar::INFINITY;
            if let FrameObject::Site(inner) = object {
                largest = self.of_shape(&self.site_in_lane(inner, lane), &volume);
            }
            for geom in object.enclosed_geoms(self.model) {
                largest = Real::max(largest, self.of_geom(geom, lane, &volume));
            }
            out.set_lane(lane, largest);
        }
        out
    }

    fn site_in_lane(&self, site: usize, lane: usize) -> Placed<'_, T::Scalar> {
        let (shape, pose) = self.solid_volume(site);
        (shape.lane(lane), pose.lane(lane))
    }

    /// Returns the protrusion of a geom. A flat mesh has no hull, and its vertices are used.
    fn of_geom(&self, geom: usize, lane: usize, volume: &Placed<T::Scalar>) -> T::Scalar {
        let solid = self.solid(geom, lane);
        let mesh = self.model.geoms[geom].mesh;
        match (&solid.0, mesh.map(|mesh| &self.model.meshes[mesh])) {
            (Shape::Mesh(flat), Some(mesh)) if flat.hull.is_none() => {
                let (points, (outer, pose)) = (&mesh.vertices, volume);
                protrusion_of_points(points, &solid.1, outer, pose, self.ascent())
                    .unwrap_or(-T::Scalar::INFINITY)
            }
            _ => self.of_shape(&solid, volume),
        }
    }

    /// Returns the protrusion of a shape. Unbounded shapes are rejected when the model is built.
    fn of_shape(
        &self,
        (inner, pose): &Placed<T::Scalar>,
        (outer, pose_outer): &Placed<T::Scalar>,
    ) -> T::Scalar {
        protrusion(inner, pose, outer, pose_outer, self.ascent()).unwrap_or(-T::Scalar::INFINITY)
    }

    fn ascent(&self) -> Ascent {
        Ascent {
            iterations: self.settings.ccd_iterations,
            tolerance: self.settings.ccd_tolerance,
        }
    }
}
