//! Hulls are closed, convex, contain every point, and preserve the shape of thin, fine and degenerate clouds.

use clench_collide::{Hull, HullError, convex_hull};
use clench_math::{Quat, Vec3};
use std::collections::HashMap;

/// A small generator of numbers between -1 and 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.next(), self.next(), self.next())
    }
    fn turn(&mut self) -> Quat<f64> {
        Quat::new(self.next(), self.next(), self.next(), self.next()).normalize()
    }
}

fn corners_of_box(half: [f64; 3]) -> Vec<Vec3<f64>> {
    let side = |i: usize, axis: usize| match i >> axis & 1 {
        1 => half[axis],
        _ => -half[axis],
    };
    (0..8)
        .map(|i| Vec3::new(side(i, 0), side(i, 1), side(i, 2)))
        .collect()
}

/// Rounds a point to single precision, as files store coordinates.
fn in_f32(point: Vec3<f64>) -> Vec3<f64> {
    Vec3::from_array(point.to_array().map(|x| f64::from(x as f32)))
}

/// Returns named clouds of all kinds.
fn clouds() -> Vec<(String, Vec<Vec3<f64>>)> {
    let mut noise = Noise(88_172_645_463_325_252);
    let mut clouds = Vec::new();
    for round in 0..20 {
        let turn = noise.turn();
        let n = 4 + round * 7;
        let mut add = |name: &str, points: Vec<Vec3<f64>>| {
            clouds.push((format!("{name} {round}"), points.clone()));
            let turned = points.iter().map(|&p| in_f32(turn.rotate(p)));
            clouds.push((format!("turned {name} {round}"), turned.collect()));
        };
        add(
            "ball",
            (0..n).map(|_| noise.vector().normalize().0).collect(),
        );
        add("cloud", (0..n).map(|_| noise.vector()).collect());
        let lattice = |_| {
            let v = noise.vector() * 2.0;
            Vec3::new(v.x.round(), v.y.round(), v.z.round())
        };
        let mut points: Vec<_> = (0..3 * n).map(lattice).collect();
        points.extend(corners_of_box([2.0; 3]));
        add("lattice with duplicates", points);
        let ring = |i: usize| {
            let (sin, cos) = (i as f64 * std::f64::consts::TAU / n as f64).sin_cos();
            [-1.0, 0.0, 1.0].map(|z| Vec3::new(cos, sin, z))
        };
        add("cylinder", (0..n).flat_map(ring).collect());
        let rounded = corners_of_box([1.0; 3])
            .into_iter()
            .flat_map(|corner| (0..n).map(move |_| corner))
            .map(|corner| corner + noise.vector() * 1e-8);
        add("box with tiny triangles at its corners", rounded.collect());
        let thin = 10f64.powi(-(round as i32) / 2);
        let plate = (0..n).map(|_| noise.vector().scale_by(Vec3::new(1.0, 1.0, thin)));
        add("plate", plate.collect());
    }
    clouds
}

#[test]
fn a_surface_is_closed_and_holds_every_point() {
    for (name, points) in clouds() {
        let surface = match convex_hull(&points, None) {
            Ok(surface) => surface,
            Err(error) => panic!("{name}: {error}"),
        };
        let triangles = surface.triangles();
        let mut edges = HashMap::new();
        for &[a, b, c] in triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                assert!(edges.insert(edge, ()).is_none(), "{name}: edge twice");
            }
        }
        assert!(
            edges.keys().all(|&(a, b)| edges.contains_key(&(b, a))),
            "{name}: open"
        );
        let mut corners: Vec<u32> = triangles.as_flattened().to_vec();
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(triangles.len(), 2 * corners.len() - 4, "{name}: no sphere");
        let at = |i: u32| points[i as usize];
        for &[a, b, c] in triangles {
            let normal = (at(b) - at(a)).cross(at(c) - at(a));
            for &p in &points {
                let rounding = 1e-14 * (at(b) - at(a)).norm() * (at(c) - at(a)).norm();
                assert!(normal.dot(p - at(a)) <= rounding, "{name}: point outside");
            }
        }
    }
}

#[test]
fn a_hull_has_flat_faces_and_finds_the_farthest_vertex() {
    let mut noise = Noise(362_436_069_521_288_629);
    for (name, points) in clouds() {
        let surface = convex_hull(&points, None).unwrap();
        let hull = Hull::new(&surface, &points);
        let size = hull.radius();
        for face in 0..hull.face_count() {
            let (normal, offset) = (hull.normal(face), hull.offset(face));
            assert!((normal.norm() - 1.0).abs() < 1e-12, "{name}");
            assert!(normal.dot(hull.center()) < offset, "{name}: center outside");
            for &vertex in hull.corners(face) {
                let depth = offset - normal.dot(hull.vertices()[vertex as usize]);
                assert!((0.0..=4e-6 * size).contains(&depth), "{name}: {depth}");
                assert!(hull.faces_at(vertex as usize).contains(&(face as u32)));
            }
            let beyond = (hull.vertices().iter()).map(|v| normal.dot(*v) - offset);
            assert!(beyond.fold(0.0, f64::max) <= 1e-14 * size, "{name}");
        }
        for start in 0..hull.vertices().len().min(20) {
            assert!(!hull.faces_at(start).is_empty(), "{name}");
            let direction = noise.vector();
            let found = hull.vertices()[hull.support(direction)].dot(direction);
            let farthest = (points.iter())
                .map(|p| p.dot(direction))
                .fold(f64::MIN, f64::max);
            assert!(
                farthest - found <= 1e-14 * size,
                "{name}: {found} {farthest}"
            );
        }
    }
}

/// Tests few vertices, many, and enough in a small range of normals that the search must climb.
#[test]
fn the_farthest_vertex_is_found_along_any_direction() {
    let mut noise = Noise(104_729);
    let mut ball = |count: usize, squash: f64| -> Vec<Vec3<f64>> {
        let point = |_| noise.vector().normalize().0;
        let squashed = |p: Vec3<f64>| Vec3::new(p.x, p.y, squash * p.z);
        (0..count).map(point).map(squashed).collect()
    };
    let clouds = [ball(40, 1.0), ball(400, 0.7), ball(2000, 1e-3)];
    let mut noise = Noise(7919);
    for points in clouds {
        let hull = Hull::new(&convex_hull(&points, None).unwrap(), &points);
        let size = hull.radius();
        let steps = || -4..=4;
        let lattice = steps()
            .flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])))
            .map(|d| Vec3::from_array(d.map(f64::from)));
        for d in lattice {
            for (tilt, length) in [(0.0, 1.0), (1e-9, 1e-9), (1e-3, 1e9)] {
                let direction = (d + noise.vector() * tilt) * length;
                let reach = |v: &Vec3<f64>| v.dot(direction);
                let found = reach(&hull.vertices()[hull.support(direction)]);
                let farthest = hull.vertices().iter().map(reach).fold(f64::MIN, f64::max);
                let rounding = 1e-14 * size * direction.norm();
                assert!(
                    farthest - found <= rounding,
                    "{direction:?}: {found} {farthest}"
                );
            }
        }
        for nonsense in [f64::NAN, f64::INFINITY] {
            let vertex = hull.support(Vec3::new(nonsense, 0.0, nonsense));
            assert!(vertex < hull.vertices().len());
        }
    }
}

/// Files have zeros that are not quite zero.
#[test]
fn points_that_only_noise_parts_hide_no_vertex() {
    let mut noise = Noise(15_485_863);
    let mut points = Vec::new();
    for _ in 0..300 {
        let p = noise.vector().normalize().0;
        let rim = Vec3::new(0.0, p.y, p.z).normalize().0;
        points.extend([
            p,
            Vec3::new(5e-18, rim.y, rim.z),
            Vec3::new(-5e-18, rim.y, rim.z),
        ]);
    }
    let surface = convex_hull(&points, None).expect("a hull");
    for _ in 0..20 {
        let turn = noise.turn();
        let turned = Vec::from_iter(points.iter().map(|&p| turn.rotate(p)));
        let hull = Hull::new(&surface, &turned);
        for _ in 0..200 {
            let direction = noise.vector().normalize().0;
            let reach = |v: &Vec3<f64>| v.dot(direction);
            let found = reach(&hull.vertices()[hull.support(direction)]);
            let farthest = turned.iter().map(reach).fold(f64::MIN, f64::max);
            assert!(farthest - found <= 1e-14, "{found} {farthest}");
        }
    }
}

#[test]
fn boxes_have_six_faces_however_thin_and_turned() {
    let mut noise = Noise(521_288_629_362_436_069);
    for thin in [1.0, 1e-2, 1e-4, 1e-6] {
        let corners = corners_of_box([0.5, 0.5, 0.5 * thin]);
        for _ in 0..50 {
            let turn = noise.turn();
            let points: Vec<_> = corners.iter().map(|&p| turn.rotate(p)).collect();
            let hull = Hull::new(&convex_hull(&points, None).unwrap(), &points);
            assert_eq!(hull.vertices().len(), 8);
            if thin >= 1e-4 {
                assert_eq!(hull.face_count(), 6, "thin {thin}");
            }
            let up = turn.rotate(Vec3::new(0.0, 0.0, 1.0));
            let reach = hull.vertices()[hull.support(up)].dot(up);
            assert!((reach - 0.5 * thin).abs() < 1e-15, "thickness lost");
        }
    }
}

#[test]
fn a_mirrored_hull_keeps_its_outside() {
    let points = corners_of_box([0.1, 0.2, 0.3]);
    let surface = convex_hull(&points, None).unwrap();
    let mirrored: Vec<_> = points.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect();
    let hull = Hull::new(&surface, &mirrored);
    for face in 0..hull.face_count() {
        assert!(hull.offset(face) > 0.0);
        assert_eq!(hull.corners(face).len(), 4);
    }
}

#[test]
fn the_bound_keeps_the_farthest_points() {
    let mut noise = Noise(123_456_789);
    let points: Vec<_> = (0..2000).map(|_| noise.vector().normalize().0).collect();
    for bound in [4, 5, 32, 200] {
        let hull = Hull::new(&convex_hull(&points, Some(bound)).unwrap(), &points);
        assert_eq!(hull.vertices().len(), bound);
        let inner = (0..hull.face_count()).map(|face| hull.offset(face));
        let least = inner.fold(f64::INFINITY, f64::min);
        assert!(bound < 100 || least > 0.95, "{bound}: {least}");
    }
    let roomy = convex_hull(&points, Some(5000)).unwrap();
    assert!(roomy == convex_hull(&points, None).unwrap());
}

#[test]
fn clouds_without_an_inside_are_refused() {
    let line = |i: usize| Vec3::new(0.1, 0.7, 0.3) * i as f64;
    let mut plane = Vec::new();
    let turn = Noise(42).turn();
    for i in 0..5 {
        for j in 0..5 {
            plane.push(turn.rotate(Vec3::new(i as f64 * 0.1, j as f64 * 0.1, 0.2)));
        }
    }
    let refused = |points: &[Vec3<f64>]| convex_hull(points, None).unwrap_err();
    assert_eq!(refused(&[Vec3::ZERO; 3]), HullError::TooFew(3));
    assert_eq!(refused(&[Vec3::new(1.0, 2.0, 3.0); 9]), HullError::Point);
    assert_eq!(
        refused(&(0..9).map(line).collect::<Vec<_>>()),
        HullError::Line
    );
    assert_eq!(refused(&plane), HullError::Plane);
    let mut bad = corners_of_box([1.0; 3]);
    assert_eq!(convex_hull(&bad, Some(3)).unwrap_err(), HullError::Bound(3));
    for number in [f64::NAN, f64::INFINITY, 1e61] {
        bad[5].y = number;
        assert_eq!(refused(&bad), HullError::NotFinite(5));
    }
}

#[test]
fn extreme_sizes_are_supported() {
    for size in [1e-70, 1e-50, 1e-20, 1e20, 1e59] {
        let points = corners_of_box([size, 2.0 * size, 3.0 * size]);
        match convex_hull(&points, None) {
            Ok(surface) => assert_eq!(surface.triangles().len(), 12),
            Err(error) => assert_eq!((size, error), (1e-70, HullError::Point)),
        }
    }
}
