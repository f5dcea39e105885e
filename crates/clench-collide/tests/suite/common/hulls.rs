//! Hulls to collide, created once because shapes borrow them for as long as the tests run.

use super::{Random, V};
use clench_collide::{Hull, convex_hull};
use clench_math::Vec3;
use std::sync::OnceLock;

/// Returns the hull of points that have one.
pub fn hull_of(points: &[V]) -> &'static Hull {
    let surface = convex_hull(points, None).unwrap();
    Box::leak(Box::new(Hull::new(&surface, points)))
}

/// Returns the corners of a box with the given half lengths.
pub fn corners(half: V) -> Vec<V> {
    let sign = |k: usize, axis: usize| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |k| half.scale_by(Vec3::new(sign(k, 0), sign(k, 1), sign(k, 2)));
    (0..8).map(corner).collect()
}

/// Returns the cap circles of a cylinder about z, `sides` points each.
pub fn cap_circles(radius: f64, half_length: f64, sides: usize) -> Vec<V> {
    let at = |k: usize| (k as f64 * std::f64::consts::TAU / sides as f64).sin_cos();
    let ends = [-half_length, half_length];
    let circle = |z| (0..sides).map(move |k| Vec3::new(radius * at(k).1, radius * at(k).0, z));
    ends.into_iter().flat_map(circle).collect()
}

/// Returns points on an ellipsoid with these semi-axes.
pub fn round(random: &mut Random, count: usize, semi_axes: V) -> Vec<V> {
    (0..count)
        .map(|_| random.direction().scale_by(semi_axes))
        .collect()
}

/// Returns hulls about as large as the other shapes of random scenes: 5 cm to half a metre.
pub fn wide() -> &'static [&'static Hull] {
    static HULLS: OnceLock<Vec<&Hull>> = OnceLock::new();
    HULLS.get_or_init(|| some_of_all(0.05, 0.5))
}

/// Returns hulls of about 10 cm.
pub fn handy() -> &'static [&'static Hull] {
    static HULLS: OnceLock<Vec<&Hull>> = OnceLock::new();
    HULLS.get_or_init(|| some_of_all(0.04, 0.12))
}

/// Returns random hulls of 6 to 60 vertices, one of a thousand, boxes, prisms in place of cylinders and thin plates,
/// centred on the origin or not.
fn some_of_all(low: f64, high: f64) -> Vec<&'static Hull> {
    let mut random = Random(77);
    let mut hulls = Vec::new();
    for k in 0..12 {
        let size = random.size(low, high);
        hulls.push(hull_of(&round(&mut random, 6 + 5 * k, size)));
        let beside = size.scale_by(random.vector());
        let boxed = corners(size).into_iter().map(|p| p + beside);
        hulls.push(hull_of(&boxed.collect::<Vec<_>>()));
        hulls.push(hull_of(&cap_circles(size.x, size.y, 5 + 2 * k)));
    }
    let size = random.size(low, high);
    for thin in [1e-2, 1e-4] {
        hulls.push(hull_of(&corners(Vec3::new(size.x, size.y, thin * size.z))));
    }
    hulls.push(hull_of(&round(&mut random, 1000, size)));
    hulls
}

/// Returns hulls that are huge, tiny, or as thin as a needle or a leaf.
pub fn degenerate() -> &'static [&'static Hull] {
    static HULLS: OnceLock<Vec<&Hull>> = OnceLock::new();
    HULLS.get_or_init(|| {
        let mut random = Random(78);
        let mut hulls = Vec::new();
        while hulls.len() < 60 {
            let lengths = [1e-6, 1e-3, 0.1, 0.3, 1e3];
            let mut length = || lengths[(random.unit() * 5.0) as usize];
            let size = Vec3::new(length(), length(), length());
            let points = match hulls.len() % 3 {
                0 => corners(size),
                1 => cap_circles(size.x, size.y, 16),
                _ => round(&mut random, 20, size),
            };
            if convex_hull(&points, None).is_ok() {
                hulls.push(hull_of(&points));
            }
        }
        hulls
    })
}

/// Returns a crumpled ball.
pub fn bumpy(random: &mut Random) -> (Vec<V>, Vec<[u32; 3]>) {
    let (rings, around) = (9, 14);
    let mut vertices = Vec::new();
    for ring in 0..=rings {
        for k in 0..around {
            let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let azimuth = std::f64::consts::TAU * f64::from(k) / f64::from(around);
            let pole = ring == 0 || ring == rings;
            let radius = if pole { 0.3 } else { random.range(0.2, 0.5) };
            let (sine, cosine) = polar.sin_cos();
            // The vertices at a pole coincide, without a gap.
            let sine = if pole { 0.0 } else { sine };
            vertices.push(Vec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine) * radius);
        }
    }
    let at = |ring: i32, k: i32| (ring * around + k % around) as u32;
    let mut faces = Vec::new();
    for ring in 0..rings {
        for k in 0..around {
            faces.push([at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)]);
            faces.push([at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)]);
        }
    }
    (vertices, faces)
}
