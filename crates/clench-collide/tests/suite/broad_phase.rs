//! The broad phase misses nothing, orders its pairs, and does not allocate once warm.

use crate::common::Random;
use clench_collide::{
    Bound, BroadPhase, Contacts, Mobility, Pose, Shape, ShapeKind, collide, near, supported,
};
use clench_math::{Lanes, Mask, Mat3, Real, Vec3};

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
    /// Returns shapes of all kinds in a slab, at different poses in each lane.
    fn random(random: &mut Random, count: usize) -> Self {
        let mut world = World {
            shapes: Vec::new(),
            poses: Vec::new(),
            bounds: Vec::new(),
            margins: Vec::new(),
        };
        for _ in 0..count {
            let kind = KINDS[(random.unit() * 6.0) as usize];
            let shape = Shape::new(kind, Vec3::from_f64(random.shape(kind).size().to_array()));
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
            world.bounds.push(Bound::new(&shape, &pose));
            world.shapes.push(shape);
            world.poses.push(pose);
            world.margins.push(T::new(random.range(0.0, 0.05)));
        }
        world
    }

    /// Returns true if two shapes are near in any lane.
    fn near(&self, i: usize, j: usize) -> bool {
        let margin = self.margins[i] + self.margins[j];
        near(&self.bounds[i], &self.bounds[j], margin).any()
    }

    /// Returns true if the narrow phase finds a contact between two shapes.
    fn touch(&self, i: usize, j: usize) -> bool {
        let (i, j) = if self.shapes[i].kind() <= self.shapes[j].kind() {
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

/// Returns a broad phase of shapes that all move.
fn all_moving(count: usize) -> BroadPhase {
    BroadPhase::new(&vec![Mobility::Moving; count], |shape| shape)
}

fn nothing_is_missed<T: Real>(seed: u64) {
    let mut random = Random(seed);
    let (mut pairs, mut found, mut most) = (Vec::new(), 0, 0);
    for count in [0, 1, 2, 60, 150] {
        let world = World::<T>::random(&mut random, count);
        let mut broad_phase = all_moving(count);
        broad_phase.pairs(
            &world.bounds,
            &world.margins,
            None,
            allowed,
            u64::MAX,
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
            if supported(world.shapes[i].kind(), world.shapes[j].kind()) && world.touch(i, j) {
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
fn every_touching_pair_is_found_as_by_the_list() {
    nothing_is_missed::<f64>(31);
    nothing_is_missed::<Lanes<f64, 4>>(32);
    nothing_is_missed::<f32>(33);
}

#[test]
fn a_warm_broad_phase_does_not_grow() {
    let mut random = Random(34);
    let world = World::<f64>::random(&mut random, 100);
    let (mut broad_phase, mut pairs) = (all_moving(100), Vec::new());
    let mut run = || {
        broad_phase.pairs(
            &world.bounds,
            &world.margins,
            None,
            |_, _| true,
            u64::MAX,
            &mut pairs,
        );
        (pairs.capacity(), pairs.as_ptr())
    };
    let cold = run();
    for _ in 0..10 {
        assert_eq!(run(), cold);
    }
}

#[test]
fn a_bound_holds_its_shape() {
    let mut random = Random(35);
    for kind in &KINDS[1..] {
        for _ in 0..200 {
            let shape = random.shape(*kind);
            let pose = Pose {
                position: random.vector(),
                rotation: random.rotation(),
            };
            let bound = Bound::new(&shape, &pose);
            assert_eq!(bound.center, pose.position);
            let along = |n| crate::common::support(&shape, &pose, n) - pose.position;
            let mut widest = 0f64;
            for _ in 0..100 {
                widest = widest.max(along(random.direction()).norm());
            }
            assert!(
                widest <= bound.radius && bound.radius < 2.0 * widest,
                "{shape:?}: {widest} in {bound:?}"
            );
            for axis in 0..3 {
                let mut n = Vec3::ZERO;
                n[axis] = 1.0;
                let (reach, half) = (along(n)[axis], bound.half[axis]);
                assert!(
                    reach <= half && half < reach * (1.0 + 1e-5),
                    "{shape:?}: {reach} in {bound:?}"
                );
            }
        }
    }
}

/// Returns balls of 1 dm in a heap without gaps.
fn heap(count: usize) -> Vec<Bound<f64>> {
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.05, 0.0, 0.0));
    let edge = (count as f64).cbrt().ceil() as usize;
    let place = |k: usize| {
        Vec3::new(
            (k % edge) as f64,
            (k / edge % edge) as f64,
            (k / edge / edge) as f64,
        )
    };
    (0..count)
        .map(|k| {
            let pose = Pose {
                position: place(k) * 0.099,
                rotation: Mat3::IDENTITY,
            };
            Bound::new(&ball, &pose)
        })
        .collect()
}

/// Returns the number of pairs queried and the number of pairs that are near.
fn asked(bounds: &[Bound<f64>]) -> (usize, usize) {
    let (mut asked, mut pairs) = (0, Vec::new());
    let mut count = |_, _| {
        asked += 1;
        true
    };
    all_moving(bounds.len()).pairs(
        bounds,
        &vec![0.0; bounds.len()],
        None,
        &mut count,
        u64::MAX,
        &mut pairs,
    );
    (asked, pairs.len())
}

#[test]
fn the_number_of_tested_pairs_grows_linearly() {
    for count in [125, 1000, 8000] {
        let bounds = heap(count);
        let (asked, near) = asked(&bounds);
        assert!(near >= 2 * count, "{near} of {count}");
        assert!(asked <= 14 * count, "{asked} of {count}");
    }
}

#[test]
fn large_distant_and_invalid_bounds_do_not_disturb_others() {
    let (mut bounds, ball) = (heap(1000), heap(1)[0]);
    let (_, near) = asked(&bounds);
    let floor = Shape::new(ShapeKind::Box, Vec3::new(100.0, 100.0, 0.05));
    let below = Pose {
        position: Vec3::new(0.0, 0.0, -0.099),
        rotation: Mat3::IDENTITY,
    };
    bounds.push(Bound::new(&floor, &below));
    for far in [1e6, 1e12, 1e300, f64::INFINITY, f64::NAN] {
        let center = Vec3::new(far, 0.0, 0.0);
        bounds.push(Bound { center, ..ball });
        bounds.push(Bound { center, ..ball });
    }
    let (asked, with_floor) = asked(&bounds);
    // The lowest layer lies on the floor. Each distant ball is near its twin if their distance is a number.
    assert_eq!(with_floor, near + 100 + 3);
    assert!(asked <= 15 * bounds.len(), "{asked}");
}

/// Returns static, placed, excluded and moving shapes in turn, `turn` of each.
fn mixed(count: usize, turn: usize) -> Vec<Mobility> {
    use Mobility::{Excluded, Moving, Placed, Static};
    let kinds = [Static, Placed, Excluded, Moving];
    (0..count).map(|i| kinds[i / turn % 4]).collect()
}

#[test]
fn pairs_of_mixed_scenes_are_those_of_which_one_moves() {
    let mut random = Random(36);
    for (count, turn, cluster) in [
        (1, 1, 1),
        (2, 1, 2),
        (5, 1, 3),
        (60, 1, 60),
        (200, 2, 7),
        (300, 50, 300),
    ] {
        let world = World::<Lanes<f64, 4>>::random(&mut random, count);
        let mobility = mixed(count, turn);
        let is = |i: u32, kind: Mobility| mobility[i as usize] == kind;
        let (mut by_turns, mut all, mut again) = (Vec::new(), Vec::new(), Vec::new());
        let mut broad_phase = BroadPhase::new(&mobility, |shape| shape / cluster);
        let (bounds, margins) = (&world.bounds, &world.margins);
        broad_phase.pairs(bounds, margins, None, allowed, u64::MAX, &mut by_turns);
        broad_phase.pairs(bounds, margins, None, allowed, u64::MAX, &mut again);
        all_moving(count).pairs(bounds, margins, None, allowed, u64::MAX, &mut all);
        all.retain(|&(i, j)| is(i, Mobility::Moving) || is(j, Mobility::Moving));
        all.retain(|&(i, j)| !is(i, Mobility::Excluded) && !is(j, Mobility::Excluded));
        assert_eq!(by_turns, all);
        assert_eq!(again, all);

        // Every third shape is awake: pairs of one that is, or of a placed one with another, are found.
        let awake = |i: u32| i.is_multiple_of(3);
        broad_phase.pairs(
            bounds,
            margins,
            Some(&awake),
            allowed,
            u64::MAX,
            &mut by_turns,
        );
        assert!(by_turns.iter().all(|pair| all.contains(pair)));
        let moves = |i: u32| is(i, Mobility::Placed) || (is(i, Mobility::Moving) && awake(i));
        let sleeps = |i: u32| is(i, Mobility::Moving) && !awake(i);
        all.retain(|&(i, j)| moves(i) || moves(j));
        all.retain(|&(i, j)| !(sleeps(i) && is(j, Mobility::Static)));
        assert!(all.iter().all(|pair| by_turns.contains(pair)));
    }
}

#[test]
fn moved_static_shapes_are_checked_again_after_invalidation() {
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.05, 0.0, 0.0));
    let at = |x| {
        let pose = Pose {
            position: Vec3::new(x, 0.0, 0.0),
            rotation: Mat3::IDENTITY,
        };
        Bound::<f64>::new(&ball, &pose)
    };
    let mut broad_phase = BroadPhase::new(&[Mobility::Static, Mobility::Moving], |shape| shape);
    let mut pairs = Vec::new();
    let mut find = |broad_phase: &mut BroadPhase, static_at: f64| {
        let bounds = [at(static_at), at(0.0)];
        broad_phase.pairs(&bounds, &[0.0; 2], None, |_, _| true, u64::MAX, &mut pairs);
        pairs.len()
    };
    assert_eq!(find(&mut broad_phase, 5.0), 0);
    broad_phase.invalidate_statics();
    assert_eq!(find(&mut broad_phase, 0.05), 1);
}
