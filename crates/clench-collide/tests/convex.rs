//! Pairs of curved shapes as a simulation meets them: pressed a little or apart a little, on round coordinates, resting face to
//! face; and as it should never meet them.

mod common;

use clench_collide::{Contacts, PATCH_POINTS, Pose, Shape, ShapeKind, bounding_radius, collide};
use clench_math::{Mat3, Quat, Real, Scalar, Vec3};
use common::{PAIRS, Random, Scene, V, convert_pose, convert_shape, off_surface};

/// Pairs that are found by their support functions.
const CURVED: [(ShapeKind, ShapeKind); 7] = {
    use ShapeKind::*;
    [
        (Sphere, Ellipsoid),
        (Capsule, Ellipsoid),
        (Ellipsoid, Ellipsoid),
        (Ellipsoid, Cylinder),
        (Ellipsoid, Box),
        (Cylinder, Cylinder),
        (Cylinder, Box),
    ]
};

/// How two shapes are placed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Placement {
    /// Up to 2 cm deep, at random.
    Pressed,
    /// Apart within the margin of 1 cm, at random.
    Apart,
    /// Turned by right angles, on multiples of 2 cm.
    Grid,
    /// A face or side on the other's, tilted by 1e-7 to 3e-3 rad.
    Resting,
}

/// Two shapes of about 10 cm.
fn placed(random: &mut Random, kinds: (ShapeKind, ShapeKind), placement: Placement) -> Scene {
    let mut sizes = [0, 1].map(|_| (random.vector() * 0.04) + Vec3::new(0.08, 0.08, 0.08));
    let mut rotations = [random.rotation(), random.rotation()];
    let mut direction = random.direction();
    let round = |v: V| Vec3::from_array(v.to_array().map(|x| (x * 50.0).round() / 50.0));
    match placement {
        Placement::Pressed | Placement::Apart => {}
        Placement::Grid => {
            sizes = sizes.map(round);
            rotations = [random.quarter_turns(), random.quarter_turns()];
        }
        Placement::Resting => {
            let tilt = random.direction() * 10f64.powf(random.range(-7.0, -2.5));
            let yaw = Quat::from_axis_angle(Vec3::new(0.0, 0.0, 1.0), random.range(0.0, 6.3));
            let turn = Quat::from_rotation_vector(tilt) * yaw;
            rotations = [
                random.quarter_turns(),
                turn.to_matrix() * random.quarter_turns(),
            ];
            direction = Vec3::new(random.range(-0.3, 0.3), random.range(-0.3, 0.3), 1.0);
            direction = direction.normalize().0;
        }
    }
    let pose = |rotation, position| Pose { position, rotation };
    let mut scene = Scene {
        a: Shape::new(kinds.0, sizes[0]),
        pose_a: pose(rotations[0], V::ZERO),
        b: Shape::new(kinds.1, sizes[1]),
        pose_b: pose(rotations[1], V::ZERO),
        margin: 1.0,
    };
    let wanted = match placement {
        Placement::Pressed | Placement::Grid => -random.range(0.0, 0.02),
        Placement::Apart => random.range(0.0, 0.0099),
        Placement::Resting => -random.range(0.0, 1e-3),
    };
    let (mut near, mut far) = (0.0, 0.5);
    for _ in 0..40 {
        let middle = (near + far) / 2.0;
        scene.pose_b.position = direction * middle;
        let apart = scene.deepest().is_none_or(|c| c.distance > wanted);
        *(if apart { &mut far } else { &mut near }) = middle;
    }
    if placement == Placement::Grid {
        scene.pose_b.position = round(scene.pose_b.position);
    }
    scene.margin = if placement == Placement::Apart {
        0.01
    } else {
        0.0
    };
    scene
}

fn angle(u: V, v: V) -> f64 {
    u.cross(v).norm().atan2(u.dot(v)).to_degrees()
}

#[test]
fn depths_and_normals_are_true() {
    use Placement::*;
    let mut random = Random(21);
    for kinds in CURVED {
        let (mut near, mut normals, mut off) = (0, 0, 0);
        for k in 0..500 {
            let placement = [Pressed, Apart, Grid, Resting][k % 4];
            let scene = placed(&mut random, kinds, placement);
            let optima = scene.optima(&mut random);
            let (truth, normal) = optima[0];
            let Some(c) = scene.deepest() else {
                assert!(
                    truth > scene.margin - 1e-6,
                    "nothing at {truth} in {scene:?}"
                );
                continue;
            };
            near += 1;
            let error = (c.distance - truth).abs();
            assert!(
                error < 1e-6,
                "{placement:?}: {} for {truth} in {scene:?}",
                c.distance
            );
            // Where another direction is as good, or a flat one nearly, the normal is open.
            let rival = |(gap, n): &(f64, V)| truth - gap < 1e-6 && angle(*n, normal) > 0.02;
            if optima.iter().any(rival) {
                continue;
            }
            normals += 1;
            off += usize::from(angle(c.frame.rows[0], normal) > 0.1);
        }
        assert!(near > 440 && normals > 350, "{kinds:?}: {near}, {normals}");
        assert!(
            off * 100 <= normals,
            "{kinds:?}: {off} of {normals} normals off"
        );
    }
}

#[test]
fn every_point_lies_midway_between_the_surfaces() {
    use Placement::*;
    let mut random = Random(22);
    for kinds in CURVED {
        let mut points = 0;
        for k in 0..400 {
            let placement = [Pressed, Apart, Grid, Resting][k % 4];
            let scene = placed(&mut random, kinds, placement);
            let contacts = scene.contacts();
            for c in contacts.as_slice() {
                points += 1;
                assert!(c.distance <= scene.margin);
                let half = c.frame.rows[0] * (0.5 * c.distance);
                let on_a = off_surface(&scene.a, &scene.pose_a, c.position - half);
                let on_b = off_surface(&scene.b, &scene.pose_b, c.position + half);
                assert!(
                    on_a < 1e-6 && on_b < 1e-6,
                    "{on_a}, {on_b}: {c:?} in {scene:?}"
                );
            }
        }
        assert!(points > 300, "{kinds:?}: {points}");
    }
}

fn shape(kind: ShapeKind, size: [f64; 3]) -> Shape<'static, f64> {
    Shape::new(kind, Vec3::from_f64(size))
}

/// A shape on another, upright, moved by `offset` and turned.
fn on_top(
    a: Shape<'static, f64>,
    b: Shape<'static, f64>,
    offset: [f64; 3],
    turn: Mat3<f64>,
) -> Scene {
    Scene {
        a,
        pose_a: Pose::IDENTITY,
        b,
        pose_b: Pose {
            position: Vec3::from_f64(offset),
            rotation: turn,
        },
        margin: 0.0,
    }
}

/// The area that points in a horizontal plane span.
fn area(scene: &Scene) -> f64 {
    let contacts = scene.contacts();
    let points: Vec<V> = contacts.as_slice().iter().map(|c| c.position).collect();
    let middle = points.iter().fold(V::ZERO, |sum, p| sum + *p) * (1.0 / points.len() as f64);
    let mut arms: Vec<V> = points.iter().map(|p| *p - middle).collect();
    arms.sort_by(|p, q| p.y.atan2(p.x).total_cmp(&q.y.atan2(q.x)));
    let next = arms.iter().cycle().skip(1);
    arms.iter()
        .zip(next)
        .map(|(p, q)| p.cross(*q).z / 2.0)
        .sum()
}

#[test]
fn a_standing_cylinder_covers_its_cap() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let cap = std::f64::consts::PI * 0.01;
    // An octagon in a circle has 0.9003 of its area; one that has to hold the deepest point of the rim a little less.
    for (tilt, share) in [(0.0, 0.9), (1e-7, 0.9), (1e-4, 0.87), (1e-3, 0.87)] {
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), tilt).to_matrix();
        let wide = shape(ShapeKind::Box, [0.3, 0.4, 0.1]);
        let mut scene = on_top(cylinder, wide, [0.05, 0.02, 0.299], Mat3::IDENTITY);
        scene.pose_a.rotation = turn;
        assert!(area(&scene) > share * cap, "{tilt}");
        let narrow = shape(ShapeKind::Box, [0.05, 0.06, 0.1]);
        let mut scene = on_top(cylinder, narrow, [0.0, 0.0, 0.299], Mat3::IDENTITY);
        scene.pose_a.rotation = turn;
        assert!((area(&scene) - 0.1 * 0.12).abs() < 1e-4, "{tilt}");
        let stacked = on_top(cylinder, cylinder, [0.0, 0.0, 0.399], turn);
        assert!(
            area(&stacked) > 0.85 * cap,
            "{tilt}: {} {:?}",
            area(&stacked),
            stacked
                .contacts()
                .as_slice()
                .iter()
                .map(|c| (c.position.to_array(), c.distance))
                .collect::<Vec<_>>()
        );
    }
}

#[test]
fn points_of_a_tilted_cap_are_as_deep_as_the_tilt_says() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let ground = shape(ShapeKind::Box, [0.5, 0.5, 0.1]);
    let tilt = 1e-3;
    let mut scene = on_top(cylinder, ground, [0.0, 0.0, -0.2995], Mat3::IDENTITY);
    scene.pose_a.rotation = Quat::from_axis_angle(Vec3::new(0.0, 1.0, 0.0), tilt).to_matrix();
    let contacts = scene.contacts();
    assert_eq!(contacts.as_slice().len(), 8);
    for c in contacts.as_slice() {
        let bottom = -0.2 / tilt.cos() + c.position.x * -tilt.tan();
        assert!((c.distance - (bottom + 0.1995)).abs() < 1e-6, "{c:?}");
    }
}

#[test]
fn cylinders_side_by_side_touch_along_their_overlap() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let scene = on_top(cylinder, cylinder, [0.199, 0.0, 0.1], Mat3::IDENTITY);
    let contacts = scene.contacts();
    let [p, q] = contacts.as_slice() else {
        panic!("{contacts:?}");
    };
    for (c, z) in [(p, -0.1), (q, 0.2)] {
        assert!(
            (c.position - Vec3::new(0.0995, 0.0, z)).norm() < 1e-9,
            "{c:?}"
        );
        assert!((c.distance + 0.001).abs() < 1e-9);
    }
}

#[test]
fn a_lying_cylinder_touches_a_box_with_both_ends() {
    let cylinder = shape(ShapeKind::Cylinder, [0.1, 0.2, 0.0]);
    let ground = shape(ShapeKind::Box, [0.15, 0.5, 0.1]);
    let mut scene = on_top(cylinder, ground, [0.0, 0.0, -0.199], Mat3::IDENTITY);
    let lying = Quat::from_axis_angle(Vec3::new(0.0, 1.0, 0.0), std::f64::consts::FRAC_PI_2);
    scene.pose_a.rotation = lying.to_matrix();
    let contacts = scene.contacts();
    assert_eq!(contacts.as_slice().len(), 2);
    let sum = contacts
        .as_slice()
        .iter()
        .fold(0.0, |sum, c| sum + c.position.x);
    assert!(sum.abs() < 1e-9);
    for c in contacts.as_slice() {
        assert!((c.position.x.abs() - 0.15).abs() < 1e-9, "{c:?}");
        assert!((c.distance + 0.001).abs() < 1e-9);
    }
}

/// Shapes and poses of every kind of trouble: without extent, tiny, huge, thin, concentric, aligned, touching exactly, far away.
fn trouble(random: &mut Random, kinds: (ShapeKind, ShapeKind)) -> Scene {
    let length = |random: &mut Random| match (random.unit() * 8.0) as usize {
        0 => 0.0,
        1 => 1e-6,
        2 => 1e-3,
        3 => 1e3,
        4 | 5 => 0.1,
        _ => random.range(0.05, 0.5),
    };
    let size = |random: &mut Random| Vec3::new(length(random), length(random), length(random));
    let rotation = |random: &mut Random| match (random.unit() * 3.0) as usize {
        0 => random.quarter_turns(),
        1 => {
            let tilt = random.direction() * 10f64.powf(random.range(-12.0, -2.0));
            Quat::from_rotation_vector(tilt).to_matrix() * random.quarter_turns()
        }
        _ => random.rotation(),
    };
    let a = Shape::new(kinds.0, size(random));
    let b = Shape::new(
        kinds.1,
        if random.unit() < 0.2 {
            a.size
        } else {
            size(random)
        },
    );
    let (rotation_a, rotation_b) = (rotation(random), rotation(random));
    let direction = match (random.unit() * 3.0) as usize {
        0 => rotation_a.column(0),
        1 => rotation_b.column(2),
        _ => random.direction(),
    };
    let mut scene = Scene {
        a,
        pose_a: Pose {
            position: V::ZERO,
            rotation: rotation_a,
        },
        b,
        pose_b: Pose {
            position: V::ZERO,
            rotation: rotation_b,
        },
        margin: [0.0, 0.0, 0.01, 10.0][(random.unit() * 4.0) as usize],
    };
    let finite = |r: f64| if r.is_finite() { r } else { 1.0 };
    let reach = finite(bounding_radius(&a)) + finite(bounding_radius(&b));
    scene.pose_b.position = match (random.unit() * 5.0) as usize {
        0 => V::ZERO,
        1 => direction * -scene.gap_along(direction),
        2 => direction * (reach * random.unit()),
        3 => direction * (-scene.gap_along(direction) * random.range(0.99, 1.01)),
        _ => direction * (reach + 10.0 * random.unit()),
    };
    if random.unit() < 0.1 {
        let far = random.vector() * 1e4;
        scene.pose_a.position += far;
        scene.pose_b.position += far;
    }
    scene
}

fn in_type<S: Scalar>(scene: &Scene) -> Contacts<S> {
    let mut out = Contacts::new();
    collide::<S>(
        &convert_shape(&scene.a),
        &convert_pose(&scene.pose_a),
        &convert_shape(&scene.b),
        &convert_pose(&scene.pose_b),
        S::new(scene.margin),
        &mut out,
    );
    out
}

/// Nothing but proper points, whatever the shapes.
fn assert_proper<S: Scalar>(contacts: &Contacts<S>, scene: &Scene) {
    let coordinates = scene.pose_a.position.norm() + scene.pose_b.position.norm();
    let rounding = S::EPSILON * S::new(1024.0 * (coordinates + 1e3));
    for c in contacts.as_slice() {
        let near = c.distance <= S::new(scene.margin) + rounding;
        assert!(Real::is_finite(c.distance) && near, "{c:?} {scene:?}");
        assert!(
            c.position.to_array().into_iter().all(Real::is_finite),
            "{c:?} {scene:?}"
        );
        for row in c.frame.rows {
            let error = (row.norm() - S::ONE).abs();
            assert!(error < S::new(1e-5), "{c:?} {scene:?}");
        }
    }
}

#[test]
fn no_pose_and_no_shape_breaks_it() {
    let mut random = Random(23);
    for kinds in PAIRS {
        for _ in 0..10_000 {
            let scene = trouble(&mut random, kinds);
            assert_proper(&in_type::<f64>(&scene), &scene);
            assert_proper(&in_type::<f32>(&scene), &scene);
        }
    }
}

/// How far the gap along a direction of some hundred exceeds the distance found.
fn excess(scene: &Scene, distance: f64, random: &mut Random) -> f64 {
    let axes = [scene.pose_a, scene.pose_b].map(|p| [0, 1, 2].map(|i| p.rotation.column(i)));
    let axes = axes.as_flattened();
    let mut tried: Vec<V> = (0..50).map(|_| random.direction()).collect();
    for u in axes {
        tried.extend([*u, -*u]);
        tried.extend(axes.iter().map(|v| u.cross(*v)));
    }
    tried.retain(|n| n.norm() > 1e-6);
    let gap = |n: &V| scene.gap_along(n.normalize().0) - distance;
    tried.iter().map(gap).fold(f64::NEG_INFINITY, f64::max)
}

/// In deep and concentric poses of thin bodies many ways out are nearly as short, and the polytope may run out of room before it
/// has told them apart: once in some ten thousand such poses, and then it is off by little.
#[test]
fn hardly_any_direction_has_a_larger_gap() {
    let mut random = Random(24);
    for kinds in CURVED {
        let (mut checked, mut exceeded) = (0, 0);
        while checked < 4000 {
            let scene = trouble(&mut random, kinds);
            let sizes = [scene.a.size, scene.b.size].map(|s| s.to_array());
            let sizes = sizes.as_flattened();
            if sizes.iter().any(|s| !(1e-3..=1.0).contains(s)) {
                continue;
            }
            let Some(c) = scene.deepest() else { continue };
            checked += 1;
            let size = bounding_radius(&scene.a).min(bounding_radius(&scene.b));
            let excess = excess(&scene, c.distance, &mut random);
            assert!(excess < 1e-2 * size, "{excess}: {c:?} in {scene:?}");
            exceeded += usize::from(excess > 2e-5 * size + 1e-11);
        }
        assert!(exceeded * 1000 <= checked, "{kinds:?}: {exceeded}");
    }
}

#[test]
fn no_number_breaks_it() {
    let mut random = Random(25);
    for kinds in PAIRS {
        for _ in 0..1000 {
            let mut scene = random.scene(kinds);
            let bad = [f64::NAN, f64::INFINITY, -1.0, 1e300, 1e-300];
            let bad = bad[(random.unit() * 5.0) as usize];
            let axis = (random.unit() * 3.0) as usize;
            match (random.unit() * 4.0) as usize {
                0 => scene.a.size[axis] = bad,
                1 => scene.b.size[axis] = bad,
                2 => scene.pose_b.position[axis] = bad,
                _ => scene.pose_a.rotation.rows[axis].y = bad,
            }
            // It returns, and the buffer holds no more than it can.
            assert!(in_type::<f64>(&scene).as_slice().len() <= PATCH_POINTS);
            assert!(in_type::<f32>(&scene).as_slice().len() <= PATCH_POINTS);
        }
    }
}
