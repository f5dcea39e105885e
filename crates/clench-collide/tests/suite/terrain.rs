//! Shapes on height fields: equal to a plane on a flat field; on ridges, in grooves, at cliffs and borders, and with
//! degenerate input.

use crate::common::{
    Random, V, convert_pose,
    fields::{KINDS, deepest, rough, touch},
    hulls::hull_of,
};
use clench_collide::{
    Contacts, HeightField, MAX_POINTS, Pose, Shape, ShapeKind, collide, supported,
};
use clench_math::{Lanes, Mask, Mat3, Real, Vec3};

fn field(
    rows: usize,
    columns: usize,
    size: [f64; 4],
    height: impl Fn(usize, usize) -> f64,
) -> HeightField {
    let heights = (0..rows * columns).map(|k| height(k / columns, k % columns));
    HeightField::new(rows, columns, heights.collect(), size).unwrap()
}

fn flat(rows: usize, columns: usize) -> HeightField {
    field(rows, columns, [0.5, 0.4, 0.1, 0.2], |_, _| 0.0)
}

fn at(x: f64, y: f64, z: f64) -> Pose<f64> {
    Pose {
        position: Vec3::new(x, y, z),
        rotation: Mat3::IDENTITY,
    }
}

fn compose(a: &Pose<f64>, b: &Pose<f64>) -> Pose<f64> {
    Pose {
        position: a.point(b.position),
        rotation: a.rotation * b.rotation,
    }
}

#[test]
fn every_bounded_shape_collides_with_terrain() {
    for kind in KINDS.into_iter().chain([ShapeKind::Mesh]) {
        assert!(supported(ShapeKind::HeightField, kind) && supported(kind, ShapeKind::HeightField));
    }
}

#[test]
fn a_flat_field_is_a_plane() {
    let mut random = Random(1);
    let plane = Shape::new(ShapeKind::Plane, V::ZERO);
    for (rows, columns) in [(2, 2), (5, 7), (31, 40)] {
        let ground = flat(rows, columns);
        for kind in KINDS {
            for k in 0..40 {
                let size = Vec3::new(
                    random.range(0.03, 0.1),
                    random.range(0.03, 0.1),
                    random.range(0.03, 0.1),
                );
                let shape = Shape::new(kind, size);
                let tilt = if k % 2 == 0 {
                    Mat3::IDENTITY
                } else {
                    random.rotation()
                };
                // On a grid point, on an edge, or anywhere.
                let x = if k % 3 == 0 {
                    0.0
                } else {
                    random.range(-0.25, 0.25)
                };
                let mut pose = Pose {
                    position: Vec3::new(x, random.range(-0.15, 0.15), 0.0),
                    rotation: tilt,
                };
                let lowest = crate::common::support(
                    &Shape::new(kind, size),
                    &pose,
                    Vec3::new(0.0, 0.0, -1.0),
                );
                pose.position.z = random.range(-2e-3, 2e-3) - lowest.z;
                let found = touch(&ground, &shape, &pose, 1e-3);
                let mut expected = Contacts::new();
                collide(&plane, &Pose::IDENTITY, &shape, &pose, 1e-3, &mut expected);
                if expected.as_slice().is_empty() {
                    assert!(found.as_slice().is_empty(), "{kind:?} {size:?} {pose:?}");
                    continue;
                }
                let (d, e) = (deepest(&found), deepest(&expected));
                assert!(
                    (d - e).abs() < 1e-9,
                    "{kind:?}: {d} for {e} at {pose:?} of {size:?}"
                );
                for c in found.as_slice() {
                    let n = c.frame.rows[0];
                    assert!(
                        (n - Vec3::new(0.0, 0.0, 1.0)).norm() < 1e-9,
                        "{kind:?}: {n:?} at {pose:?}"
                    );
                }
                if kind == ShapeKind::Sphere {
                    let ([c], [e]) = (found.as_slice(), expected.as_slice()) else {
                        panic!("one point, not {found:?}");
                    };
                    assert!((c.position - e.position).norm() < 1e-9);
                }
            }
        }
    }
}

#[test]
fn a_box_that_lies_flat_stands_on_its_corners() {
    let mut random = Random(2);
    for (rows, columns) in [(2, 2), (9, 11), (80, 100)] {
        let ground = flat(rows, columns);
        for _ in 0..10 {
            let size = Vec3::new(0.1, 0.05, 0.03);
            let turn = clench_math::Quat::from_axis_angle(
                Vec3::new(0.0, 0.0, 1.0),
                random.range(0.0, 6.0),
            );
            let pose = Pose {
                position: Vec3::new(random.range(-0.2, 0.2), random.range(-0.2, 0.2), 0.029),
                rotation: turn.to_matrix(),
            };
            let found = touch(&ground, &Shape::new(ShapeKind::Box, size), &pose, 0.0);
            assert_eq!(found.as_slice().len(), 4, "{found:?}");
            for (x, y) in [(0.1, 0.05), (-0.1, 0.05), (-0.1, -0.05), (0.1, -0.05)] {
                let corner = pose.point(Vec3::new(x, y, -0.03)) + Vec3::new(0.0, 0.0, 5e-4);
                let near =
                    |c: &&clench_collide::ContactPoint<f64>| (c.position - corner).norm() < 1e-6;
                let point = found
                    .as_slice()
                    .iter()
                    .find(near)
                    .expect("a contact at each corner");
                assert!((point.distance + 1e-3).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_ridge_carries_a_sphere_between_its_slopes() {
    // 1 m high over 0.5 m: slopes of 63°.
    let ridge = field(3, 3, [0.5, 0.5, 1.0, 0.1], |_, column| {
        f64::from(column == 1)
    });
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.1, 0.0, 0.0));
    for y in [0.0, 0.13, 0.25] {
        let found = touch(&ridge, &ball, &at(0.0, y, 1.099), 0.0);
        let [c] = found.as_slice() else {
            panic!("one point, not {found:?}")
        };
        assert!((c.distance + 1e-3).abs() < 1e-12);
        assert!((c.frame.rows[0] - Vec3::new(0.0, 0.0, 1.0)).norm() < 1e-12);
    }
}

#[test]
fn a_groove_holds_a_sphere_by_both_slopes() {
    let groove = field(3, 3, [0.5, 0.5, 0.5, 0.1], |_, column| {
        f64::from(column != 1)
    });
    let (radius, slope) = (0.1, f64::sqrt(0.5));
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(radius, 0.0, 0.0));
    let found = touch(&groove, &ball, &at(0.0, 0.1, radius / slope - 1e-3), 0.0);
    let [a, b] = found.as_slice() else {
        panic!("two points, not {found:?}")
    };
    assert!((a.distance - b.distance).abs() < 1e-12);
    assert!((a.distance + 1e-3 * slope).abs() < 1e-12);
    assert!((a.frame.rows[0].x + b.frame.rows[0].x).abs() < 1e-12);
    assert!((a.frame.rows[0].z - slope).abs() < 1e-12);
}

#[test]
fn the_field_ends_at_its_sides_and_its_base() {
    let ground = flat(4, 5);
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.1, 0.0, 0.0));
    let one = |pose: Pose<f64>| {
        let found = touch(&ground, &ball, &pose, 0.0);
        let [c] = found.as_slice() else {
            panic!("one point, not {found:?}")
        };
        (c.distance, c.frame.rows[0])
    };
    // Next to the field, below it, and off its upper edge.
    let (distance, normal) = one(at(0.59, 0.1, -0.1));
    assert!((distance + 0.01).abs() < 1e-12 && (normal.x - 1.0).abs() < 1e-12);
    let (distance, normal) = one(at(0.1, 0.1, -0.29));
    assert!((distance + 0.01).abs() < 1e-12 && (normal.z + 1.0).abs() < 1e-12);
    let (distance, normal) = one(at(0.55, 0.1, 0.05));
    assert!((distance - (0.05 * f64::sqrt(2.0) - 0.1)).abs() < 1e-12);
    assert!((normal.x - normal.z).abs() < 1e-12);
    for away in [
        at(0.61, 0.0, 0.0),
        at(0.0, -0.51, 0.0),
        at(0.0, 0.0, 0.11),
        at(0.0, 0.0, -0.31),
        at(50.0, 3.0, 9.0),
    ] {
        assert!(touch(&ground, &ball, &away, 0.0).as_slice().is_empty());
    }
    // The margin applies on all sides.
    for near in [
        at(0.605, 0.0, -0.05),
        at(0.0, 0.0, 0.105),
        at(0.0, 0.0, -0.305),
    ] {
        let found = touch(&ground, &ball, &near, 0.01);
        assert!((deepest(&found) - 0.005).abs() < 1e-12, "{found:?}");
        assert!(touch(&ground, &ball, &near, 0.004).as_slice().is_empty());
    }
}

#[test]
fn a_cliff_is_left_at_its_foot() {
    let cliff = field(2, 21, [1.0, 0.5, 5.0, 0.1], |_, column| {
        f64::from(column > 10)
    });
    // The wall extends from x = 0 to x = 0.1.
    let cube = Shape::new(ShapeKind::Box, Vec3::new(0.2, 0.2, 0.2));
    let found = touch(&cliff, &cube, &at(-0.17, 0.05, 1.0), 0.0);
    assert!(!found.as_slice().is_empty());
    for c in found.as_slice() {
        assert!(c.distance > -0.1, "{c:?}");
        assert!(c.frame.rows[0].x < -0.9, "{c:?}");
    }
}

#[test]
fn a_body_sunk_into_fine_cells_is_lifted_out() {
    let ground = flat(81, 101);
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.05, 0.0, 0.0));
    let found = touch(&ground, &ball, &at(0.013, 0.021, -0.03), 0.0);
    let [c] = found.as_slice() else {
        panic!("one point, not {found:?}")
    };
    assert!((c.distance + 0.08).abs() < 1e-12 && (c.frame.rows[0].z - 1.0).abs() < 1e-12);
}

/// Rounding must not lose the point at which an edge of the body crosses from one triangle to the next.
#[test]
fn single_precision_finds_the_points_of_a_box_that_double_precision_finds() {
    let mut random = Random(5);
    for k in 0..200 {
        let ground = rough(&mut random, 6, 7, 0.1);
        let shape = Shape::new(ShapeKind::Box, Vec3::new(0.12, 0.08, 0.05));
        let pose = Pose {
            position: Vec3::new(random.range(-0.3, 0.3), random.range(-0.2, 0.2), 0.12),
            rotation: random.rotation(),
        };
        let found = touch(&ground, &shape, &pose, 1e-3);
        let mut single = Contacts::<f32>::new();
        collide(
            &Shape::height_field(&ground),
            &Pose::IDENTITY,
            &shape.resized(Vec3::from_f64(shape.size().to_array())),
            &convert_pose(&pose),
            1e-3,
            &mut single,
        );
        let counts = [found.as_slice().len(), single.as_slice().len()];
        assert_eq!(counts[0], counts[1], "state {k}");
    }
}

/// Tests all shapes and hulls, moved, in several number types.
#[test]
fn contacts_move_with_both_and_are_the_same_in_lanes() {
    let mut random = Random(7);
    let corners: Vec<V> = (0..20).map(|_| random.direction() * 0.1).collect();
    let hull = hull_of(&corners);
    for k in 0..120 {
        let ground = rough(&mut random, 3 + k % 8, 3 + k % 5, 0.1);
        let kind = [KINDS.as_slice(), &[ShapeKind::Mesh]].concat()[k % 6];
        let size = Vec3::new(
            random.range(0.03, 0.1),
            random.range(0.03, 0.1),
            random.range(0.03, 0.1),
        );
        let shape = match kind {
            ShapeKind::Mesh => Shape::mesh(hull),
            _ => Shape::new(kind, size),
        };
        let pose = Pose {
            position: Vec3::new(
                random.range(-0.5, 0.5),
                random.range(-0.4, 0.4),
                random.range(0.0, 0.2),
            ),
            rotation: random.rotation(),
        };
        let found = touch(&ground, &shape, &pose, 1e-3);
        assert!(found.as_slice().len() <= MAX_POINTS);
        let motion = Pose {
            position: random.vector(),
            rotation: random.rotation(),
        };
        let mut moved = Contacts::new();
        let placed = compose(&motion, &pose);
        collide(
            &Shape::height_field(&ground),
            &motion,
            &shape,
            &placed,
            1e-3,
            &mut moved,
        );
        let (d, e) = (deepest(&found), deepest(&moved));
        assert!(d == e || (d - e).abs() < 1e-9, "{kind:?}: {d}, moved {e}");

        type L = Lanes<f64, 8>;
        let mut lanes = Contacts::<L>::new();
        let wide = shape.resized(Vec3::from_f64(shape.size().to_array()));
        let mut pose_l = convert_pose::<L>(&pose);
        // One lane has another pose.
        pose_l.position.z.set_lane(3, 9.0);
        collide(
            &Shape::height_field(&ground),
            &Pose::IDENTITY,
            &wide,
            &pose_l,
            L::new(1e-3),
            &mut lanes,
        );
        assert_eq!(lanes.as_slice().len(), found.as_slice().len());
        for (c, e) in lanes.as_slice().iter().zip(found.as_slice()) {
            assert!(!c.active.lane(3) && c.active.lane(0) && c.active.lane(7));
            assert_eq!(c.distance.lane(5), e.distance);
            assert_eq!(c.position.x.lane(5), e.position.x);
            assert_eq!(c.frame.rows[0].y.lane(5), e.frame.rows[0].y);
        }

        let mut single = Contacts::<f32>::new();
        let shape = shape.resized(Vec3::from_f64(shape.size().to_array()));
        collide(
            &Shape::height_field(&ground),
            &Pose::IDENTITY,
            &shape,
            &convert_pose(&pose),
            1e-3,
            &mut single,
        );
        let least = single
            .as_slice()
            .iter()
            .fold(f32::INFINITY, |d, c| d.min(c.distance));
        if d < 9e-4 && d > -5e-3 {
            assert!(
                (f64::from(least) - d).abs() < 1e-4,
                "{kind:?}: {least} for {d}"
            );
        }
    }
}

#[test]
fn nonsense_touches_nothing_or_something_finite() {
    let mut random = Random(8);
    let strange = [
        f64::NAN,
        f64::INFINITY,
        -f64::INFINITY,
        0.0,
        1e-300,
        1e300,
        1.0,
        1e-9,
        1e9,
    ];
    let pick = |random: &mut Random| strange[(random.unit() * 9.0) as usize];
    for k in 0..3000 {
        let ground = rough(&mut random, 4, 5, 0.1);
        let size = Vec3::new(pick(&mut random), pick(&mut random), pick(&mut random));
        let position = if k % 2 == 0 {
            Vec3::new(0.1, 0.0, 0.1)
        } else {
            Vec3::new(pick(&mut random), 0.0, pick(&mut random))
        };
        let pose = Pose {
            position,
            rotation: random.rotation(),
        };
        let margin = if k % 3 == 0 { pick(&mut random) } else { 0.0 };
        let found = touch(&ground, &Shape::new(KINDS[k % 5], size), &pose, margin);
        for c in found.as_slice() {
            let numbers = [
                c.distance,
                c.position.x,
                c.position.y,
                c.position.z,
                c.frame.rows[0].x,
            ];
            assert!(
                numbers.iter().all(|x| x.is_finite()),
                "{c:?} of {size:?} at {pose:?}, {margin}"
            );
        }
    }
}

#[test]
fn a_shape_as_large_as_a_large_field_is_done_in_time() {
    let size = [250.0, 250.0, 2.0, 1.0];
    let level = field(500, 500, size, |_, _| 0.0);
    let rough = field(500, 500, size, |row, column| {
        ((row * 7 + column * 13) % 10) as f64
    });
    let plate = Shape::new(ShapeKind::Box, Vec3::new(300.0, 300.0, 1.0));
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(800.0, 0.0, 0.0));
    let start = std::time::Instant::now();
    for (ground, shape, resting) in [
        (&level, plate, 1.0),
        (&rough, plate, 3.0),
        (&level, ball, 800.0),
    ] {
        for depth in [0.01, 0.5] {
            let found = touch(ground, &shape, &at(0.0, 0.0, resting - depth), 0.0);
            assert!(found.as_slice().len() <= MAX_POINTS);
            assert!((deepest(&found) + depth).abs() < 1e-9, "{found:?}");
        }
    }
    // A million cells take a few seconds without optimisation; superlinear growth takes hours.
    assert!(start.elapsed().as_secs() < 120, "{:?}", start.elapsed());
}
