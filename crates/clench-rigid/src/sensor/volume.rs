//! Volumes of sites: touch sensors and containment.

use super::read::Reading;
use crate::output::forces::of_contact;
use clench_collide::{Mesh, Pose, Ray, Shape, ray};
use clench_dynamics::model;
use clench_math::{Mask, Mat3, Real, Vec3, kernel};

impl<T: Real> Reading<'_, T> {
    /// Returns the sum of the normal forces of those contacts of a site's body whose line of force, followed out of the
    /// body, meets the site's volume.
    #[kernel]
    pub(super) fn touch(&self, site: usize) -> T {
        let (shape, pose) = self.volume(site);
        let own = self.model.sites[site].body;
        let mut sum = T::ZERO;
        for contact in &self.ws.contacts {
            let bodies = contact.geoms.map(|geom| self.model.geoms[geom].body);
            if !bodies.contains(&own) {
                continue;
            }
            let Some([normal, ..]) = of_contact(self.ws, contact) else {
                continue;
            };
            let pressed = normal.gt(T::ZERO);
            if !pressed.any() {
                continue;
            }
            let sign = if bodies[1] == own { -T::ONE } else { T::ONE };
            let line = Ray {
                origin: contact.pos,
                direction: contact.frame.rows[0] * sign,
            };
            let met = ray(&shape, &pose, &line).distance.lt(T::new(f64::INFINITY));
            sum += T::select(pressed & met, normal, T::ZERO);
        }
        sum
    }

    /// Returns 1 if a point is inside a site's volume, otherwise 0.
    #[kernel]
    pub(super) fn is_inside(&self, site: usize, point: Vec3<T>) -> T {
        let (shape, pose) = self.volume(site);
        let (shape, point) = match self.model.sites[site].mesh {
            Some(mesh) => {
                in_frame_of_hull(&self.model.meshes[mesh], shape.size(), pose.local(point))
            }
            None => (shape, pose.local(point)),
        };
        T::select(shape.contains(point), T::ONE, T::ZERO)
    }

    /// Returns a site's volume and its pose. For a mesh, they are the hull and the frame of the hull.
    pub(super) fn solid_volume(&self, site: usize) -> (Shape<'_, T>, Pose<T>) {
        let (shape, pose) = self.volume(site);
        let Some(mesh) = self.model.sites[site].mesh else {
            return (shape, pose);
        };
        let mesh = &self.model.meshes[mesh];
        let pose = Pose {
            position: pose.point(Vec3::from_f64(mesh.pos.to_array())),
            rotation: pose.rotation * axes_of(mesh),
        };
        (hull_of(mesh, shape.size()), pose)
    }

    fn volume(&self, site: usize) -> (Shape<'static, T>, Pose<T>) {
        let shape = Shape::new(self.model.sites[site].kind, self.params.site_size[site]);
        (shape, self.site_pose(site))
    }

    fn site_pose(&self, site: usize) -> Pose<T> {
        let pos = &self.ws.position;
        Pose {
            position: pos.site_xpos[site],
            rotation: pos.site_xmat[site],
        }
    }
}

/// Returns the hull of a site's mesh, of size `size`, and transforms `point` from the site's frame, in which the mesh
/// has its original coordinates, to that of the hull.
#[inline(always)]
fn in_frame_of_hull<T: Real>(
    mesh: &model::Mesh,
    size: Vec3<T>,
    point: Vec3<T>,
) -> (Shape<'_, T>, Vec3<T>) {
    let offset = point - Vec3::from_f64(mesh.pos.to_array());
    (hull_of(mesh, size), axes_of(mesh).transpose_mul(offset))
}

#[inline(always)]
fn hull_of<T: Real>(mesh: &model::Mesh, size: Vec3<T>) -> Shape<'_, T> {
    Shape::Mesh(Mesh {
        hull: mesh.hull.as_ref(),
        extent: size,
    })
}

/// Returns the axes of a mesh's hull in the frame of a site.
#[inline(always)]
fn axes_of<T: Real>(mesh: &model::Mesh) -> Mat3<T> {
    Mat3::from_f64(mesh.quat.to_matrix().rows.map(Vec3::to_array))
}
