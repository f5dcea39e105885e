//! Tactile skins: at each vertex of a mesh in a geom's frame, the penetration into geoms that touch the geom's body,
//! and the sliding velocity there. Depths are those of MuJoCo's signed distance functions (`engine_collision_sdf.c`),
//! which inside a box or an ellipsoid are not the distance to the surface.

use super::read::Reading;
use clench_collide::ShapeKind;
use clench_math::{Mask, Real, Vec3, kernel};

impl<T: Real> Reading<'_, T> {
    /// Writes all depths, then all speeds along first tangents, then along second ones. Contacts with meshes and
    /// terrain are ignored.
    #[kernel]
    pub(super) fn read_taxels(&self, mesh: usize, geom: usize, out: &mut [T]) {
        out.fill(T::ZERO);
        let body = self.model.bodies[self.model.geoms[geom].body].weld;
        let mut next = 0;
        while let Some((other, lanes)) = self.next_touched(body, next) {
            self.add_readings(mesh, geom, other, lanes, out);
            next = other + 1;
        }
    }

    /// Returns the first geom from `from` on that touches a body welded to `body`, and the lanes in which it does.
    #[kernel]
    fn next_touched(&self, body: usize, from: usize) -> Option<(usize, T::Mask)> {
        let weld = |geom: usize| self.model.bodies[self.model.geoms[geom].body].weld;
        let mut found: Option<(usize, T::Mask)> = None;
        for contact in &self.ws.contacts {
            let [first, second] = contact.geoms;
            for (own, other) in [(first, second), (second, first)] {
                if weld(own) != body || other < from || !contact.active.any() {
                    continue;
                }
                found = match found {
                    Some((known, lanes)) if known == other => Some((known, lanes | contact.active)),
                    Some((known, lanes)) if known < other => Some((known, lanes)),
                    _ => Some((other, contact.active)),
                };
            }
        }
        found
    }

    /// Adds the readings of the vertices due to one geom.
    #[kernel]
    fn add_readings(&self, mesh: usize, geom: usize, other: usize, lanes: T::Mask, out: &mut [T]) {
        let mesh = &self.model.meshes[mesh];
        let kind = self.model.geoms[other].kind;
        let size = self.params.geom_size[other];
        let pos = &self.ws.position;
        let count = mesh.vertices.len();
        for (k, vertex) in mesh.vertices.iter().enumerate() {
            let turned = |v: &Vec3<f64>| pos.geom_xmat[geom] * rounded(v);
            let point = pos.geom_xpos[geom] + turned(vertex);
            let local = pos.geom_xmat[other].transpose_mul(point - pos.geom_xpos[other]);
            let Some(distance) = signed_distance(kind, size, local) else {
                return;
            };
            let inside = lanes & distance.lt(T::ZERO);
            if !inside.any() {
                continue;
            }
            out[k] = T::select(inside, out[k].max(-distance), out[k]);
            let Some(tangents) = mesh.tangents.get(k) else {
                continue;
            };
            let sliding = self.velocity_at(geom, point) - self.velocity_at(other, point);
            for (channel, tangent) in tangents.iter().enumerate() {
                let speed = sliding.dot(turned(tangent)).abs();
                let sum = &mut out[(channel + 1) * count + k];
                *sum += T::select(inside, speed, T::ZERO);
            }
        }
    }

    /// Returns the velocity of a point that moves with a geom.
    #[inline(always)]
    fn velocity_at(&self, geom: usize, point: Vec3<T>) -> Vec3<T> {
        let body = self.model.geoms[geom].body;
        let root = self.model.bodies[body].root;
        let arm = point - self.ws.position.subtree_com[root];
        self.ws.velocity.cvel[body].velocity_at(arm)
    }
}

/// Rounds a point or tangent of a mesh to single precision, in which MuJoCo stores it.
fn rounded<T: Real>(v: &Vec3<f64>) -> Vec3<T> {
    Vec3::from_f64(v.to_array().map(|x| f64::from(x as f32)))
}

/// Returns the signed distance function of a shape at a point of its frame, negative inside; `None` for shapes without
/// one.
#[inline(always)]
fn signed_distance<T: Real>(kind: ShapeKind, size: Vec3<T>, point: Vec3<T>) -> Option<T> {
    let half_height = size.y;
    Some(match kind {
        ShapeKind::Plane => point.z,
        ShapeKind::Sphere => point.norm() - size.x,
        ShapeKind::Capsule => {
            let height = point.z - point.z.max(-half_height).min(half_height);
            Vec3::new(point.x, point.y, height).norm() - size.x
        }
        ShapeKind::Ellipsoid => {
            let scaled = divide(point, size);
            let norm = scaled.norm();
            norm * (norm - T::ONE) / divide(scaled, size).norm()
        }
        ShapeKind::Cylinder => {
            let outside = [
                (point.x * point.x + point.y * point.y).sqrt() - size.x,
                point.z.abs() - half_height,
            ];
            let [around, above] = outside.map(|x| x.max(T::ZERO));
            outside[0].max(outside[1]).min(T::ZERO) + (around * around + above * above).sqrt()
        }
        ShapeKind::Box => box_distance(size, point),
        ShapeKind::Mesh | ShapeKind::HeightField => return None,
    })
}

fn divide<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Vec3<T> {
    Vec3::new(a.x / b.x, a.y / b.y, a.z / b.z)
}

/// Returns the distance outside; inside, minus the distance to a face along a field that turns from the centre's
/// direction to the normals of the faces.
#[inline(always)]
fn box_distance<T: Real>(size: Vec3<T>, point: Vec3<T>) -> T {
    let beyond = Vec3::new(point.x.abs(), point.y.abs(), point.z.abs()) - size;
    let furthest = beyond.x.max(beyond.y).max(beyond.z);
    let outside = beyond.to_array().map(|x| x.max(T::ZERO));
    let outer = Vec3::from_array(outside).norm();
    let field = divide(size, beyond).to_array();
    let norm = Vec3::from_array(field).norm();
    let steps = beyond.to_array().into_iter().zip(field);
    let nearest = steps.map(|(gap, x)| -gap / (x / norm).abs());
    let inner = nearest.fold(T::new(f64::INFINITY), |least, step| least.min(step));
    T::select(furthest.lt(T::ZERO), -inner, outer)
}
