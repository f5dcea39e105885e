//! Bodies of several geoms, whose pairs are checked only if the bodies' bounding boxes overlap.

use crate::scenes::{Numbers, add, free, sim, sphere, world};
use clench_math::Vec3;
use clench_rigid::builder::{GeomSpec, ModelBuilder};
use clench_rigid::{Batch, Model, Sim};
use std::sync::Arc;

/// Builds three free bodies of four spheres each; those of the first have a margin.
fn clusters(numbers: &mut Numbers) -> ModelBuilder {
    let mut b = world();
    for body in 0..3 {
        let mut spheres = Vec::new();
        for k in 0..4 {
            let mut place = || 0.4 * numbers.next();
            spheres.push(GeomSpec {
                pos: Vec3::new(place(), place(), place()),
                margin: if body == 0 { 0.03 } else { 0.0 },
                ..sphere(0.05 + 0.02 * k as f64)
            });
        }
        add(&mut b, 0, "", [0.0; 3], free(), spheres);
    }
    b
}

/// Returns random poses of three bodies, some of them close together.
fn poses(numbers: &mut Numbers) -> Vec<f64> {
    let pose = |_| {
        let mut pose = Vec::from_iter((0..3).map(|_| 0.6 * numbers.next()));
        pose.extend((0..4).map(|_| 0.1 + numbers.next()));
        pose
    };
    (0..3).flat_map(pose).collect()
}

/// Returns the pairs of geoms whose spheres are within their margins.
fn expected(model: &Model, sim: &Sim) -> Vec<[usize; 2]> {
    let p = &model.params;
    let centers = &sim.workspace().position.geom_xpos;
    let mut pairs = Vec::new();
    for a in 0..model.geoms.len() {
        for b in a + 1..model.geoms.len() {
            let distance = (centers[b] - centers[a]).norm() - p.geom_size[a].x - p.geom_size[b].x;
            let margin = p.geom_margin[a] + p.geom_margin[b];
            if model.geoms[a].body != model.geoms[b].body && distance <= margin {
                pairs.push([a, b]);
            }
        }
    }
    pairs
}

#[test]
fn no_contact_is_lost() {
    let mut numbers = Numbers(1);
    let mut sim = sim(&clusters(&mut numbers));
    let model = Arc::clone(sim.model());
    let (mut touching, mut apart) = (0, 0);
    for trial in 0..400 {
        let qvel = vec![0.0; model.nv];
        sim.set_configuration(&poses(&mut numbers), &qvel)
            .expect("finite");
        sim.forward().expect("finite");
        let mut found = Vec::from_iter(sim.contacts().iter().map(|contact| contact.geoms));
        found.sort_unstable();
        let expected = expected(&model, &sim);
        assert_eq!(found, expected, "trial {trial}");
        touching += usize::from(!expected.is_empty());
        apart += usize::from(expected.is_empty());
    }
    assert!(touching > 50 && apart > 50, "{touching} and {apart}");
}

#[test]
fn lanes_agree_if_bodies_collide_in_some() {
    let mut numbers = Numbers(2);
    let model = Arc::new(clusters(&mut numbers).build().expect("valid"));
    let envs = 16;
    let mut batch = Batch::<f64>::new(Arc::clone(&model), envs).expect("valid");
    let mut alone = Vec::new();
    for env in 0..envs {
        let mut sim = Sim::<f64>::new(Arc::clone(&model)).expect("valid");
        sim.set_configuration(&poses(&mut numbers), &vec![0.0; model.nv])
            .expect("finite");
        (batch.state.qpos.row_mut(env)).copy_from_slice(&sim.state.qpos);
        alone.push(sim);
    }
    for _ in 0..20 {
        batch.step().expect("valid");
        for (env, sim) in alone.iter_mut().enumerate() {
            sim.step().expect("finite");
            assert_eq!(batch.state.qpos.row(env), sim.state.qpos, "{env}");
        }
    }
}
