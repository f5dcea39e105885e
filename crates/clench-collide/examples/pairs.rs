//! How long each pair of shapes takes: `cargo run --release -p clench-collide --example pairs`.
//!
//! A thousand random poses a pair, of shapes about 10 cm large that overlap by 0 to 1 cm. One line a pair: the time of a call
//! in nanoseconds, the best of some runs, and how many points it yields.

use clench_collide::{Contacts, Pose, Shape, ShapeKind, collide, supported};
use clench_math::{Quat, Vec3};
use std::time::Instant;

const POSES: usize = 1000;
const RUNS: usize = 50;
const KINDS: [ShapeKind; 6] = [
    ShapeKind::Plane,
    ShapeKind::Sphere,
    ShapeKind::Capsule,
    ShapeKind::Ellipsoid,
    ShapeKind::Cylinder,
    ShapeKind::Box,
];

type Scene = (
    Shape<'static, f64>,
    Pose<f64>,
    Shape<'static, f64>,
    Pose<f64>,
);

/// Random numbers in [0, 1) (SplitMix64, Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - Vec3::new(1.0, 1.0, 1.0)
    }
    fn shape(&mut self, kind: ShapeKind) -> Shape<'static, f64> {
        let size = self.vector() * 0.04 + Vec3::new(0.08, 0.08, 0.08);
        Shape::new(kind, size)
    }
    fn pose(&mut self) -> Pose<f64> {
        Pose {
            position: self.vector(),
            rotation: Quat::from_rotation_vector(self.vector() * 3.0).to_matrix(),
        }
    }
    /// Two shapes, moved together until they overlap by `depth`.
    fn scene(&mut self, a: ShapeKind, b: ShapeKind) -> Scene {
        let (a, b) = (self.shape(a), self.shape(b));
        let (pose_a, mut pose_b) = (self.pose(), self.pose());
        let direction = match a.kind {
            ShapeKind::Plane => pose_a.axis(),
            _ => self.vector().normalize().0,
        };
        let depth = 0.01 * self.unit();
        let (mut near, mut far) = (0.0, 0.6);
        let mut out = Contacts::new();
        for _ in 0..30 {
            let middle = (near + far) / 2.0;
            pose_b.position = pose_a.position + direction * middle;
            collide(&a, &pose_a, &b, &pose_b, 0.0, &mut out);
            let deep = out.as_slice().iter().any(|c| c.distance < -depth);
            *(if deep { &mut near } else { &mut far }) = middle;
        }
        pose_b.position = pose_a.position + direction * near;
        (a, pose_a, b, pose_b)
    }
}

fn main() {
    println!("{:<24}{:>8}{:>8}", "pair", "ns", "points");
    for (k, &a) in KINDS.iter().enumerate() {
        for &b in KINDS[k..].iter().filter(|b| supported(a, **b)) {
            let mut random = Random(1);
            let scenes: Vec<Scene> = (0..POSES).map(|_| random.scene(a, b)).collect();
            let mut out = Contacts::new();
            let (mut best, mut points) = (f64::INFINITY, 0);
            for _ in 0..RUNS {
                points = 0;
                let start = Instant::now();
                for (a, pose_a, b, pose_b) in &scenes {
                    collide(a, pose_a, b, pose_b, 0.0, &mut out);
                    points += out.as_slice().len();
                }
                best = best.min(start.elapsed().as_secs_f64());
            }
            let name = format!("{a:?}-{b:?}");
            let (time, mean) = (best * 1e9 / POSES as f64, points as f64 / POSES as f64);
            println!("{name:<24}{time:>8.0}{mean:>8.2}");
        }
    }
}
