//! Shapes on rough ground, compared with brute force: spheres with the nearest of all triangles, every shape with the
//! nearest of the hulls below them.

use crate::common::{
    Random, V,
    fields::{KINDS, deepest, rough, touch},
    hulls::hull_of,
};
use clench_collide::{Contacts, HeightField, Hull, Pose, Shape, ShapeKind, collide};
use clench_math::Vec3;

/// Returns the corners of all triangles of the surface.
pub fn triangles(field: &HeightField) -> Vec<[V; 3]> {
    let mut found = Vec::new();
    for row in 0..field.rows() - 1 {
        for column in 0..field.columns() - 1 {
            let p = |r, c| field.point(row + r, column + c);
            found.push([p(0, 0), p(1, 1), p(1, 0)]);
            found.push([p(0, 0), p(0, 1), p(1, 1)]);
        }
    }
    found
}

/// Returns the point of a triangle nearest to a point: in its interior or on a side.
fn nearest([a, b, c]: [V; 3], p: V) -> V {
    let n = (b - a).cross(c - a).normalize().0;
    let foot = p - n * n.dot(p - a);
    let sides = [(a, b), (b, c), (c, a)];
    if sides
        .iter()
        .all(|(a, b)| (*b - *a).cross(foot - *a).dot(n) >= 0.0)
    {
        return foot;
    }
    let on_side = |(a, b): (V, V)| {
        let t = (p - a).dot(b - a) / (b - a).norm_squared();
        a + (b - a) * t.clamp(0.0, 1.0)
    };
    let points = sides.map(on_side);
    let best = points
        .into_iter()
        .min_by(|q, r| (*q - p).norm().total_cmp(&(*r - p).norm()));
    best.unwrap()
}

#[test]
fn spheres_are_as_far_as_the_nearest_triangle() {
    let mut random = Random(3);
    let (mut touching, mut apart) = (0, 0);
    for k in 0..60 {
        let ground = rough(&mut random, 2 + k % 9, 3 + k % 7, [0.02, 0.1, 0.3][k % 3]);
        let surface = triangles(&ground);
        for _ in 0..30 {
            let radius = random.range(0.02, 0.15);
            let (x, y) = (random.range(-0.35, 0.35), random.range(-0.25, 0.25));
            let center = Vec3::new(x, y, random.range(0.0, 0.45));
            let points = surface.iter().map(|t| nearest(*t, center));
            let foot = points
                .min_by(|p, q| (*p - center).norm().total_cmp(&(*q - center).norm()))
                .unwrap();
            let above = surface.iter().all(|[a, b, c]| {
                let n = (*b - *a).cross(*c - *a);
                let over = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| {
                    (q.x - p.x) * (center.y - p.y) - (q.y - p.y) * (center.x - p.x) >= 0.0
                });
                !over || n.dot(center - *a) > 0.0
            });
            if !above {
                continue;
            }
            let truth = (foot - center).norm() - radius;
            let found = touch(
                &ground,
                &Shape::new(ShapeKind::Sphere, Vec3::new(radius, 0.0, 0.0)),
                &Pose {
                    position: center,
                    ..Pose::IDENTITY
                },
                0.01,
            );
            if truth > 0.01 {
                apart += 1;
                assert!(found.as_slice().is_empty());
                continue;
            }
            touching += 1;
            let first = found
                .as_slice()
                .iter()
                .min_by(|p, q| p.distance.total_cmp(&q.distance));
            let first = first.expect("a contact");
            assert!(
                (first.distance - truth).abs() < 1e-9,
                "{} for {truth}",
                first.distance
            );
            let normal = (center - foot).normalize().0;
            assert!(
                (first.frame.rows[0] - normal).norm() < 1e-6,
                "{:?} for {normal:?}",
                first.frame.rows[0]
            );
            // At every other point the sphere touches some triangle, too.
            for c in found.as_slice() {
                let on = c.position - c.frame.rows[0] * (0.5 * c.distance);
                let off = surface.iter().map(|t| (nearest(*t, on) - on).norm());
                assert!(off.fold(f64::INFINITY, f64::min) < 1e-9);
            }
        }
    }
    assert!(touching > 300 && apart > 100, "{touching}, {apart}");
}

/// Returns the ground below each triangle as a hull.
fn prisms(field: &HeightField) -> Vec<&'static Hull> {
    let bottom = -field.size()[3];
    let below = |p: V| Vec3::new(p.x, p.y, bottom);
    let prism = |[p, q, r]: [V; 3]| {
        let corners = [p, q, r, below(p), below(q), below(r)];
        hull_of(&corners)
    };
    triangles(field).into_iter().map(prism).collect()
}

/// Tests every shape near the surface: no relevant cell is skipped.
#[test]
fn bodies_are_as_far_as_the_nearest_part_of_the_ground() {
    let mut random = Random(11);
    let corners: Vec<V> = (0..20).map(|_| random.direction() * 0.1).collect();
    let hull = hull_of(&corners);
    let margin = 0.02;
    let (mut apart, mut sunk, mut away) = (0, 0, 0);
    for k in 0..60 {
        let ground = rough(&mut random, 4 + k % 5, 3 + k % 7, [0.02, 0.1, 0.3][k % 3]);
        let parts = prisms(&ground);
        for j in 0..20 {
            let kind = [KINDS.as_slice(), &[ShapeKind::Mesh]].concat()[j % 6];
            let size = [(); 3].map(|()| random.range(0.02, 0.15));
            let shape = match kind {
                ShapeKind::Mesh => Shape::mesh(hull),
                _ => Shape::new(kind, Vec3::from_array(size)),
            };
            let mut pose = Pose {
                position: Vec3::new(random.range(-0.6, 0.6), random.range(-0.5, 0.5), 0.8),
                rotation: random.rotation(),
            };
            let to_part = |pose: &Pose<f64>, margin: f64| {
                let mut least = f64::INFINITY;
                let mut out = Contacts::new();
                for part in &parts {
                    let part = Shape::mesh(part);
                    collide(&shape, pose, &part, &Pose::IDENTITY, margin, &mut out);
                    least = least.min(deepest(&out));
                }
                least
            };
            // Lowers the shape to about the margin, so that it may or may not be found, or slightly into the ground.
            let wanted = random.range(-0.004, 0.03);
            for _ in 0..30 {
                let left = to_part(&pose, 1.0) - wanted;
                if left < 1e-4 || pose.position.z < -0.1 {
                    break;
                }
                pose.position.z -= left;
            }
            let truth = to_part(&pose, margin);
            let found = deepest(&touch(&ground, &shape, &pose, margin));
            if truth > margin {
                away += 1;
                assert_eq!(found, f64::INFINITY, "{kind:?}, truth {truth}");
            } else if truth > 0.0 {
                apart += 1;
                assert!(
                    (found - truth).abs() < 1e-6,
                    "{kind:?}: {found} for {truth}"
                );
            } else {
                // The field pushes it out at least as far as any part does.
                sunk += 1;
                assert!(found < truth + 1e-6, "{kind:?}: {found} for {truth}");
            }
        }
    }
    assert!(
        apart > 400 && sunk > 60 && away > 200,
        "{apart}, {sunk}, {away}"
    );
}
