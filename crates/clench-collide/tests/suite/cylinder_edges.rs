//! Cylinders whose end or side lies within micrometres of an edge of the ground touch it only where both bodies are.

use crate::common::{Random, V, fields::touch, support};
use crate::rough_ground::triangles;
use clench_collide::{HeightField, Pose, Shape, ShapeKind};
use clench_math::{Mat3, Quat, Vec3};

/// In some micrometres of this window the end of the cylinder misses a triangle by less than the gap's tolerance shows.
#[test]
fn a_cylinder_along_a_step_touches_it_at_its_ends_at_every_position() {
    let heights = (0..21 * 21).map(|place| f64::from(place % 21 > 9));
    let step = HeightField::new(21, 21, heights.collect(), [1.0, 1.0, 0.01, 0.1]).expect("valid");
    let cylinder = Shape::new(ShapeKind::Cylinder, Vec3::new(0.1, 0.05, 0.0));
    let along_x = Vec3::new(1.0, 0.0, 0.0);
    let turn = Quat::from_axis_angle(along_x, std::f64::consts::FRAC_PI_2);
    for k in 0..400 {
        let pose = Pose {
            position: Vec3::new(-0.059_95 + f64::from(k) * 2.5e-7, 0.0, 0.103_996),
            rotation: turn.to_matrix(),
        };
        let found = touch(&step, &cylinder, &pose, 0.0);
        let mut ends: Vec<f64> = found.as_slice().iter().map(|c| c.position.y).collect();
        ends.sort_by(f64::total_cmp);
        assert_eq!(ends.len(), 2, "{found:?}");
        let known = (ends[0] + 0.05).abs() < 2e-6 && (ends[1] - 0.05).abs() < 2e-6;
        assert!(known, "{ends:?} at step {k}");
    }
}

/// Returns the height of a field at a point above or below it; beyond its border it is infinite.
fn height(field: &HeightField, place: V) -> f64 {
    let over = triangles(field).into_iter().find_map(|[a, b, c]| {
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(p, q)| (q.x - p.x) * (place.y - p.y) - (q.y - p.y) * (place.x - p.x) >= -1e-12);
        let n = (b - a).cross(c - a);
        inside.then(|| a.z - (n.x * (place.x - a.x) + n.y * (place.y - a.y)) / n.z)
    });
    over.unwrap_or(f64::INFINITY)
}

/// Moves cylinders that lie on a triangle, exactly or nearly, in steps of half a micrometre so that their lowest point
/// crosses one of its sides. There the cylinder misses the triangle by less than the gap's tolerance shows.
#[test]
fn a_cylinder_touches_only_within_itself_at_the_sides_of_triangles() {
    let mut random = Random(5);
    let mut touching = 0;
    for k in 0..6000 {
        let level = |column: usize, random: &mut Random| match k % 4 {
            0 => 0.0,
            1 => f64::from(column > 2),
            2 => f64::from(column != 3),
            _ => random.unit(),
        };
        let heights = (0..6 * 7).map(|place| level(place % 7, &mut random));
        let heights = heights.collect();
        let size = [0.5, 0.4, random.pick(&[0.01, 0.05, 0.1]), 0.2];
        let ground = HeightField::new(6, 7, heights, size).expect("valid");
        let surface = triangles(&ground);
        // A cell that is not at the border.
        let cell = 6 * (1 + (random.unit() * 3.0) as usize) + 1 + (random.unit() * 4.0) as usize;
        let [a, b, c] = surface[2 * cell + k / 4 % 2];
        let normal = (b - a).cross(c - a).normalize().0;
        let (from, to) = random.pick(&[(a, b), (b, c), (c, a)]);
        let out = (to - from).cross(normal).normalize().0;
        let anywhere = random.direction();
        let free = anywhere - normal * normal.dot(anywhere);
        let axis = random.pick(&[b - a, c - a, free]).normalize().0;
        let lying = Mat3::from_columns(normal.cross(axis), -normal, -axis);
        let tilt = [0.0, 10_f64.powf(random.range(-7.0, -1.3))][k / 8 % 2];
        let about = random.direction();
        let rotation = Quat::from_axis_angle(about, tilt).to_matrix() * lying;
        let (radius, half) = (random.range(0.03, 0.12), random.range(0.01, 0.12));
        let cylinder = Shape::new(ShapeKind::Cylinder, Vec3::new(radius, half, 0.0));
        let turned = Pose {
            position: V::ZERO,
            rotation,
        };
        let lowest = support(&cylinder, &turned, -normal);
        let depth = 10_f64.powf(random.range(-5.0, -2.5));
        let share = random.unit();
        let target = from + (to - from) * share - normal * depth;
        for step in -20..=20 {
            let pose = Pose {
                position: target + out * (f64::from(step) * 0.5e-6) - lowest,
                rotation,
            };
            for contact in touch(&ground, &cylinder, &pose, 0.0).as_slice() {
                touching += 1;
                let p = pose.local(contact.position);
                let beyond = (p.x.hypot(p.y) - radius).max(p.z.abs() - half);
                assert!(
                    beyond < contact.distance.abs() + 1e-6,
                    "scene {k}, step {step}: {beyond} outside the cylinder at {contact:?}"
                );
                let above = contact.position.z - height(&ground, contact.position);
                assert!(
                    above < 1e-6,
                    "scene {k}, step {step}: {above} above the ground at {contact:?}"
                );
            }
        }
    }
    assert!(touching > 250_000, "{touching}");
}
