//! Rangefinders: the nearest geom along rays from a site or a camera, without geoms of its own body and invisible ones.

use super::read::Reading;
use clench_collide::Ray;
use clench_dynamics::dynamics::camera::camera_pose;
use clench_dynamics::geometry::RayFilter;
use clench_dynamics::model::{RayField, RaySource};
use clench_math::{Real, Vec3, kernel};

impl<T: Real> Reading<'_, T> {
    /// Writes the hits of all rays, ray by ray.
    #[kernel]
    pub(super) fn read_rays(&self, source: RaySource, fields: &[RayField], out: &mut [T]) {
        let pos = &self.ws.position;
        match source {
            RaySource::Site(site) => {
                let axis = pos.site_xmat[site].column(2);
                let line = Ray {
                    origin: pos.site_xpos[site],
                    direction: axis,
                };
                self.read_ray(&line, self.model.sites[site].body, axis, fields, out);
            }
            RaySource::Camera(camera) => {
                let body = self.model.cameras[camera].body;
                let axis = -camera_pose(self.model, self.params, pos, camera)
                    .1
                    .column(2);
                let size: usize = fields.iter().map(|field| field.size()).sum();
                self.lines_of_sight(camera, |i, line| {
                    self.read_ray(line, body, axis, fields, &mut out[size * i..][..size]);
                });
            }
        }
    }

    /// Writes the hit of one ray from a sensor on `body` whose viewing direction is `axis`.
    #[kernel]
    fn read_ray(
        &self,
        line: &Ray<T>,
        body: usize,
        axis: Vec3<T>,
        fields: &[RayField],
        mut out: &mut [T],
    ) {
        let filter = RayFilter {
            excluded_body: Some(body),
            ..RayFilter::default()
        };
        let (_, hit) = self.geoms().first_hit(line, &filter);
        let found = hit.distance.lt(T::new(f64::INFINITY));
        let distance = T::select(found, hit.distance, T::ZERO);
        let where_found = |v: Vec3<T>| Vec3::select(found, v, Vec3::ZERO);
        for field in fields {
            let (numbers, rest) = out.split_at_mut(field.size());
            match field {
                RayField::Dist => numbers[0] = T::select(found, distance, -T::ONE),
                RayField::Dir => where_found(line.direction).write(numbers),
                RayField::Origin => line.origin.write(numbers),
                RayField::Point => {
                    let point = line.origin + line.direction * distance;
                    where_found(point).write(numbers);
                }
                RayField::Normal => where_found(hit.normal).write(numbers),
                RayField::Depth => {
                    let depth = distance * line.direction.dot(axis);
                    numbers[0] = T::select(found, depth, -T::ONE);
                }
            }
            out = rest;
        }
    }
}
