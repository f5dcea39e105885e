//! A cached separating direction changes no contact, even if the shapes are very near the margin.

use crate::common::{PAIRS, Random, Scene, by_support, convert_pose, convert_shape};
use clench_collide::{Contacts, SeparatingAxis, ShapeKind, collide, collide_again, distance};
use clench_math::{Lanes, Real, Vec3};

/// Collides a pair repeatedly while the second shape moves about the margin. Returns the number of times without
/// contact.
fn tremble<T: Real + PartialEq>(
    random: &mut Random,
    scene: &Scene,
    axis: &mut SeparatingAxis<T>,
) -> usize {
    let (a, b) = (convert_shape::<T>(&scene.a), convert_shape::<T>(&scene.b));
    let pose_a = convert_pose::<T>(&scene.pose_a);
    let margin = T::new(scene.margin);
    // The distance and normal give the motion that puts the shapes exactly the margin apart.
    let (distance, normal) = separation(scene).unwrap_or((scene.margin, Vec3::ZERO));
    let mut apart = 0;
    for _ in 0..24 {
        let mut pose_b = convert_pose::<T>(&scene.pose_b);
        for lane in 0..T::LANES {
            let to_margin = scene.margin - distance + random.pick(&[0.0, 1e-7, 1e-6, 1e-5, 1e-3]);
            let by = random.direction() * random.pick(&[0.0, 1e-9, 1e-6, 1e-4, 1e-2]);
            let place = scene.pose_b.position + normal * to_margin + by;
            for i in 0..3 {
                pose_b.position[i].set_lane(lane, T::new(place[i]).lane(0));
            }
        }
        let (mut fresh, mut again) = (Contacts::new(), Contacts::new());
        collide(&a, &pose_a, &b, &pose_b, margin, &mut fresh);
        collide_again(&a, &pose_a, &b, &pose_b, margin, axis, &mut again);
        assert!(fresh.as_slice() == again.as_slice(), "{scene:?}");
        apart += usize::from(fresh.as_slice().is_empty());
    }
    apart
}

/// Returns the distance of the shapes and its normal.
fn separation(scene: &Scene) -> Option<(f64, Vec3<f64>)> {
    let Scene {
        a,
        pose_a,
        b,
        pose_b,
        ..
    } = scene;
    distance(a, pose_a, b, pose_b, f64::INFINITY).map(|found| (found.distance, found.normal))
}

/// Returns true if a pair uses a cached direction.
fn remembers(kinds: (ShapeKind, ShapeKind)) -> bool {
    by_support(kinds) || kinds == (ShapeKind::Box, ShapeKind::Box)
}

fn no_contact_changes<T: Real + PartialEq>(seed: u64) {
    let mut random = Random(seed);
    let (mut apart, mut all) = (0, 0);
    for kinds in PAIRS.into_iter().filter(|&kinds| remembers(kinds)) {
        let mut axis = SeparatingAxis::default();
        for _ in 0..40 {
            // Each scene passes its direction on to the next.
            let scene = random.scene(kinds);
            apart += tremble::<T>(&mut random, &scene, &mut axis);
            all += 24;
        }
    }
    assert!(apart * 10 > all && apart * 10 < 9 * all, "{apart} of {all}");
}

#[test]
fn an_old_direction_changes_no_contact_in_double_precision() {
    no_contact_changes::<f64>(71);
}

#[test]
fn an_old_direction_changes_no_contact_in_single_precision() {
    no_contact_changes::<f32>(72);
}

#[test]
fn an_old_direction_changes_no_contact_in_lanes() {
    no_contact_changes::<Lanes<f64, 4>>(73);
    no_contact_changes::<Lanes<f32, 8>>(74);
}
