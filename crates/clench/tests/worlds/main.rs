//! Batches of several models: each environment moves exactly as a simulation of its own model.

mod layout;
mod scenes;

use clench::math::Instructions;
use clench::{Batch, BatchOptions, EnvStatus, Precision, RigidOptions, Sim};
use scenes::{models, scene};
use std::sync::Arc;

/// Returns the model of each environment: every model several times, not in order.
fn env_models(models: usize, envs: usize) -> Vec<usize> {
    (0..envs)
        .map(|env| (7 * env + env / models) % models)
        .collect()
}

/// Returns a number between −1 and 1 that depends on an environment, a step and an index.
fn input(env: usize, step: usize, index: usize) -> f64 {
    ((env * 31 + step / 20 * 17 + index * 7) as f64 * 0.7).sin()
}

/// Steps a batch beside single simulations and compares their states and sensors.
fn compare<S: Precision>(batch: &mut Batch<S>, alone: &mut [Sim<S>], steps: usize) {
    for step in 0..steps {
        for (env, sim) in alone.iter_mut().enumerate() {
            for (index, ctrl) in sim.state.ctrl.iter_mut().enumerate() {
                *ctrl = S::new(input(env, step, index));
            }
            batch
                .state
                .ctrl
                .row_mut(env)
                .copy_from_slice(&sim.state.ctrl);
        }
        batch.step().expect("valid");
        for (env, sim) in alone.iter_mut().enumerate() {
            sim.step().expect("finite");
            assert_eq!(batch.status(env), EnvStatus::Running, "environment {env}");
            let model = batch.env_model(env);
            let found = batch.sim(env).expect("exists");
            assert!(
                found.state == sim.state,
                "model {model}, environment {env}, step {step}"
            );
        }
    }
    let sensors = batch.output("sensordata").expect("recorded");
    for (env, sim) in alone.iter_mut().enumerate() {
        let expected = sim.output("sensordata").expect("an output");
        assert_eq!(sensors.row(env), expected, "environment {env}");
    }
}

/// Returns single simulations of the environments of a batch.
fn singles<S: Precision>(batch: &Batch<S>, options: RigidOptions) -> Vec<Sim<S>> {
    let own = |env| Arc::clone(&batch.models()[batch.env_model(env)]);
    let sims = (0..batch.count()).map(|env| Sim::with_options(own(env), options));
    sims.map(|sim| sim.expect("valid")).collect()
}

fn agree<S: Precision>(options: RigidOptions, instructions: Instructions, steps: usize) {
    let models = models();
    let options = BatchOptions {
        options,
        instructions: Some(instructions),
        ..BatchOptions::default()
    };
    let of_env = env_models(models.len(), 2 * models.len() + 3);
    let mut batch = Batch::<S>::of_models(&models, &of_env, options).expect("same joints");
    batch.record(&["sensordata"]).expect("an output");
    let mut alone = singles(&batch, options.options);
    compare(&mut batch, &mut alone, steps);
    let touching = alone.iter().filter(|sim| !sim.contacts().is_empty());
    assert!(touching.count() > batch.count() / 2);
}

#[test]
fn environments_of_many_models_equal_single_simulations() {
    for instructions in Instructions::all_available::<f64>() {
        agree::<f64>(RigidOptions::new(), instructions, 250);
    }
    for instructions in Instructions::all_available::<f32>() {
        agree::<f32>(RigidOptions::new(), instructions, 250);
    }
}

#[test]
fn models_may_differ_in_gravity_wind_and_the_magnetic_field() {
    let model = |option: &str| {
        let text = format!(
            r#"<mujoco><option density="20" {option}/><worldbody>
                 <body><freejoint/><geom size=".1"/><site name="s"/></body>
               </worldbody><sensor><magnetometer site="s"/></sensor></mujoco>"#
        );
        Arc::new(clench::load_str(&text).expect("valid"))
    };
    let options = ["", "gravity='0 0 -5'", "wind='0 3 0'", "magnetic='0 0 2'"];
    let models = options.map(model);
    let own = BatchOptions::default();
    let mut batch = Batch::<f64>::of_models(&models, &[3, 1, 2, 0], own).expect("same joints");
    batch.record(&["sensordata"]).expect("an output");
    let mut alone = singles(&batch, RigidOptions::new());
    compare(&mut batch, &mut alone, 20);
}

#[test]
fn options_act_on_all_models() {
    let elliptic = RigidOptions::new().friction_cone(clench::prelude::FrictionCone::Elliptic);
    let widest = Instructions::all_available::<f64>()
        .next_back()
        .expect("some");
    agree::<f64>(elliptic.noslip_iterations(3), widest, 250);
}

#[test]
fn an_environment_gets_another_model_when_it_is_reset() {
    let models = models();
    let of_env = vec![0; 9];
    let mut batch = Batch::<f64>::of_models(&models, &of_env, BatchOptions::default()).unwrap();
    batch.record(&["sensordata"]).expect("an output");
    batch.step_n(20).expect("valid");
    let envs = Vec::from_iter(0..9);
    let next = env_models(models.len(), 9);
    batch.reset_to_models(&envs, &next).expect("all exist");
    assert_eq!(
        Vec::from_iter(envs.iter().map(|&env| batch.env_model(env))),
        next
    );
    let mut alone = singles(&batch, RigidOptions::new());
    compare(&mut batch, &mut alone, 100);
    assert!(batch.reset_to_models(&[0], &[models.len()]).is_err());
    assert!(batch.reset_to_models(&[9], &[0]).is_err());
    assert!(batch.reset_to_models(&[0, 1], &[0]).is_err());
}

#[test]
fn parameters_of_an_environment_are_those_of_its_model_until_they_are_set() {
    let models = models();
    let of_env = env_models(models.len(), 10);
    let mut batch = Batch::<f64>::of_models(&models, &of_env, BatchOptions::default()).unwrap();
    batch.record(&["sensordata"]).expect("an output");
    let mut alone = singles(&batch, RigidOptions::new());
    let (mut sizes, mut masses) = (Vec::new(), Vec::new());
    for (env, sim) in alone.iter_mut().enumerate() {
        let geoms = batch.geoms_of(of_env[env]).expect("a model");
        // Half of the environments get larger primitives, and all heavier bodies.
        let mut own = sim.param("geom_size").expect("a field");
        for (geom, size) in sim.model().geoms.iter().zip(own.chunks_mut(3)) {
            if geom.mesh.is_none() && geom.height_field.is_none() && env % 2 == 0 {
                size.iter_mut().for_each(|x| *x *= 1.1);
            }
        }
        sim.set_param("geom_size", &own).expect("valid");
        let mut row = batch.param("geom_size", env).expect("a field");
        for (size, &slot) in own.chunks(3).zip(&geoms) {
            row[3 * slot..][..3].copy_from_slice(size);
        }
        sizes.extend(row);
        let mass = sim.param("body_mass").expect("a field");
        let mass = Vec::from_iter(mass.iter().map(|x| 1.25 * x));
        sim.set_param("body_mass", &mass).expect("valid");
        sim.set_constants().expect("positive");
        masses.extend(mass);
    }
    let envs = Vec::from_iter(0..10);
    batch.randomize("geom_size", &envs, &sizes).expect("valid");
    batch.randomize("body_mass", &envs, &masses).expect("valid");
    batch.set_constants(&envs).expect("positive");
    compare(&mut batch, &mut alone, 150);
    // A reset to a model drops the values, whether it is another one or the same.
    for (env, model) in [(0, 3), (1, of_env[1])] {
        batch.reset_to_models(&[env], &[model]).expect("exists");
        let mass = batch.param("body_mass", env).expect("a field");
        assert_eq!(mass, models[model].params.body_mass);
    }
}

#[test]
fn rays_and_heights_are_those_of_the_own_model() {
    let models = models();
    let of_env = env_models(models.len(), 3 * models.len());
    let mut batch = Batch::<f64>::of_models(&models, &of_env, BatchOptions::default()).unwrap();
    let mut rays = Vec::new();
    for k in 0..40 {
        let (x, y) = (input(k, 0, 1), input(k, 0, 2));
        rays.extend([x, y, 2.0, -0.4 * x, -0.4 * y, -1.0]);
    }
    let filter = clench::RayFilter::default();
    let found = batch.rays(
        clench::rigid::batch::QueryInput::Shared(&rays),
        None,
        &filter,
    );
    let found = found.expect("finite");
    for (env, &model) in of_env.iter().enumerate() {
        let mut sim = batch.sim(env).expect("exists");
        let expected = sim.rays(&rays, None, &filter).expect("finite");
        let geoms = batch.geoms_of(model).expect("a model");
        for (k, expected) in expected.iter().enumerate() {
            let hit = &found.row(env)[5 * k..][..5];
            match expected {
                Some(own) => {
                    assert_eq!(
                        hit[0] as usize, geoms[own.geom],
                        "environment {env}, ray {k}"
                    );
                    assert_eq!(hit[1], own.distance);
                }
                None => assert_eq!(hit[0], -1.0),
            }
        }
    }
}

#[test]
fn a_failed_environment_starts_over_from_its_own_model() {
    let fall = |height: &str| {
        let geoms = r#"<geom type="sphere" size=".1"/>"#;
        scene("fall", geoms, "").replace("0 0 .35", height)
    };
    let load = |text: String| Arc::new(clench::load_str(&text).expect("valid"));
    let models = [load(fall("0 0 .5")), load(fall("0 0 1.5"))];
    let options = BatchOptions {
        options: RigidOptions::new().autoreset(true),
        ..BatchOptions::default()
    };
    let mut batch = Batch::<f64>::of_models(&models, &[1, 0, 1], options).expect("same joints");
    for env in 0..3 {
        batch.state.qvel.row_mut(env)[1] = f64::INFINITY;
    }
    let summary = batch.step().expect("valid");
    assert_eq!(summary.resets, 3);
    for (env, height) in [1.5, 0.5, 1.5].into_iter().enumerate() {
        let z = batch.state.qpos.row(env)[4];
        assert!((z - height).abs() < 1e-3, "environment {env} is at {z}");
    }
}

#[test]
fn the_fluid_acts_on_the_own_geoms_alone() {
    let world = |condim: u32| {
        let text = format!(
            "<mujoco><option density='50' viscosity='.1'/><worldbody><body><freejoint/>
               <geom type='ellipsoid' size='.2 .1 .05' fluidshape='ellipsoid' condim='{condim}'/>
             </body></worldbody><sensor><clock/></sensor></mujoco>"
        );
        Arc::new(clench::load_str(&text).expect("valid"))
    };
    let models = [world(1), world(3)];
    let mut batch =
        Batch::<f64>::of_models(&models, &[0, 1, 1], BatchOptions::default()).expect("a batch");
    batch.record(&["sensordata"]).expect("an output");
    assert_eq!(batch.model().geoms.len(), 2);
    let mut alone = singles(&batch, RigidOptions::new());
    compare(&mut batch, &mut alone, 20);
}

#[test]
fn added_masses_follow_the_sizes_of_the_own_geoms() {
    let world = |extra: &str| {
        let text = format!(
            "<mujoco><option density='1000'/><worldbody>{extra}<body><freejoint/>
               <geom name='hull' type='ellipsoid' size='.1 .2 .3' fluidshape='ellipsoid'/></body></worldbody></mujoco>"
        );
        Arc::new(clench::load_str(&text).expect("valid"))
    };
    let models = [
        world(""),
        world("<geom name='rock' size='.1' pos='9 0 0'/>"),
    ];
    let mut batch =
        Batch::<f64>::of_models(&models, &[0, 1, 1], BatchOptions::default()).expect("a batch");
    let mut alone = singles(&batch, RigidOptions::new());
    let before = batch.param("geom_virtualmass", 2).expect("a field");
    for (env, sim) in alone.iter_mut().enumerate().take(2) {
        let sizes = sim.param("geom_size").expect("a field");
        let larger = Vec::from_iter(sizes.iter().map(|x| 1.5 * x));
        sim.set_param("geom_size", &larger).expect("valid");
        sim.set_constants().expect("positive");
        let row = batch.param("geom_size", env).expect("a field");
        let row = Vec::from_iter(row.iter().map(|x| 1.5 * x));
        batch.randomize("geom_size", &[env], &row).expect("valid");
        batch.set_constants(&[env]).expect("positive");
        let own = sim.param("geom_virtualmass").expect("a field");
        let all = batch.param("geom_virtualmass", env).expect("a field");
        for (mass, &slot) in own.chunks(3).zip(&batch.geoms_of(env).expect("a model")) {
            assert_eq!(&all[3 * slot..][..3], mass, "environment {env}");
        }
        let largest = own.iter().copied().fold(0.0, f64::max);
        let smaller = before.iter().copied().fold(0.0, f64::max);
        assert!((largest / smaller - 1.5f64.powi(3)).abs() < 1e-6);
    }
    assert_eq!(batch.param("geom_virtualmass", 2).expect("a field"), before);
}
