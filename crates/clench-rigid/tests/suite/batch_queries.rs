//! Queries of a batch equal those of a single simulation to the bit, for all lane and thread counts.

use crate::batches::*;
use clench_math::{Instructions, Vec3};
use clench_rigid::batch::{Anchors, QueryInput};
use clench_rigid::builder::{GeomSpec, HeightFieldSpec, ModelBuilder};
use clench_rigid::model::FrameObject;
use clench_rigid::options::RigidOptions;
use clench_rigid::{
    Acceleration, Anchor, Axes, Batch, Ik, IkOptions, IkTarget, IkTask, Precision, RayFilter, Sim,
};
use std::sync::Arc;

const ENVS: usize = 19;

/// Builds the arm over its box, on uneven ground.
fn scene() -> ModelBuilder {
    let mut b = arm_and_box();
    b.height_fields.push(HeightFieldSpec {
        name: "ground".to_owned(),
        rows: 9,
        columns: 7,
        heights: (0..63).map(|k| f64::from(k * k % 11)).collect(),
        size: [1.0, 1.5, 0.3, 0.1],
        origin: None,
    });
    b.add_ground(GeomSpec::height_field("ground").at([0.2, 0.1, -0.4]));
    b
}

/// Returns a batch after some steps, and simulations of its environments in the same states.
fn pair<S: Precision>(instructions: Instructions, threads: usize) -> (Batch<S>, Vec<Sim<S>>) {
    let model = Arc::new(scene().build().unwrap_or_else(|error| panic!("{error}")));
    let envs = Vec::from_iter(0..ENVS);
    let options = with(instructions, threads, RigidOptions::new());
    let mut batch = batch::<S>(&model, &envs, options);
    for step in 0..40 {
        drive(&mut batch, &envs, step);
        batch.step().unwrap();
    }
    let mut sims = Vec::new();
    for env in envs {
        let mut sim = Sim::with_options(Arc::clone(&model), RigidOptions::new()).unwrap();
        batch.state.read(env, &mut sim.state).unwrap();
        sims.push(sim);
    }
    (batch, sims)
}

fn each<S: Precision>(check: impl Fn(&mut Batch<S>, &mut [Sim<S>])) {
    for instructions in Instructions::all_available::<S>() {
        for threads in [1, 3] {
            let (mut batch, mut sims) = pair::<S>(instructions, threads);
            check(&mut batch, &mut sims);
        }
    }
}

fn hand(sim: &Sim<impl Precision>) -> FrameObject {
    FrameObject::Body(sim.model().nbody() - 2)
}

/// Returns the geom that is a height field.
fn ground(sim: &Sim) -> usize {
    let mut geoms = sim.model().geoms.iter();
    (geoms.position(|geom| geom.height_field.is_some())).expect("the scene has one")
}

fn jacobians<S: Precision>(batch: &mut Batch<S>, sims: &mut [Sim<S>]) {
    let object = hand(&sims[0]);
    let body = sims[0].model().nbody() - 2;
    let places: Vec<S> = (0..3 * ENVS).map(|i| S::new(0.1 * i as f64)).collect();
    let points = Anchors::Points {
        body,
        places: QueryInput::Each(&places),
    };
    let trees = batch.subtree_jacobian(0).unwrap();
    for anchors in [Anchors::Object(object), points] {
        let found = batch.jacobian(anchors).expect("the states are valid");
        let rates = batch.jacobian_rate(anchors).expect("the states are valid");
        for (env, sim) in sims.iter_mut().enumerate() {
            let anchor = match anchors {
                Anchors::Object(object) => Anchor::Object(object),
                Anchors::Points { body, .. } => Anchor::Point {
                    body,
                    place: Vec3::from_slice(&places[3 * env..]),
                },
            };
            let mut own = vec![S::ZERO; 6 * sim.model().nv];
            sim.jacobian(anchor, &mut own).expect("the state is valid");
            assert_bits(found.row(env), &own, &|| format!("jacobian {env}"));
            sim.jacobian_rate(anchor, &mut own)
                .expect("the state is valid");
            assert_bits(rates.row(env), &own, &|| format!("rate {env}"));
        }
    }
    for (env, sim) in sims.iter_mut().enumerate() {
        let mut own = vec![S::ZERO; 3 * sim.model().nv];
        sim.subtree_jacobian(0, &mut own)
            .expect("the state is valid");
        assert_bits(trees.row(env), &own, &|| format!("subtree {env}"));
    }
}

#[test]
fn jacobians_are_those_of_each_alone() {
    each::<f64>(jacobians);
    each::<f32>(jacobians);
}

fn motions<S: Precision>(batch: &mut Batch<S>, sims: &mut [Sim<S>]) {
    let object = hand(&sims[0]);
    for axes in [Axes::World, Axes::Local] {
        let velocities = batch.velocity(object, axes).unwrap();
        let accelerations = batch.acceleration(object, axes).unwrap();
        for (env, sim) in sims.iter_mut().enumerate() {
            let flat = |vectors: [Vec3<S>; 2]| vectors.map(Vec3::to_array).concat();
            let own = flat(sim.velocity(object, axes).unwrap());
            assert_bits(velocities.row(env), &own, &|| format!("velocity {env}"));
            let own = flat(sim.acceleration(object, axes).unwrap());
            assert_bits(accelerations.row(env), &own, &|| {
                format!("acceleration {env}")
            });
        }
    }
}

#[test]
fn motions_of_objects_are_those_of_each_alone() {
    each::<f64>(motions);
    each::<f32>(motions);
}

fn masses<S: Precision>(batch: &mut Batch<S>, sims: &mut [Sim<S>]) {
    let nv = sims[0].model().nv;
    let x = Vec::from_iter((0..ENVS * nv).map(|k| S::new((k as f64 * 0.7).sin())));
    let products = batch.mul_mass(QueryInput::Each(&x)).unwrap();
    let solved = batch.solve_mass(QueryInput::Shared(&x[..nv])).unwrap();
    for (env, sim) in sims.iter_mut().enumerate() {
        let mut own = vec![S::ZERO; nv];
        sim.mul_mass(&x[env * nv..][..nv], &mut own).unwrap();
        assert_bits(products.row(env), &own, &|| format!("product {env}"));
        own.copy_from_slice(&x[..nv]);
        sim.solve_mass(&mut own).unwrap();
        assert_bits(solved.row(env), &own, &|| format!("solution {env}"));
    }
    assert!(batch.mul_mass(QueryInput::Each(&x[1..])).is_err());
}

#[test]
fn products_with_mass_matrices_are_those_of_each_alone() {
    each::<f64>(masses);
    each::<f32>(masses);
}

#[test]
fn rays_and_heights_are_those_of_each_alone() {
    each::<f64>(|batch, sims| {
        let object = hand(&sims[0]);
        let mut rays = Vec::new();
        for k in 0..24 {
            let angle = f64::from(k) * 0.26;
            rays.extend([0.0, 0.0, 0.1, angle.cos(), angle.sin(), -0.4]);
        }
        let filter = RayFilter {
            excluded_body: Some(object.body(sims[0].model())),
            ..RayFilter::default()
        };
        let found = batch
            .rays(QueryInput::Shared(&rays), Some(object), &filter)
            .unwrap();
        let geom = ground(&sims[0]);
        let places = Vec::from_iter((0..ENVS * 8).map(|k| (k as f64 * 0.37).sin() * 1.4));
        let heights = batch
            .heights(geom, QueryInput::Each(&places), Some(object))
            .unwrap();
        for (env, sim) in sims.iter_mut().enumerate() {
            let own = sim.rays(&rays, Some(object), &filter).unwrap();
            for (hit, numbers) in own.iter().zip(found.row(env).chunks(5)) {
                match hit {
                    Some(hit) => {
                        assert_eq!((hit.geom as f64, hit.distance), (numbers[0], numbers[1]));
                        assert_eq!(hit.normal, Vec3::from_slice(&numbers[2..]));
                    }
                    None => assert_eq!(numbers[..2], [-1.0, f64::INFINITY]),
                }
            }
            let own = sim
                .heights(geom, &places[8 * env..][..8], Some(object))
                .unwrap();
            assert_bits(heights.row(env), &own, &|| format!("heights {env}"));
        }
    });
}

#[test]
fn heights_equal_hits_of_rays_from_above() {
    let (_, mut sims) = pair::<f64>(Instructions::widest(), 1);
    let sim = &mut sims[0];
    let (geom, filter) = (ground(sim), RayFilter::default());
    let mut compared = 0;
    for k in 0..200 {
        let place = [
            0.2 + 0.9 * (f64::from(k) * 1.7).sin(),
            0.1 + 1.4 * (f64::from(k) * 0.9).cos(),
        ];
        let height = sim.heights(geom, &place, None).unwrap()[0];
        // The ray starts just above it, so that it hits nothing else first.
        let above = Vec3::new(place[0], place[1], height + 1e-3);
        let hit = sim.ray(above, Vec3::new(0.0, 0.0, -1.0), &filter).unwrap();
        if let Some(hit) = hit.filter(|hit| hit.geom == geom) {
            assert!(
                (hit.distance - 1e-3).abs() < 1e-12,
                "{place:?}: {}",
                hit.distance
            );
            compared += 1;
        }
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn inverse_dynamics_are_those_of_each_alone() {
    each::<f64>(|batch, sims| {
        let nv = sims[0].model().nv;
        let qacc = Vec::from_iter((0..ENVS * nv).map(|k| (k as f64).sin() * 5.0));
        for given in [Acceleration::Continuous, Acceleration::Discrete] {
            let found = batch.inverse(QueryInput::Each(&qacc), given).unwrap();
            for (env, sim) in sims.iter_mut().enumerate() {
                let mut own = vec![0.0; nv];
                sim.inverse(&qacc[env * nv..][..nv], given, &mut own)
                    .unwrap();
                assert_bits(found.row(env), &own, &|| format!("{given:?} {env}"));
            }
        }
    });
}

fn kinematics<S: Precision>(batch: &mut Batch<S>, sims: &mut [Sim<S>]) {
    let model = Arc::clone(sims[0].model());
    let object = hand(&sims[0]);
    let tasks = vec![
        IkTask::new(&model, IkTarget::Position(object), 1.0),
        IkTask::new(&model, IkTarget::CentreOfMass(1), 0.5),
        IkTask::new(&model, IkTarget::Posture, 0.01),
    ];
    let ik = Ik::new(&model, tasks, IkOptions::default()).unwrap();
    let width = ik.goal_len(&model);
    let mut goals = Vec::new();
    for env in 0..ENVS {
        let phase = 0.7 * env as f64;
        goals.extend([0.2 * phase.sin(), 0.2 * phase.cos(), 0.4, 0.0, 0.0, 0.6].map(S::new));
        goals.extend_from_slice(batch.state.qpos.row(0));
    }
    let found = batch.ik(&ik, QueryInput::Each(&goals), None).unwrap();
    for (env, sim) in sims.iter_mut().enumerate() {
        let own = sim.ik(&ik, &goals[env * width..][..width], None).unwrap();
        assert_bits(&found[env].qpos, &own.qpos, &|| format!("qpos {env}"));
        assert_bits(&found[env].errors, &own.errors, &|| format!("errors {env}"));
        assert_eq!(found[env].iterations, own.iterations);
        assert_eq!(found[env].status, own.status);
    }
}

#[test]
fn inverse_kinematics_are_those_of_each_alone() {
    each::<f64>(kinematics);
    each::<f32>(kinematics);
}

#[test]
fn an_environment_that_fails_a_query_is_reported_and_disturbs_no_other() {
    let (mut batch, sims) = pair::<f64>(Instructions::widest(), 1);
    let object = hand(&sims[0]);
    let jacobian = |batch: &mut Batch<f64>| {
        let found = batch.jacobian(Anchors::Object(object));
        found.expect("the query is valid")
    };
    let good = jacobian(&mut batch);
    batch.state.qpos.row_mut(3)[0] = f64::NAN;
    let found = jacobian(&mut batch);
    for env in 0..ENVS {
        if env == 3 {
            assert!(found.row(env).iter().all(|x| x.is_nan()));
        } else {
            assert_eq!(found.row(env), good.row(env));
        }
    }
    assert_eq!(batch.statuses().len(), ENVS);
    let refused = batch.rays(QueryInput::Shared(&[1.0; 5]), None, &RayFilter::default());
    let text = refused.expect_err("a ray has six numbers").to_string();
    assert_eq!(text, "rays has 5 numbers where the model needs 6");
    assert!(
        batch
            .heights(0, QueryInput::Shared(&[1.0; 2]), None)
            .is_err()
    );
    assert!(
        batch
            .inverse(QueryInput::Shared(&[1.0]), Acceleration::Continuous)
            .is_err()
    );
}
