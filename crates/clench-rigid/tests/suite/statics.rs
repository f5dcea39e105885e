//! Static bodies: poses are computed once, and many geoms are checked once, not in each step.

use crate::scenes::{add, cuboid, free, joint, sphere, world};
use clench_math::Vec3;
use clench_rigid::builder::{BodySpec, GeomSpec, ModelBuilder, SiteSpec};
use clench_rigid::model::JointKind;
use clench_rigid::{Batch, Sim};
use std::sync::Arc;

const TILES: usize = 160;

/// Builds a row of tiles 1 m apart with tops at 0, a ball that touches the first, and one 1 m above the second.
fn tiles() -> ModelBuilder {
    let mut b = world();
    for i in 0..TILES {
        b.bodies[0].geoms.push(GeomSpec {
            pos: Vec3::new(i as f64, 0.0, -0.1),
            ..cuboid([0.3, 0.3, 0.1])
        });
    }
    add(&mut b, 0, "", [0.0, 0.0, 0.099], free(), vec![sphere(0.1)]);
    add(&mut b, 0, "", [1.0, 0.0, 1.1], free(), vec![sphere(0.1)]);
    b
}

/// Returns the positions of all geoms with the tiles raised by `by`.
fn raised(sim: &Sim, by: f64) -> Vec<f64> {
    let mut pos = sim.param("geom_pos").expect("a field");
    for tile in pos.chunks_exact_mut(3).take(TILES) {
        tile[2] += by;
    }
    pos
}

fn touching(sim: &Sim) -> Vec<[usize; 2]> {
    sim.contacts().iter().map(|contact| contact.geoms).collect()
}

#[test]
fn static_bodies_collide_at_their_last_poses() {
    let mut sim = crate::scenes::sim(&tiles());
    sim.forward().expect("finite");
    assert_eq!(touching(&sim), [[TILES, 0]]);
    for (height, found) in [
        (1.0 + 1e-4, vec![[TILES + 1, 1]]),
        (5.0, vec![]),
        (0.0, vec![[TILES, 0]]),
    ] {
        let low = crate::scenes::sim(&tiles());
        sim.set_param("geom_pos", &raised(&low, height))
            .expect("finite");
        sim.forward().expect("finite");
        assert_eq!(touching(&sim), found, "tiles at {height}");
    }
}

#[test]
fn mocap_bodies_collide_at_their_written_poses() {
    let mut b = tiles();
    b.bodies.push(BodySpec {
        pos: Vec3::new(0.0, 50.0, 0.0),
        mocap: true,
        geoms: vec![cuboid([0.1, 0.1, 0.1])],
        ..BodySpec::default()
    });
    let mut sim = crate::scenes::sim(&b);
    sim.forward().expect("finite");
    let before = touching(&sim).len();
    sim.state.mocap_pos[0] = Vec3::new(1.0, 0.0, 0.95);
    sim.forward().expect("finite");
    assert_eq!(touching(&sim).len(), before + 1);
}

#[test]
fn environments_with_different_scenes_move_as_alone() {
    let model = crate::scenes::model(&tiles());
    let heights = [0.0, 0.9, -0.2, 0.05, 0.0];
    let mut batch: Batch = Batch::new(Arc::clone(&model), heights.len()).expect("room");
    let mut alone = Vec::new();
    for (env, &height) in heights.iter().enumerate() {
        let mut sim: Sim = Sim::new(Arc::clone(&model)).expect("a model");
        let pos = raised(&sim, height);
        sim.set_param("geom_pos", &pos).expect("finite");
        batch.randomize("geom_pos", &[env], &pos).expect("finite");
        alone.push(sim);
    }
    for _ in 0..120 {
        batch.step().expect("finite");
        for sim in &mut alone {
            sim.step().expect("finite");
        }
    }
    for (env, sim) in alone.iter().enumerate() {
        let bits = |x: &[f64]| Vec::from_iter(x.iter().map(|x| x.to_bits()));
        assert_eq!(
            bits(batch.state.qpos.row(env)),
            bits(&sim.state.qpos),
            "{env}"
        );
    }
}

/// Builds a table with a fixed box, a pedestal with a pendulum, and a free ball, each body with a site.
fn furniture() -> ModelBuilder {
    let mut b = world();
    let block = || vec![cuboid([0.1, 0.2, 0.1])];
    let table = add(&mut b, 0, "", [0.3, 0.1, 0.2], vec![], block());
    add(&mut b, table, "", [0.0, 0.05, 0.2], vec![], block());
    let pedestal = add(&mut b, 0, "", [2.0, 0.0, 0.2], vec![], block());
    let hinge = vec![joint(JointKind::Hinge, "", [0.0, 1.0, 0.0])];
    add(
        &mut b,
        pedestal,
        "",
        [0.3, 0.0, 0.5],
        hinge,
        vec![sphere(0.1)],
    );
    add(&mut b, 0, "", [0.3, 0.1, 2.0], free(), vec![sphere(0.1)]);
    for body in &mut b.bodies {
        body.sites.push(SiteSpec {
            pos: Vec3::new(0.01, 0.02, 0.03),
            ..SiteSpec::default()
        });
    }
    b
}

#[test]
fn fixed_bodies_follow_the_parameters() {
    for sleep in [false, true] {
        let mut b = furniture();
        b.physics.flags.sleep = sleep;
        let mut sim = crate::scenes::sim(&b);
        for by in [0.0, 0.5, 0.0, -0.25] {
            let mut pos = sim.param("body_pos").expect("a field");
            pos.iter_mut().skip(3).for_each(|x| *x += by);
            if by != 0.0 {
                sim.set_param("body_pos", &pos).expect("finite");
            }
            sim.step().expect("finite");
            sim.step().expect("finite");
            sim.forward().expect("finite");
            let mut fresh = crate::scenes::sim(&b);
            fresh.set_param("body_pos", &pos).expect("finite");
            (fresh.set_configuration(&sim.state.qpos, &sim.state.qvel)).expect("finite");
            fresh.forward().expect("finite");
            let positions = |sim: &Sim| format!("{:?}", sim.workspace().position);
            assert_eq!(positions(&sim), positions(&fresh), "by {by}, sleep {sleep}");
        }
    }
}
