//! What the tests share: random scenes, and the truth about them by means that the library does not use.

// Each test program uses a part of it.
#![allow(dead_code)]

use clench_collide::{ContactPoint, Contacts, Pose, Shape, ShapeKind, bounding_radius, collide};
use clench_math::{Mat3, Quat, Real, Vec3};

pub type V = Vec3<f64>;

/// All pairs that can collide.
pub const PAIRS: [(ShapeKind, ShapeKind); 20] = {
    use ShapeKind::*;
    [
        (Plane, Sphere),
        (Plane, Capsule),
        (Plane, Ellipsoid),
        (Plane, Cylinder),
        (Plane, Box),
        (Sphere, Sphere),
        (Sphere, Capsule),
        (Sphere, Ellipsoid),
        (Sphere, Cylinder),
        (Sphere, Box),
        (Capsule, Capsule),
        (Capsule, Ellipsoid),
        (Capsule, Cylinder),
        (Capsule, Box),
        (Ellipsoid, Ellipsoid),
        (Ellipsoid, Cylinder),
        (Ellipsoid, Box),
        (Cylinder, Cylinder),
        (Cylinder, Box),
        (Box, Box),
    ]
};

/// A small generator of random numbers (SplitMix64, Steele, Lea & Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    pub fn vector(&mut self) -> V {
        Vec3::new(
            self.range(-1.0, 1.0),
            self.range(-1.0, 1.0),
            self.range(-1.0, 1.0),
        )
    }
    pub fn direction(&mut self) -> V {
        loop {
            let v = self.vector();
            if (0.01..=1.0).contains(&v.norm_squared()) {
                return v.normalize().0;
            }
        }
    }
    pub fn rotation(&mut self) -> Mat3<f64> {
        Quat::from_axis_angle(self.direction(), self.range(0.0, 6.3)).to_matrix()
    }
    pub fn shape(&mut self, kind: ShapeKind) -> Shape<'static, f64> {
        let size = Vec3::new(
            self.range(0.05, 0.5),
            self.range(0.05, 0.5),
            self.range(0.05, 0.5),
        );
        Shape::new(kind, size)
    }
    /// A pair at random, near enough that most touch: sometimes aligned with the axes, on round coordinates.
    pub fn scene(&mut self, kinds: (ShapeKind, ShapeKind)) -> Scene {
        let (a, b) = (self.shape(kinds.0), self.shape(kinds.1));
        let pose = Pose {
            position: self.vector(),
            rotation: self.rotation(),
        };
        let reach = match kinds.0 {
            ShapeKind::Plane => bounding_radius(&b),
            _ => bounding_radius(&a) + bounding_radius(&b),
        };
        let direction = match kinds.0 {
            ShapeKind::Plane => pose.axis(),
            _ => self.direction(),
        };
        let offset = direction * (reach * self.range(0.0, 1.2));
        let mut scene = Scene {
            a,
            pose_a: pose,
            b,
            pose_b: Pose {
                position: pose.position + offset,
                rotation: self.rotation(),
            },
            margin: if self.unit() < 0.5 { 0.0 } else { 0.05 },
        };
        if self.unit() < 0.25 {
            let round = |v: V| Vec3::from_array(v.to_array().map(|x| (x * 10.0).round() / 10.0));
            scene.a.size = grid(a.size);
            scene.b.size = grid(b.size);
            scene.pose_a = Pose {
                position: V::ZERO,
                rotation: self.quarter_turns(),
            };
            scene.pose_b = Pose {
                position: round(offset),
                rotation: self.quarter_turns(),
            };
        }
        scene
    }
    /// An exact rotation of the cube onto itself.
    pub fn quarter_turns(&mut self) -> Mat3<f64> {
        let mut rotation = Mat3::IDENTITY;
        for _ in 0..(self.unit() * 6.0) as usize {
            let [x, y, z] = [0, 1, 2].map(|i| rotation.column(i));
            rotation = if self.unit() < 0.5 {
                Mat3::from_columns(y, -x, z)
            } else {
                Mat3::from_columns(x, z, -y)
            };
        }
        rotation
    }
}

fn grid(v: V) -> V {
    Vec3::from_array(v.to_array().map(|x| ((x * 10.0).round() / 10.0).max(0.1)))
}

/// Two shapes and where they are.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    pub a: Shape<'static, f64>,
    pub pose_a: Pose<f64>,
    pub b: Shape<'static, f64>,
    pub pose_b: Pose<f64>,
    pub margin: f64,
}

impl Scene {
    pub fn contacts(&self) -> Contacts<f64> {
        let mut out = Contacts::new();
        collide(
            &self.a,
            &self.pose_a,
            &self.b,
            &self.pose_b,
            self.margin,
            &mut out,
        );
        out
    }
    /// The deepest point.
    pub fn deepest(&self) -> Option<ContactPoint<f64>> {
        let contacts = self.contacts();
        let points = contacts.as_slice().iter();
        points
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
            .copied()
    }
    /// How far apart the shapes are along a direction from the first to the second; negative if they overlap.
    pub fn gap_along(&self, n: V) -> f64 {
        let back = support(&self.b, &self.pose_b, -n);
        let front = support(&self.a, &self.pose_a, n);
        (back - front).dot(n)
    }
    /// The signed distance of the shapes, which is the largest gap along any direction.
    pub fn distance(&self, random: &mut Random) -> f64 {
        self.optima(random)[0].0
    }
    /// The directions of largest gap, by search, best first: many starts, each improved by random steps that shrink when they
    /// fail. The gap has creases across the shapes' own axes, so some steps go along those.
    pub fn optima(&self, random: &mut Random) -> Vec<(f64, V)> {
        if self.a.kind == ShapeKind::Plane {
            let normal = self.pose_a.axis();
            return vec![(self.gap_along(normal), normal)];
        }
        let axes = [&self.pose_a, &self.pose_b].map(|p| [0, 1, 2].map(|i| p.rotation.column(i)));
        let mut starts: Vec<V> = (0..200).map(|_| random.direction()).collect();
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
        let climb = |&(mut best, mut n): &(f64, V)| {
            let mut step = 0.3;
            while step > 1e-8 {
                let mut tried = n + random.direction() * step;
                let crease = axes.as_flattened().get((random.unit() * 12.0) as usize);
                if let Some(u) = crease {
                    tried = tried - *u * u.dot(tried);
                }
                let (tried, _) = tried.normalize();
                let gap = self.gap_along(tried);
                if gap > best {
                    (best, n) = (gap, tried);
                    step *= 1.5;
                } else {
                    step *= 0.98;
                }
            }
            (best, n)
        };
        let mut optima: Vec<_> = starts.iter().map(climb).collect();
        optima.sort_by(|a, b| b.0.total_cmp(&a.0));
        optima
    }
}

/// The point of a shape furthest along a direction (of a plane: its origin).
pub fn support(shape: &Shape<'static, f64>, pose: &Pose<f64>, n: V) -> V {
    let d = pose.rotation.transpose_mul(n);
    let s = shape.size;
    let signed = |size: f64, along: f64| size.copysign(along);
    let local = match shape.kind {
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
        ShapeKind::HeightField | ShapeKind::Mesh => unreachable!("no size tells its points"),
    };
    pose.point(local)
}

/// How far a point is from a shape's surface. (For ellipsoids, to first order near the surface.)
pub fn off_surface(shape: &Shape<'static, f64>, pose: &Pose<f64>, point: V) -> f64 {
    let p = pose.local(point);
    let s = shape.size;
    let signed = match shape.kind {
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
        ShapeKind::HeightField | ShapeKind::Mesh => unreachable!("no size tells its surface"),
    };
    signed.abs()
}

/// Signed distance to a box-like shape from the excess over each of its sides.
fn outside(excess: &[f64]) -> f64 {
    let beyond = excess
        .iter()
        .map(|e| e.max(0.0).powi(2))
        .sum::<f64>()
        .sqrt();
    let within = excess.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if within > 0.0 { beyond } else { within }
}

/// A shape in another number type, the same in every lane.
pub fn convert_shape<T: Real>(s: &Shape<'static, f64>) -> Shape<'static, T> {
    Shape::new(s.kind, Vec3::from_f64(s.size.to_array()))
}

/// A pose in another number type, the same in every lane.
pub fn convert_pose<T: Real>(p: &Pose<f64>) -> Pose<T> {
    Pose {
        position: Vec3::from_f64(p.position.to_array()),
        rotation: Mat3 {
            rows: p.rotation.rows.map(|r| Vec3::from_f64(r.to_array())),
        },
    }
}
