//! Contacts do not depend on the pose of the scene, the order of two shapes of one kind, or the number of environments
//! in a call.

use crate::common::{BOUNDED, PAIRS, Random, Scene, convert_pose, convert_shape};
use clench_collide::{ContactPoint, Contacts, Pose, Shape, ShapeKind, collide, supported};
use clench_math::{Lanes, Mask, Mat3, Real, Vec3};

fn moved(pose: &Pose<f64>, by: &Pose<f64>) -> Pose<f64> {
    Pose {
        position: by.point(pose.position),
        rotation: by.rotation * pose.rotation,
    }
}

/// Returns a scene whose result rounding cannot change: no decision of the kernels depends on a tie.
fn generic(random: &mut Random, kinds: (ShapeKind, ShapeKind)) -> Scene {
    loop {
        let scene = random.scene(kinds);
        if scene.pose_a.position.norm() > 1e-9 {
            return scene;
        }
    }
}

#[test]
fn a_moved_scene_has_moved_contacts() {
    let mut random = Random(11);
    for kinds in PAIRS {
        for _ in 0..500 {
            let scene = generic(&mut random, kinds);
            let by = Pose {
                position: random.vector(),
                rotation: random.rotation(),
            };
            let there = Scene {
                pose_a: moved(&scene.pose_a, &by),
                pose_b: moved(&scene.pose_b, &by),
                ..scene
            };
            let (here, there) = (scene.contacts(), there.contacts());
            assert_eq!(here.as_slice().len(), there.as_slice().len(), "{scene:?}");
            for (c, d) in here.as_slice().iter().zip(there.as_slice()) {
                assert!((c.distance - d.distance).abs() < 1e-9, "{scene:?}");
                assert!(
                    (by.point(c.position) - d.position).norm() < 1e-9,
                    "{scene:?}"
                );
                let normal = by.rotation * c.frame.rows[0];
                assert!((normal - d.frame.rows[0]).norm() < 1e-9, "{scene:?}");
            }
        }
    }
}

#[test]
fn like_shapes_may_be_swapped() {
    let mut random = Random(12);
    for kind in BOUNDED {
        for _ in 0..500 {
            let scene = generic(&mut random, (kind, kind));
            let swapped = Scene {
                a: scene.b,
                pose_a: scene.pose_b,
                b: scene.a,
                pose_b: scene.pose_a,
                ..scene
            };
            let (one, other) = (scene.deepest(), swapped.deepest());
            assert_eq!(one.is_some(), other.is_some(), "{scene:?}");
            if let (Some(one), Some(other)) = (one, other) {
                assert!((one.distance - other.distance).abs() < 1e-9, "{scene:?}");
                let normals = one.frame.rows[0] + other.frame.rows[0];
                assert!(normals.norm() < 1e-9, "{scene:?}");
            }
        }
    }
}

#[test]
fn pairs_out_of_order_or_unknown_yield_nothing() {
    assert!(supported(ShapeKind::Box, ShapeKind::Plane));
    assert!(!supported(ShapeKind::Plane, ShapeKind::Plane));
    assert!(supported(ShapeKind::Box, ShapeKind::Ellipsoid));
    let size = Vec3::new(1.0, 1.0, 1.0);
    let shape = |kind| Shape::new(kind, size);
    let mut out = Contacts::new();
    let here = Pose::IDENTITY;
    for (a, b) in [
        (ShapeKind::Box, ShapeKind::Sphere),
        (ShapeKind::Plane, ShapeKind::Plane),
        (ShapeKind::Box, ShapeKind::Cylinder),
    ] {
        collide(&shape(a), &here, &shape(b), &here, 0.0, &mut out);
        assert!(out.as_slice().is_empty());
    }
}

/// Puts scene `i` into lane `i`.
fn lanes<T: Real>(scenes: &[Scene]) -> (Shape<'static, T>, Pose<T>, Shape<'static, T>, Pose<T>, T) {
    let vector = |get: &dyn Fn(&Scene) -> Vec3<f64>| {
        let mut v = Vec3::<T>::ZERO;
        for (lane, scene) in scenes.iter().enumerate() {
            for i in 0..3 {
                v[i].set_lane(lane, T::new(get(scene)[i]).lane(0));
            }
        }
        v
    };
    let pose = |get: &dyn Fn(&Scene) -> Pose<f64>| Pose {
        position: vector(&|s| get(s).position),
        rotation: Mat3 {
            rows: [0, 1, 2].map(|i| vector(&|s| get(s).rotation.rows[i])),
        },
    };
    let shape = |get: &dyn Fn(&Scene) -> Shape<'static, f64>| {
        get(&scenes[0]).resized(vector(&|s| get(s).size()))
    };
    let (a, b) = (shape(&|s| s.a), shape(&|s| s.b));
    let mut margin = T::ZERO;
    for (lane, scene) in scenes.iter().enumerate() {
        margin.set_lane(lane, T::new(scene.margin).lane(0));
    }
    (a, pose(&|s| s.pose_a), b, pose(&|s| s.pose_b), margin)
}

/// Returns the numbers of a point in one lane, as bits of f64, which holds either precision.
fn numbers<T: Real>(c: &ContactPoint<T>, lane: usize) -> Vec<u64> {
    use clench_math::Scalar;
    let [n, t, b] = c.frame.rows;
    let mut values = vec![c.distance];
    for v in [c.position, n, t, b] {
        values.extend(v.to_array());
    }
    let bits = |x: T| x.lane(lane).to_f64().to_bits();
    values.into_iter().map(bits).collect()
}

fn all_finite<T: Real>(c: &ContactPoint<T>) -> bool {
    let rows = c.frame.rows.iter().chain([&c.position]);
    let mut values: Vec<T> = rows.flat_map(|v| v.to_array()).collect();
    values.push(c.distance);
    values.into_iter().all(|x| x.is_finite().all())
}

/// Replaces a size or a coordinate by one that a builder rejects, or by a huge or tiny one.
fn spoil_number(random: &mut Random, scene: &mut Scene) {
    let bad = [f64::NAN, f64::INFINITY, -1.0, 1e300, 1e-300];
    let bad = bad[(random.unit() * 5.0) as usize];
    let axis = (random.unit() * 3.0) as usize;
    match (random.unit() * 4.0) as usize {
        0 => spoil_size(&mut scene.a, axis, bad),
        1 => spoil_size(&mut scene.b, axis, bad),
        2 => scene.pose_b.position[axis] = bad,
        _ => scene.pose_a.rotation.rows[axis].y = bad,
    }
}

fn spoil_size(shape: &mut Shape<'static, f64>, axis: usize, bad: f64) {
    let mut size = shape.size();
    size[axis] = bad;
    *shape = shape.resized(size);
}

/// Checks that each lane finds the same as a single environment. With `spoil`, one lane of each call has a number
/// outside the range of any model, which must not affect the others.
fn lanes_equal_scalars<S, T>(seed: u64, spoil: bool)
where
    S: Real<Scalar = S, Mask = bool>,
    T: Real<Scalar = S>,
{
    let mut random = Random(seed);
    for kinds in PAIRS {
        for _ in 0..300 {
            let mut scenes: Vec<Scene> = (0..T::LANES).map(|_| random.scene(kinds)).collect();
            // All environments have the same hull.
            let first = scenes[0];
            for scene in &mut scenes {
                for (shape, other) in [(&mut scene.a, first.a), (&mut scene.b, first.b)] {
                    if shape.kind() == ShapeKind::Mesh {
                        *shape = other;
                    }
                }
            }
            let bad = spoil.then(|| (random.unit() * T::LANES as f64) as usize);
            if let Some(lane) = bad {
                spoil_number(&mut random, &mut scenes[lane]);
            }
            let (a, pose_a, b, pose_b, margin) = lanes::<T>(&scenes);
            let mut together = Contacts::<T>::new();
            collide(&a, &pose_a, &b, &pose_b, margin, &mut together);
            let finite = together.as_slice().iter().all(all_finite);
            assert!(finite || spoil, "{scenes:?}");
            for (lane, scene) in scenes.iter().enumerate() {
                if bad == Some(lane) {
                    continue;
                }
                let (a, pose_a, b, pose_b, margin) = lanes::<S>(std::slice::from_ref(scene));
                let mut alone = Contacts::<S>::new();
                collide(&a, &pose_a, &b, &pose_b, margin, &mut alone);
                let shared = together.as_slice().iter().filter(|c| c.active.lane(lane));
                let shared: Vec<_> = shared.map(|c| numbers(c, lane)).collect();
                let single: Vec<_> = alone.as_slice().iter().map(|c| numbers(c, 0)).collect();
                assert_eq!(shared, single, "{kinds:?} {scene:?}");
            }
        }
    }
}

#[test]
fn lanes_equal_scalars_to_the_bit() {
    lanes_equal_scalars::<f64, Lanes<f64, 8>>(21, false);
    lanes_equal_scalars::<f64, Lanes<f64, 4>>(22, false);
    lanes_equal_scalars::<f32, Lanes<f32, 16>>(23, false);
}

#[test]
fn numbers_that_no_model_has_stay_in_their_lane() {
    lanes_equal_scalars::<f64, Lanes<f64, 8>>(25, true);
    lanes_equal_scalars::<f64, Lanes<f64, 4>>(26, true);
    lanes_equal_scalars::<f32, Lanes<f32, 16>>(27, true);
}

#[test]
fn single_precision_agrees() {
    let mut random = Random(24);
    for kinds in PAIRS {
        for _ in 0..500 {
            let scene = generic(&mut random, kinds);
            let mut out = Contacts::<f32>::new();
            collide(
                &convert_shape(&scene.a),
                &convert_pose(&scene.pose_a),
                &convert_shape(&scene.b),
                &convert_pose(&scene.pose_b),
                scene.margin as f32,
                &mut out,
            );
            let least = out.as_slice().iter().map(|c| c.distance).reduce(f32::min);
            match (scene.deepest(), least) {
                (Some(c), Some(least)) => {
                    assert!(
                        (c.distance - least as f64).abs() < 1e-5,
                        "{kinds:?} {scene:?}"
                    )
                }
                (Some(c), None) => assert!(c.distance > scene.margin - 1e-5, "{kinds:?} {scene:?}"),
                (None, Some(least)) => {
                    assert!(least as f64 > scene.margin - 1e-5, "{kinds:?} {scene:?}")
                }
                (None, None) => {}
            }
        }
    }
}
