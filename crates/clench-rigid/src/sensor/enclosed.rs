//! How far objects jut out of the volume of a site. It is searched for in each lane alone.

use super::reading::Reading;
use clench_collide::{Ascent, Pose, Shape, protrusion, protrusion_of_points};
use clench_dynamics::model::FrameObject;
use clench_math::{Real, Scalar};

/// A shape, and where it is.
type Placed<'a, S> = (Shape<'a, S>, Pose<S>);

impl<T: Real> Reading<'_, T> {
    /// The furthest that any part of an object juts out of a site's volume; negative, by the least clearance, where all of it lies
    /// inside, m.
    pub(super) fn protrusion(&self, site: usize, object: FrameObject) -> T {
        let mut out = T::ZERO;
        for lane in 0..T::LANES {
            let volume = self.site_in_lane(site, lane);
            let mut most = -T::Scalar::INFINITY;
            if let FrameObject::Site(inner) = object {
                most = self.of_shape(&self.site_in_lane(inner, lane), &volume);
            }
            for geom in object.enclosed_geoms(self.model) {
                most = Real::max(most, self.of_geom(geom, lane, &volume));
            }
            out.set_lane(lane, most);
        }
        out
    }

    fn site_in_lane(&self, site: usize, lane: usize) -> Placed<'_, T::Scalar> {
        let (shape, pose) = self.solid_volume(site);
        (shape.lane(lane), pose.lane(lane))
    }

    /// How far a geom juts out. A mesh that is flat has no hull, but corners.
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

    /// How far a shape juts out; what has no bounds was refused when the model was built.
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
