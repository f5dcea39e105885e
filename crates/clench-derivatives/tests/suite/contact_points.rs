//! Compares the derivatives of contact points with central differences.

use crate::scenes::placement::{Placement, placed};
use crate::scenes::{PAIRS, Random, Scene, V};
use clench_collide::{
    ContactPoint, Contacts, PairMemory, Pose, SeparatingAxis, Shape, ShapeKind, compiled_collide,
};
use clench_math::{Dual, Mat3, Quat, Real, Vec3};
use std::array::from_fn;

type Number = Dual<f64, 1>;

/// A direction in which both poses and sizes change.
struct Motion {
    velocity: [V; 2],
    rotation: [V; 2],
    growth: [V; 2],
}

impl Motion {
    fn new(random: &mut Random) -> Self {
        let mut pair = || [random.vector(), random.vector()];
        Motion {
            velocity: pair(),
            rotation: pair(),
            growth: pair(),
        }
    }

    /// Returns the scene after a small motion, in a number type.
    fn moved<T: Real>(&self, scene: &Scene, h: T) -> ([Shape<'static, T>; 2], [Pose<T>; 2]) {
        let shapes = [(&scene.a, 0), (&scene.b, 1)].map(|(shape, k)| {
            shape.resized(constant(shape.size()) + constant::<T>(self.growth[k]) * h)
        });
        let poses = [(&scene.pose_a, 0), (&scene.pose_b, 1)].map(|(pose, k)| {
            let turn = Quat::from_rotation_vector(constant::<T>(self.rotation[k]) * h);
            let rows = pose.rotation.rows.map(constant);
            Pose {
                position: constant::<T>(pose.position) + constant::<T>(self.velocity[k]) * h,
                rotation: turn.to_matrix() * Mat3 { rows },
            }
        });
        (shapes, poses)
    }

    fn points<T: Real>(&self, scene: &Scene, h: T) -> Vec<ContactPoint<T>> {
        let ([a, b], [pose_a, pose_b]) = self.moved(scene, h);
        let mut points = Contacts::new();
        let mut axis = SeparatingAxis::default();
        let margin = T::new(scene.margin);
        let memory = &mut PairMemory::of_axis(&mut axis);
        compiled_collide()(&a, &pose_a, &b, &pose_b, margin, memory, &mut points);
        points.as_slice().to_vec()
    }
}

fn constant<T: Real>(v: V) -> Vec3<T> {
    Vec3::from_f64(v.to_array())
}

fn numbers<T: Real>(point: &ContactPoint<T>) -> [T; 13] {
    let [n, t, s] = point.frame.rows;
    let vectors = [point.position, n, t, s].map(|v| v.to_array());
    let mut all = [point.distance; 13];
    all[1..].copy_from_slice(vectors.as_flattened());
    all
}

/// Checks random scenes of a pair.
fn check(kinds: (ShapeKind, ShapeKind)) {
    let random = &mut Random(5);
    let mut compared = 0;
    for k in 0..60 {
        let placement = [Placement::Pressed, Placement::Apart][k % 2];
        let scene = placed(random, kinds, placement);
        let motion = Motion::new(random);
        let h = 1e-6;
        let steps = [h, -h, 0.5 * h, -0.5 * h].map(|h| motion.points(&scene, h));
        for (i, exact) in motion.points(&scene, seeded()).iter().enumerate() {
            let Some(near) = all_have(&steps, i) else {
                continue;
            };
            let [a, b, c, d] = near.map(numbers);
            let differences: [_; 13] = from_fn(|j| ((a[j] - b[j]) / (2.0 * h), (c[j] - d[j]) / h));
            let smooth =
                |&(wide, narrow): &(f64, f64)| (wide - narrow).abs() < 1e-3 * (1.0 + narrow.abs());
            if !differences.iter().all(smooth) {
                continue;
            }
            compared += 1;
            for (j, (exact, (difference, _))) in numbers(exact).iter().zip(differences).enumerate()
            {
                let exact = exact.derivative(0);
                let error = (exact - difference).abs() / (1.0 + difference.abs());
                assert!(
                    error < 1e-6,
                    "{kinds:?}, scene {k}, point {i}, number {j}: {exact} exactly, {difference} by differences"
                );
            }
        }
    }
    // A point switches only if a feature ends within a micrometre.
    assert!(compared >= 55, "{kinds:?}: {compared} points compared");
}

fn seeded() -> Number {
    Dual {
        value: 0.0,
        tangent: [1.0],
    }
}

fn all_have(steps: &[Vec<ContactPoint<f64>>; 4], i: usize) -> Option<[&ContactPoint<f64>; 4]> {
    let count = steps[0].len();
    let same = steps.iter().all(|points| points.len() == count) && i < count;
    same.then(|| [0, 1, 2, 3].map(|k| &steps[k][i]))
}

#[test]
fn contact_points_have_exact_derivatives() {
    PAIRS.into_iter().for_each(check);
}

/// Shapes of equal sizes at round offsets, with parallel and perpendicular axes: many points are equally near.
#[test]
fn symmetric_placements_have_finite_derivatives() {
    let random = &mut Random(6);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let turns = [(1.0, 0.0), (half, half), (0.0, 1.0)];
    let offsets = [0.0, 0.05, 0.1, 0.15, 0.2].into_iter().flat_map(|z| {
        let level = [V::ZERO, V::new(0.05, 0.0, 0.0), V::new(0.1, 0.1, 0.0)];
        level.map(|level| level + V::new(0.0, 0.0, z))
    });
    for (offset, (w, x)) in offsets.flat_map(|offset| turns.map(|turn| (offset, turn))) {
        for (a, b) in PAIRS.into_iter().filter(|&(_, b)| b != ShapeKind::Mesh) {
            let pose = |position: V, (w, x): (f64, f64)| Pose {
                position,
                rotation: Quat::new(w, x, 0.0, 0.0).to_matrix(),
            };
            let size = V::new(0.1, 0.1, 0.1);
            let scene = Scene {
                a: Shape::new(a, size),
                pose_a: pose(V::ZERO, (1.0, 0.0)),
                b: Shape::new(b, size),
                pose_b: pose(offset, (w, x)),
                margin: 0.01,
            };
            // Of a capsule and a cylinder, the cylinder is the second shape.
            let swapped = Scene {
                pose_a: pose(offset, (w, x)),
                pose_b: pose(V::ZERO, (1.0, 0.0)),
                ..scene
            };
            let motion = Motion::new(random);
            for scene in [scene, swapped] {
                for number in motion.points(&scene, seeded()).iter().flat_map(numbers) {
                    let rate = number.derivative(0);
                    assert!(rate.is_finite(), "{a:?}, {b:?}, {offset:?}, {w}, {x}");
                }
            }
        }
    }
}
