//! The truth about two shapes, by brute force over their support functions.

use super::{Random, Scene, V};
use clench_collide::{Hull, Pose, Shape, ShapeKind};
use clench_math::Vec3;

impl Scene {
    /// Returns the gap between the shapes along a direction from the first to the second; negative if they overlap.
    pub fn gap_along(&self, n: V) -> f64 {
        let back = support(&self.b, &self.pose_b, -n);
        let front = support(&self.a, &self.pose_a, n);
        (back - front).dot(n)
    }

    /// Returns the signed distance of the shapes, which is the largest gap along any direction.
    pub fn distance(&self, random: &mut Random) -> f64 {
        self.optima(random)[0].0
    }

    /// Searches for the directions of largest gap and returns them best first. Many starts are each improved by random
    /// steps that shrink when they fail. The gap has creases across edges, so some steps go along one crease or to the
    /// intersection of two. The normal that the library found is one of the starts, as it may be better than a random
    /// one.
    pub fn optima(&self, random: &mut Random) -> Vec<(f64, V)> {
        if self.a.kind() == ShapeKind::Plane {
            let normal = self.pose_a.axis();
            return vec![(self.gap_along(normal), normal)];
        }
        let mut starts: Vec<V> = (0..200).map(|_| random.direction()).collect();
        let axes = [&self.pose_a, &self.pose_b].map(|p| [0, 1, 2].map(|i| p.rotation.column(i)));
        for u in axes.as_flattened() {
            starts.extend([*u, -*u]);
            for v in axes.as_flattened() {
                let w = u.cross(*v);
                if w.norm() > 1e-6 {
                    starts.push(w.normalize().0);
                }
            }
        }
        let mut starts: Vec<_> = starts.iter().map(|n| (self.gap_along(*n), *n)).collect();
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        starts.truncate(8);
        let found = self.deepest().map(|c| c.frame.rows[0]);
        starts.extend(found.map(|n| (self.gap_along(n), n)));
        let mut optima: Vec<_> = (starts.into_iter())
            .map(|start| self.climb(start, random))
            .collect();
        optima.sort_by(|a, b| b.0.total_cmp(&a.0));
        optima
    }

    fn climb(&self, (mut best, mut n): (f64, V), random: &mut Random) -> (f64, V) {
        let mut step = 0.3;
        while step > 1e-8 {
            let mut tried = n + random.direction() * step;
            let crease = |random: &mut Random| match random.unit() < 0.5 {
                true => edge(&self.a, &self.pose_a, n, random),
                false => edge(&self.b, &self.pose_b, -n, random),
            };
            match (random.unit() * 4.0) as usize {
                0 | 1 => {}
                2 => {
                    let u = crease(random);
                    tried = tried - u * u.dot(tried);
                }
                _ => {
                    let (u, v) = (crease(random), crease(random));
                    let across = u.cross(v);
                    tried = across * across.dot(n);
                }
            }
            let (tried, length) = tried.normalize();
            let gap = self.gap_along(tried);
            if length > 1e-9 && gap > best {
                (best, n) = (gap, tried);
                step *= 1.5;
            } else {
                step *= 0.985;
            }
        }
        (best, n)
    }
}

/// Returns the unit direction of some straight edge of a shape; of a hull, one near the vertex furthest along `n`.
fn edge(shape: &Shape<'static, f64>, pose: &Pose<f64>, n: V, random: &mut Random) -> V {
    let Some(hull) = mesh_hull(shape) else {
        return pose.rotation.column((random.unit() * 3.0) as usize);
    };
    let d = pose.rotation.transpose_mul(n);
    let mut furthest = [(f64::NEG_INFINITY, V::ZERO); 5];
    for v in hull.vertices() {
        let reach = v.dot(d);
        if let Some(place) = furthest.iter().position(|other| reach > other.0) {
            furthest[place..].rotate_right(1);
            furthest[place] = (reach, *v);
        }
    }
    let other = (1.0 + random.unit() * 3.999) as usize;
    let (along, _) = (furthest[other].1 - furthest[0].1).normalize();
    pose.rotation * along
}

fn farthest_vertex(hull: &Hull, d: V) -> V {
    let further = |u: V, v: &V| if v.dot(d) > u.dot(d) { *v } else { u };
    hull.vertices().iter().fold(hull.vertices()[0], further)
}

/// Returns the hull of a shape that is a mesh.
pub fn mesh_hull(shape: &Shape<'static, f64>) -> Option<&'static Hull> {
    match shape {
        Shape::Mesh(mesh) => mesh.hull,
        _ => None,
    }
}

/// Returns the point of a shape furthest along a direction (of a plane: its origin).
pub fn support(shape: &Shape<'static, f64>, pose: &Pose<f64>, n: V) -> V {
    let d = pose.rotation.transpose_mul(n);
    let s = shape.size();
    let signed = |size: f64, along: f64| size.copysign(along);
    let local = match shape.kind() {
        ShapeKind::Plane => V::ZERO,
        ShapeKind::Sphere => d * s.x,
        ShapeKind::Capsule => d * s.x + Vec3::new(0.0, 0.0, signed(s.y, d.z)),
        ShapeKind::Ellipsoid => {
            let scaled = d.scale_by(s);
            scaled.scale_by(s) * (1.0 / scaled.norm().max(1e-300))
        }
        ShapeKind::Cylinder => {
            let level = d.x.hypot(d.y).max(1e-300);
            Vec3::new(d.x / level * s.x, d.y / level * s.x, signed(s.y, d.z))
        }
        ShapeKind::Box => Vec3::new(signed(s.x, d.x), signed(s.y, d.y), signed(s.z, d.z)),
        ShapeKind::Mesh => farthest_vertex(mesh_hull(shape).unwrap(), d),
        ShapeKind::HeightField => unreachable!("not convex"),
    };
    pose.point(local)
}

/// Returns the distance of a point from a shape's surface: for ellipsoids to first order near the surface, for hulls
/// from the plane of a face.
pub fn off_surface(shape: &Shape<'static, f64>, pose: &Pose<f64>, point: V) -> f64 {
    let p = pose.local(point);
    let s = shape.size();
    let signed = match shape.kind() {
        ShapeKind::Plane => p.z,
        ShapeKind::Sphere => p.norm() - s.x,
        ShapeKind::Capsule => (p - Vec3::new(0.0, 0.0, p.z.clamp(-s.y, s.y))).norm() - s.x,
        ShapeKind::Ellipsoid => {
            let q = Vec3::new(p.x / s.x, p.y / s.y, p.z / s.z);
            let gradient = Vec3::new(q.x / s.x, q.y / s.y, q.z / s.z);
            (q.norm_squared() - 1.0) / (2.0 * gradient.norm())
        }
        ShapeKind::Cylinder => outside(&[p.x.hypot(p.y) - s.x, p.z.abs() - s.y]),
        ShapeKind::Box => outside(&[p.x.abs() - s.x, p.y.abs() - s.y, p.z.abs() - s.z]),
        ShapeKind::Mesh => {
            let hull = mesh_hull(shape).unwrap();
            let beyond = |face| hull.normal(face).dot(p) - hull.offset(face);
            (0..hull.face_count())
                .map(beyond)
                .fold(f64::NEG_INFINITY, f64::max)
        }
        ShapeKind::HeightField => unreachable!("not convex"),
    };
    signed.abs()
}

/// Returns the signed distance to a box-like shape from the excess over each of its sides.
fn outside(excess: &[f64]) -> f64 {
    let beyond = excess
        .iter()
        .map(|e| e.max(0.0).powi(2))
        .sum::<f64>()
        .sqrt();
    let within = excess.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if within > 0.0 { beyond } else { within }
}
