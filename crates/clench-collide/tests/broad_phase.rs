//! The broad phase misses nothing, orders its pairs, and does not allocate once warm.

mod common;

use clench_collide::{Bound, Contacts, Pose, Shape, ShapeKind, Sweep, collide, near, supported};
use clench_math::{Lanes, Mask, Mat3, Real, Vec3};
use common::Random;

const KINDS: [ShapeKind; 6] = {
    use ShapeKind::*;
    [Plane, Sphere, Capsule, Ellipsoid, Cylinder, Box]
};

struct World<T: Real> {
    shapes: Vec<Shape<'static, T>>,
    poses: Vec<Pose<T>>,
    bounds: Vec<Bound<T>>,
    margins: Vec<T>,
}

impl<T: Real> World<T> {
    /// Shapes of all kinds in a slab; in each lane elsewhere.
    fn random(random: &mut Random, count: usize) -> Self {
        let mut world = World {
            shapes: Vec::new(),
            poses: Vec::new(),
            bounds: Vec::new(),
            margins: Vec::new(),
        };
        for _ in 0..count {
            let kind = KINDS[(random.unit() * 6.0) as usize];
            let shape = Shape::new(kind, Vec3::from_f64(random.shape(kind).size.to_array()));
            let mut pose = Pose::<T>::IDENTITY;
            for lane in 0..T::LANES {
                let place = random.vector().scale_by(Vec3::new(5.0, 1.0, 1.0));
                let rotation = random.rotation();
                for i in 0..3 {
                    pose.position[i].set_lane(lane, T::new(place[i]).lane(0));
                    for j in 0..3 {
                        pose.rotation.rows[i][j]
                            .set_lane(lane, T::new(rotation.rows[i][j]).lane(0));
                    }
                }
            }
            world.bounds.push(Bound::new(&shape));
            world.shapes.push(shape);
            world.poses.push(pose);
            world.margins.push(T::new(random.range(0.0, 0.05)));
        }
        world
    }

    /// Whether two shapes are near in any lane.
    fn near(&self, i: usize, j: usize) -> bool {
        let (bounds, poses) = (&self.bounds, &self.poses);
        let margin = self.margins[i] + self.margins[j];
        near(&bounds[i], &poses[i], &bounds[j], &poses[j], margin).any()
    }

    /// Whether the narrow phase finds anything between two shapes.
    fn touch(&self, i: usize, j: usize) -> bool {
        let (i, j) = if self.shapes[i].kind <= self.shapes[j].kind {
            (i, j)
        } else {
            (j, i)
        };
        let margin = self.margins[i] + self.margins[j];
        let mut out = Contacts::new();
        let (shapes, poses) = (&self.shapes, &self.poses);
        collide(
            &shapes[i], &poses[i], &shapes[j], &poses[j], margin, &mut out,
        );
        !out.as_slice().is_empty()
    }
}

fn allowed(i: u32, j: u32) -> bool {
    !(i + j).is_multiple_of(7)
}

fn sweep_misses_nothing<T: Real>(seed: u64) {
    let mut random = Random(seed);
    let (mut sweep, mut pairs) = (Sweep::new(), Vec::new());
    let (mut found, mut most) = (0, 0);
    for count in [0, 1, 2, 60, 150] {
        let world = World::<T>::random(&mut random, count);
        sweep.pairs(
            &world.bounds,
            &world.poses,
            &world.margins,
            allowed,
            &mut pairs,
        );
        assert!(pairs.is_sorted() && pairs.iter().all(|&(i, j)| i < j && allowed(i, j)));

        let list: Vec<(u32, u32)> = (0..count as u32)
            .flat_map(|i| (i + 1..count as u32).map(move |j| (i, j)))
            .filter(|&(i, j)| allowed(i, j))
            .collect();
        let is_near = |&(i, j): &(u32, u32)| world.near(i as usize, j as usize);
        let by_list: Vec<_> = list.iter().copied().filter(is_near).collect();
        assert_eq!(by_list, pairs);

        for pair in &list {
            let (i, j) = (pair.0 as usize, pair.1 as usize);
            if supported(world.shapes[i].kind, world.shapes[j].kind) && world.touch(i, j) {
                found += 1;
                assert!(pairs.binary_search(pair).is_ok(), "missed {i}, {j}");
            }
        }
        most = most.max(list.len());
        assert!(
            count < 60 || pairs.len() < list.len() / 2,
            "{} of {} pairs kept",
            pairs.len(),
            list.len()
        );
    }
    assert!(found > 50 && most > 1000);
}

#[test]
fn the_sweep_finds_every_touching_pair_and_agrees_with_the_list() {
    sweep_misses_nothing::<f64>(31);
    sweep_misses_nothing::<Lanes<f64, 4>>(32);
    sweep_misses_nothing::<f32>(33);
}

#[test]
fn a_warm_sweep_does_not_grow() {
    let mut random = Random(34);
    let world = World::<f64>::random(&mut random, 100);
    let (mut sweep, mut pairs) = (Sweep::new(), Vec::new());
    let mut run = |poses: &[Pose<f64>], pairs: &mut Vec<(u32, u32)>| {
        sweep.pairs(&world.bounds, poses, &world.margins, |_, _| true, pairs);
        (pairs.capacity(), pairs.as_ptr())
    };
    let cold = run(&world.poses, &mut pairs);
    for _ in 0..10 {
        assert_eq!(run(&world.poses, &mut pairs), cold);
    }
}

#[test]
fn a_bound_holds_its_shape() {
    let mut random = Random(35);
    for kind in &KINDS[1..] {
        for _ in 0..200 {
            let shape = random.shape(*kind);
            let pose = Pose {
                position: Vec3::ZERO,
                rotation: Mat3::IDENTITY,
            };
            let radius = Bound::new(&shape).radius;
            let mut widest = 0f64;
            for _ in 0..100 {
                widest = widest.max(common::support(&shape, &pose, random.direction()).norm());
            }
            assert!(
                widest <= radius && radius < 2.0 * widest,
                "{shape:?}: {widest} in {radius}"
            );
        }
    }
}
