//! A cached separating direction changes no contact, even if the shapes are very near the margin, and nor does a proof
//! of the depth of overlapping polyhedra.

use crate::common::{PAIRS, Random, Scene, by_support, convert_pose, convert_shape};
use clench_collide::{
    Contacts, DepthProof, LaneProofs, PairMemory, SeparatingAxis, ShapeKind, collide,
    collide_again, distance,
};
use clench_math::{Lanes, Quat, Real, Vec3};

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
        let memory = &mut PairMemory::of_axis(axis);
        collide_again(&a, &pose_a, &b, &pose_b, margin, memory, &mut again);
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

/// Moves overlapping polyhedra by small steps, and sometimes until a face of one lies level on the other, and compares
/// the contacts found with a proof to those of a fresh search.
fn no_proof_changes_a_contact<T: Real + PartialEq>(seed: u64) {
    let mut random = Random(seed);
    let mut axis = SeparatingAxis::default();
    let mut proofs = vec![DepthProof::default(); 4];
    let mut overlapping = 0;
    for kinds in PROVED {
        for _ in 0..200 {
            let mut scene = random.scene(kinds);
            let Some((distance, normal)) = separation(&scene) else {
                continue;
            };
            scene.pose_b.position -= normal * (distance + random.pick(&[1e-6, 1e-4, 1e-2]));
            if random.unit() < 0.2 {
                scene.pose_b.rotation = scene.pose_a.rotation;
            }
            let step = random.pick(&[1e-9, 1e-6, 1e-4, 1e-3]);
            for _ in 0..24 {
                let turn = Quat::from_rotation_vector(random.vector() * step).to_matrix();
                scene.pose_b.position += random.vector() * (step * 0.1);
                scene.pose_b.rotation = turn * scene.pose_b.rotation;
                let (a, b) = (convert_shape::<T>(&scene.a), convert_shape::<T>(&scene.b));
                let pose_a = convert_pose::<T>(&scene.pose_a);
                let pose_b = convert_pose::<T>(&scene.pose_b);
                let (mut fresh, mut again) = (Contacts::new(), Contacts::new());
                let margin = T::new(scene.margin);
                let memory = &mut PairMemory {
                    axis: &mut axis,
                    proofs: LaneProofs::new(&mut proofs, 0, &[]),
                };
                collide(&a, &pose_a, &b, &pose_b, margin, &mut fresh);
                collide_again(&a, &pose_a, &b, &pose_b, margin, memory, &mut again);
                assert!(fresh.as_slice() == again.as_slice(), "{scene:?}");
                overlapping += usize::from(!fresh.as_slice().is_empty());
            }
        }
    }
    assert!(overlapping > 10_000, "{overlapping}");
}

/// Pairs of polyhedra whose depth is searched for.
const PROVED: [(ShapeKind, ShapeKind); 3] = [
    (ShapeKind::Capsule, ShapeKind::Mesh),
    (ShapeKind::Box, ShapeKind::Mesh),
    (ShapeKind::Mesh, ShapeKind::Mesh),
];

#[test]
fn a_proof_changes_no_contact_in_double_precision() {
    no_proof_changes_a_contact::<f64>(75);
}

#[test]
fn a_proof_changes_no_contact_in_single_precision() {
    no_proof_changes_a_contact::<f32>(76);
}
