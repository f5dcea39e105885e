//! Volumes of sites: what touches there, and what is inside.

use super::reading::Reading;
use crate::output::of_contact;
use clench_collide::{Pose, Ray, Shape, ShapeKind, ray};
use clench_math::{Mask, Mat3, Real, Vec3, kernel};

impl<T: Real> Reading<'_, T> {
    /// The sum of the normal forces of those contacts of a site's body whose line of force meets the site's volume on its way into
    /// the body.
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

    /// 1 where a point is inside a site's volume, else 0.
    #[kernel]
    pub(super) fn is_inside(&self, site: usize, point: Vec3<T>) -> T {
        let pose = self.site_pose(site);
        let (p, size) = (pose.local(point), self.params.site_size[site]);
        let level = p.x * p.x + p.y * p.y;
        let inside = match self.model.sites[site].kind {
            ShapeKind::Sphere => p.norm_squared().le(size.x.squared()),
            ShapeKind::Capsule => {
                let end = (p.z.abs() - size.y).max(T::ZERO);
                (level + end * end).le(size.x.squared())
            }
            ShapeKind::Ellipsoid => {
                let scaled = Vec3::new(p.x / size.x, p.y / size.y, p.z / size.z);
                scaled.norm_squared().le(T::ONE)
            }
            ShapeKind::Cylinder => level.le(size.x.squared()) & p.z.abs().le(size.y),
            ShapeKind::Box => p.x.abs().le(size.x) & p.y.abs().le(size.y) & p.z.abs().le(size.z),
            ShapeKind::Mesh => self.is_in_hull(site, p),
            ShapeKind::Plane | ShapeKind::HeightField => T::Mask::splat(false),
        };
        T::select(inside, T::ONE, T::ZERO)
    }

    /// Whether a point in a site's frame is in the hull of the site's mesh, which has its author's coordinates there.
    fn is_in_hull(&self, site: usize, point: Vec3<T>) -> T::Mask {
        let mesh = self.model.sites[site]
            .mesh
            .map(|mesh| &self.model.meshes[mesh]);
        let Some((mesh, hull)) = mesh.and_then(|mesh| Some((mesh, mesh.hull.as_ref()?))) else {
            return T::Mask::splat(false);
        };
        let axes = Mat3::from_f64(mesh.quat.to_matrix().rows.map(Vec3::to_array));
        let point = axes.transpose_mul(point - Vec3::from_f64(mesh.pos.to_array()));
        let mut inside = T::Mask::splat(true);
        for face in 0..hull.face_count() {
            let height = Vec3::from_f64(hull.normal(face).to_array()).dot(point);
            inside &= height.le(T::new(hull.offset(face)));
        }
        inside
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
