//! Code shared by the tests: random scenes, and their true contacts by methods that the library does not use.

// Each test uses a part of this module.

pub mod fields;
pub mod hulls;
pub mod placement;
pub mod truth;

use clench_collide::{ContactPoint, Contacts, Pose, Shape, ShapeKind, collide};
use clench_math::{Mat3, Quat, Real, Vec3};
pub use truth::{mesh_hull, off_surface, support};

pub type V = Vec3<f64>;

/// All convex shapes of finite size.
pub const BOUNDED: [ShapeKind; 6] = {
    use ShapeKind::*;
    [Sphere, Capsule, Ellipsoid, Cylinder, Box, Mesh]
};

/// All pairs of convex shapes that can collide.
pub const PAIRS: [(ShapeKind, ShapeKind); 27] = {
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
        (Plane, Mesh),
        (Sphere, Mesh),
        (Capsule, Mesh),
        (Ellipsoid, Mesh),
        (Cylinder, Mesh),
        (Box, Mesh),
        (Mesh, Mesh),
    ]
};

/// Returns true if a pair is collided by its support functions, with patches from its features.
pub fn by_support((a, b): (ShapeKind, ShapeKind)) -> bool {
    use ShapeKind::*;
    a != Plane && [a, b].iter().any(|kind| matches!(kind, Ellipsoid | Mesh))
        || matches!((a, b), (Cylinder, Cylinder | Box))
}

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
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.unit() * from.len() as f64) as usize]
    }
    /// Returns three lengths.
    pub fn size(&mut self, low: f64, high: f64) -> V {
        Vec3::new(
            self.range(low, high),
            self.range(low, high),
            self.range(low, high),
        )
    }
    pub fn shape(&mut self, kind: ShapeKind) -> Shape<'static, f64> {
        match kind {
            ShapeKind::Mesh => Shape::mesh(self.pick(hulls::wide())),
            _ => Shape::new(kind, self.size(0.05, 0.5)),
        }
    }
    /// Returns a random pair, near enough that most touch; sometimes aligned with the axes, on round coordinates.
    pub fn scene(&mut self, kinds: (ShapeKind, ShapeKind)) -> Scene {
        let (a, b) = (self.shape(kinds.0), self.shape(kinds.1));
        let pose = Pose {
            position: self.vector(),
            rotation: self.rotation(),
        };
        let reach = match kinds.0 {
            ShapeKind::Plane => b.bounding_radius(),
            _ => a.bounding_radius() + b.bounding_radius(),
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
            for shape in [&mut scene.a, &mut scene.b] {
                if shape.kind() != ShapeKind::Mesh {
                    *shape = shape.resized(grid(shape.size()));
                }
            }
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
    /// Returns an exact rotation of the cube onto itself.
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

/// Two shapes and their poses.
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
    /// Returns the deepest point.
    pub fn deepest(&self) -> Option<ContactPoint<f64>> {
        let contacts = self.contacts();
        let points = contacts.as_slice().iter();
        points
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
            .copied()
    }
}

/// Returns a shape in another number type, the same in every lane.
pub fn convert_shape<T: Real>(s: &Shape<'static, f64>) -> Shape<'static, T> {
    s.resized(Vec3::from_f64(s.size().to_array()))
}

/// Returns a pose in another number type, the same in every lane.
pub fn convert_pose<T: Real>(p: &Pose<f64>) -> Pose<T> {
    Pose {
        position: Vec3::from_f64(p.position.to_array()),
        rotation: Mat3 {
            rows: p.rotation.rows.map(|r| Vec3::from_f64(r.to_array())),
        },
    }
}
