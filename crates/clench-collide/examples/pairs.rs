//! Times each pair of shapes: `cargo run --release -p clench-collide --example pairs`.
//!
//! Each pair has a thousand poses of shapes about 10 cm large, on terrain with cells of 5 cm. Of every four, two
//! overlap by 0 to 1 cm at random, one rests face to face, tilted by up to 1e-3 rad, and one misses by up to 1 cm. The
//! output has one line per pair: the time of a call in nanoseconds, the best of several runs, and the number of points.
//! With `--json` the poses are included, so that another engine can be timed on them. `--list` prints the names of all
//! pairs; names such as `box-hull` select some.

use clench_collide::{
    Contacts, HeightField, Hull, Pose, Shape, ShapeKind, collide, convex_hull, supported,
};
use clench_math::{Quat, Vec3};
use std::time::Instant;

const POSES: usize = 1000;
const RUNS: usize = 20;

/// The name and kind of each shape, and the number of vertices of a hull.
const SUBJECTS: [(&str, ShapeKind, usize); 9] = [
    ("plane", ShapeKind::Plane, 0),
    ("terrain", ShapeKind::HeightField, 0),
    ("sphere", ShapeKind::Sphere, 0),
    ("capsule", ShapeKind::Capsule, 0),
    ("ellipsoid", ShapeKind::Ellipsoid, 0),
    ("cylinder", ShapeKind::Cylinder, 0),
    ("box", ShapeKind::Box, 0),
    ("hull", ShapeKind::Mesh, 30),
    ("hull of 1000", ShapeKind::Mesh, 1000),
];

/// The terrain: points along a side, and size in metres. Cells are about half as large as a body.
const GRID: usize = 41;
const TERRAIN: [f64; 4] = [1.0, 1.0, 0.04, 0.1];

/// The hulls and the terrain that shapes refer to.
struct Assets {
    hulls: Vec<Hull>,
    terrain: Option<HeightField>,
}

impl Assets {
    fn of((_, kind, vertices): (&str, ShapeKind, usize), random: &mut Random) -> Self {
        let count = if kind == ShapeKind::Mesh { 10 } else { 0 };
        Assets {
            hulls: (0..count).map(|_| random.hull(vertices)).collect(),
            terrain: (kind == ShapeKind::HeightField).then(|| random.terrain()),
        }
    }
    fn json(&self) -> String {
        let hulls = self.hulls.iter().map(|hull| {
            let vertices = hull.vertices().iter().map(|v| v.to_array());
            format!("{:?}", vertices.collect::<Vec<_>>())
        });
        let heights = self.terrain.as_ref().map_or(&[][..], HeightField::heights);
        let hulls = joined(hulls);
        format!(
            r#"{{"hulls": {hulls}, "heights": {heights:?}, "grid": {GRID}, "terrain": {TERRAIN:?}}}"#
        )
    }
}

/// A shape with its pose.
struct Body<'a> {
    shape: Shape<'a, f64>,
    /// The index of its hull.
    hull: usize,
    position: Vec3<f64>,
    rotation: Quat<f64>,
}

impl Body<'_> {
    fn pose(&self) -> Pose<f64> {
        Pose {
            position: self.position,
            rotation: self.rotation.to_matrix(),
        }
    }
    fn json(&self) -> String {
        let (size, position) = (self.shape.size().to_array(), self.position.to_array());
        let Quat { w, x, y, z } = self.rotation;
        let hull = self.hull;
        format!(
            r#"{{"size": {size:?}, "hull": {hull}, "pos": {position:?}, "quat": {:?}}}"#,
            [w, x, y, z]
        )
    }
}

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
    fn rotation(&mut self) -> Quat<f64> {
        Quat::from_rotation_vector(self.vector() * 3.0)
    }
    /// Returns the hull of points on an ellipsoid of about 8 cm, all of which are vertices.
    fn hull(&mut self, vertices: usize) -> Hull {
        let semi_axes = self.vector() * 0.04 + Vec3::new(0.08, 0.08, 0.08);
        let point = |_| self.vector().normalize().0.scale_by(semi_axes);
        let points: Vec<Vec3<f64>> = (0..vertices).map(point).collect();
        let surface = convex_hull(&points, None).expect("points on an ellipsoid have a hull");
        Hull::new(&surface, &points)
    }
    /// Returns random heights, each the mean of four.
    fn terrain(&mut self) -> HeightField {
        let heights =
            (0..GRID * GRID).map(|_| self.unit() + self.unit() + self.unit() + self.unit());
        HeightField::new(GRID, GRID, heights.collect(), TERRAIN).expect("a grid of heights")
    }
    fn body<'a>(&mut self, kind: ShapeKind, assets: &'a Assets) -> Body<'a> {
        let size = self.vector() * 0.04 + Vec3::new(0.08, 0.08, 0.08);
        let hull = (self.unit() * assets.hulls.len() as f64) as usize;
        Body {
            shape: match (assets.hulls.get(hull), &assets.terrain) {
                (Some(hull), _) => Shape::mesh(hull),
                (_, Some(field)) => Shape::height_field(field),
                _ => Shape::new(kind, size),
            },
            hull,
            position: self.vector(),
            rotation: self.rotation(),
        }
    }
    /// Returns a rotation by quarter turns and a random yaw, tilted slightly.
    fn upright(&mut self, tilt: f64) -> Quat<f64> {
        let quarter = Vec3::new(self.unit(), self.unit(), self.unit()) * 3.0;
        let turns = [quarter.x, quarter.y].map(|x| x.floor() * std::f64::consts::FRAC_PI_2);
        let about = |axis, angle| Quat::from_axis_angle(axis, angle);
        let yaw = about(Vec3::new(0.0, 0.0, 1.0), 6.0 * self.unit());
        Quat::from_rotation_vector(self.vector() * tilt)
            * yaw
            * about(Vec3::new(1.0, 0.0, 0.0), turns[0])
            * about(Vec3::new(0.0, 1.0, 0.0), turns[1])
    }
    /// Moves two bodies together until they overlap by the intended depth.
    fn scene<'a>(&mut self, mut a: Body<'a>, mut b: Body<'a>, k: usize) -> (Body<'a>, Body<'a>) {
        let mut direction = self.vector().normalize().0;
        let depth = 0.01 * self.unit() * if k % 4 == 3 { -1.0 } else { 1.0 };
        if k % 4 == 2 {
            (a.rotation, b.rotation) = (self.upright(0.0), self.upright(1e-3));
            direction = (Vec3::new(0.0, 0.0, 1.0) + self.vector() * 0.2)
                .normalize()
                .0;
        }
        let mut beside = Vec3::ZERO;
        if matches!(a.shape.kind(), ShapeKind::Plane | ShapeKind::HeightField) {
            direction = a.pose().axis();
        }
        if a.shape.kind() == ShapeKind::HeightField {
            beside = a.pose().rotation * self.vector().scale_by(Vec3::new(0.7, 0.7, 0.0));
        }
        let (mut near, mut far) = (0.0, 0.6);
        let mut out = Contacts::new();
        for _ in 0..30 {
            let middle = (near + far) / 2.0;
            b.position = a.position + beside + direction * middle;
            collide(&a.shape, &a.pose(), &b.shape, &b.pose(), 0.02, &mut out);
            let deep = out.as_slice().iter().any(|c| c.distance < -depth);
            *(if deep { &mut near } else { &mut far }) = middle;
        }
        b.position = a.position + beside + direction * near;
        (a, b)
    }
}

fn main() {
    let (flags, names): (Vec<_>, Vec<_>) = std::env::args()
        .skip(1)
        .partition(|arg| arg.starts_with("--"));
    let set = |flag: &str| flags.iter().any(|f| f == flag);
    let (only_list, json) = (set("--list"), set("--json"));
    if !only_list && !json {
        println!("{:<30}{:>8}{:>8}", "pair", "ns", "points");
    }
    for (k, &a) in SUBJECTS.iter().enumerate() {
        for &b in SUBJECTS[k..].iter().filter(|b| supported(a.1, b.1)) {
            let name = format!("{}-{}", a.0, b.0);
            if !names.is_empty() && !names.contains(&name) {
                continue;
            }
            match only_list {
                true => println!("{name}"),
                false => measure(&name, a, b, json),
            }
        }
    }
}

fn measure(name: &str, a: (&str, ShapeKind, usize), b: (&str, ShapeKind, usize), json: bool) {
    let mut random = Random(1);
    let assets = [a, b].map(|subject| Assets::of(subject, &mut random));
    let scenes: Vec<(Body, Body)> = (0..POSES)
        .map(|k| {
            let (a, b) = (random.body(a.1, &assets[0]), random.body(b.1, &assets[1]));
            random.scene(a, b, k)
        })
        .collect();
    let placed: Vec<_> = (scenes.iter())
        .map(|(a, b)| (a.shape, a.pose(), b.shape, b.pose()))
        .collect();
    let mut out = Contacts::new();
    let (mut best, mut points) = (f64::INFINITY, 0);
    for _ in 0..RUNS {
        points = 0;
        let start = Instant::now();
        for (a, pose_a, b, pose_b) in &placed {
            collide(a, pose_a, b, pose_b, 0.0, &mut out);
            points += out.as_slice().len();
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    let (time, mean) = (best * 1e9 / POSES as f64, points as f64 / POSES as f64);
    if !json {
        println!("{name:<30}{time:>8.0}{mean:>8.2}");
        return;
    }
    let bodies = joined(scenes.iter().map(|(a, b)| joined([a.json(), b.json()])));
    println!(
        r#"{{"pair": {:?}, "ns": {time}, "points": {mean}, "assets": {}, "bodies": {bodies}}}"#,
        [a.0, b.0],
        joined(assets.each_ref().map(Assets::json)),
    );
}

fn joined(items: impl IntoIterator<Item = String>) -> String {
    let items: Vec<String> = items.into_iter().collect();
    format!("[{}]", items.join(", "))
}
