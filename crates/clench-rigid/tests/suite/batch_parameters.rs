//! Environments with their own parameters equal single simulations with the same parameters.

use crate::batches::*;
use clench_math::Instructions;
use clench_rigid::builder::{ConnectAnchor, EqualityKind, EqualitySpec, ModelBuilder, SiteSpec};
use clench_rigid::model::ParamField;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions, EnvStatus, Model, Precision, Sim, SimError};
use std::sync::Arc;

const ENVS: usize = 11;
/// Fields that are derived from others.
const FOLLOWERS: [&str; 2] = ["body_subtreemass", "geom_rbound"];

/// Builds two boxes whose sites are welded.
fn tied_sites() -> ModelBuilder {
    let mut b = world();
    for (name, x) in [("left", -0.3), ("right", 0.3)] {
        let solid = cuboid([0.1, 0.08, 0.06]);
        let body = add(&mut b, 0, name, [x, 0.0, 1.0], free(), vec![solid]);
        b.bodies[body].sites.push(SiteSpec {
            name: name.into(),
            ..SiteSpec::default()
        });
    }
    let anchor = ConnectAnchor::Sites {
        site1: "left".into(),
        site2: "right".into(),
    };
    let kind = EqualityKind::Weld {
        anchor,
        relpose: None,
        torquescale: 1.0,
    };
    b.equalities.push(EqualitySpec::new("tie", kind));
    b
}

/// Returns a batch with different values of `fields` in each environment (the last uses the model's), and single
/// simulations with equal values. `change(field, env, i, x)` changes a value of the model.
fn randomized<S: Precision>(
    model: &Arc<Model>,
    options: BatchOptions,
    fields: &[&str],
    change: impl Fn(&str, usize, usize, f64) -> f64,
) -> (Batch<S>, Vec<Sim<S>>) {
    let envs: Vec<usize> = (0..ENVS).collect();
    let mut batch = batch::<S>(model, &envs, options);
    let mut alone: Vec<Sim<S>> = (envs.iter())
        .map(|&env| alone(model, options.options, env))
        .collect();
    for field in fields {
        let mut all = Vec::new();
        for (env, sim) in alone.iter_mut().enumerate().take(ENVS - 1) {
            let numbers = batch.param(field, env).expect("known");
            let changed = numbers.iter().enumerate();
            let changed = changed.map(|(i, x)| S::new(change(field, env, i, x.to_f64())));
            let changed: Vec<S> = changed.collect();
            sim.set_param(field, &changed).expect("valid");
            all.extend(changed);
        }
        batch
            .randomize(field, &envs[..ENVS - 1], &all)
            .expect("valid");
    }
    (batch, alone)
}

fn compare<S: Precision>(batch: &mut Batch<S>, alone: &mut [Sim<S>], steps: usize, what: &str) {
    let envs: Vec<usize> = (0..ENVS).collect();
    for step in 0..steps {
        drive(batch, &envs, step);
        batch.step().expect("valid");
        for (env, sim) in alone.iter_mut().enumerate() {
            drive_alone(sim, env, step);
            sim.step().expect("finite");
            assert_eq!(batch.status(env), EnvStatus::Running);
            assert_state(batch, env, &sim.state, &|| format!("{what}, step {step}"));
        }
    }
}

/// Scales all fields of a model by a few percent and compares.
fn scale_all<S: Precision>(builder: &ModelBuilder, instructions: Instructions, steps: usize) {
    let model = model(builder);
    let fields: Vec<&str> = (ParamField::ALL.iter())
        .map(|field| field.name())
        .filter(|name| !FOLLOWERS.contains(name))
        .collect();
    let options = with(instructions, 2, RigidOptions::new());
    let (mut batch, mut alone) = randomized::<S>(&model, options, &fields, |field, env, _, x| {
        let mut numbers = Numbers(field.len() as u64 * 100 + env as u64);
        x * (1.0 + 0.03 * numbers.next())
    });
    compare(&mut batch, &mut alone, steps, "all fields");
    // The batch's simulation of an environment has its parameters.
    for (env, sim) in alone.iter_mut().enumerate() {
        let mut copy = batch.sim(env).expect("it exists");
        for field in ParamField::ALL {
            let (found, expected) = (copy.params(), sim.params());
            let numbers = found.read_lane(*field, 0);
            assert_eq!(numbers, expected.read_lane(*field, 0), "{}", field.name());
            assert_eq!(numbers, batch.param(field.name(), env).expect("known"));
            assert_eq!(numbers, sim.param(field.name()).expect("known"));
        }
        copy.step().expect("finite");
        sim.step().expect("finite");
        assert_bits(&copy.state.qpos, &sim.state.qpos, &|| {
            format!("copy of {env}")
        });
    }
}

#[test]
fn every_number_can_differ() {
    let mut constraints = everything();
    constraints.options = RigidOptions::new();
    for instructions in Instructions::all_available::<f64>() {
        scale_all::<f64>(&constraints, instructions, 50);
        scale_all::<f64>(&crate::machines::everything(), instructions, 50);
    }
    scale_all::<f64>(&walker(), Instructions::widest(), 200);
    scale_all::<f32>(&walker(), Instructions::widest(), 200);
}

#[test]
fn shapes_are_those_of_the_model() {
    let model = model(&crate::machines::everything());
    for &field in ParamField::ALL {
        let width = field.shape(&model).iter().product::<usize>();
        assert_eq!(width, model.params.width(field), "{field:?}");
        assert_eq!(ParamField::find(field.name()), Ok(field));
    }
    for (field, shape) in [
        (ParamField::timestep, vec![]),
        (ParamField::gravity, vec![3]),
        (ParamField::override_solimp, vec![5]),
        (ParamField::body_mass, vec![model.nbody()]),
        (ParamField::body_inertia, vec![model.nbody(), 3]),
        (ParamField::geom_quat, vec![model.geoms.len(), 4]),
        (ParamField::actuator_gear, vec![model.nu(), 6]),
    ] {
        assert_eq!(field.shape(&model), shape, "{field:?}");
    }
}

#[test]
fn each_number_matters() {
    // Change one field at a time, also from zero: each environment follows its own value, not the model's.
    let nudge = |field: &str, env: usize, i: usize, x: f64| match field {
        "body_mass" | "body_inertia" | "geom_size" => x * (1.1 + 0.05 * env as f64),
        _ => x + 0.01 * (1.0 + (env + i) as f64),
    };
    let model = model(&walker());
    let options = with(Instructions::widest(), 1, RigidOptions::new());
    for field in [
        "gravity",
        "wind",
        "body_mass",
        "body_inertia",
        "body_ipos",
        "body_iquat",
        "body_quat",
        "body_gravcomp",
        "jnt_pos",
        "jnt_stiffness",
        "dof_armature",
        "dof_damping",
        "dof_frictionloss",
        "geom_quat",
        "geom_size",
        "geom_friction",
        "geom_margin",
        "geom_solref",
        "actuator_gainprm",
        "actuator_gear",
    ] {
        let (mut batch, mut alone) = randomized::<f64>(&model, options, &[field], nudge);
        if field == "wind" {
            let envs: Vec<usize> = (0..ENVS).collect();
            let air = [1.2; ENVS];
            batch.randomize("density", &envs, &air).expect("valid");
            for sim in &mut alone {
                sim.set_param("density", &[1.2]).expect("valid");
            }
        }
        compare(&mut batch, &mut alone, 120, field);
        let mut unchanged = Sim::<f64>::new(model.clone()).expect("valid");
        begin(0, &mut unchanged.state);
        for step in 0..120 {
            drive_alone(&mut unchanged, 0, step);
            unchanged.step().expect("finite");
        }
        assert_ne!(unchanged.state.qpos, batch.state.qpos.row(0), "{field}");
    }
}

#[test]
fn masses_and_sizes_update_derived_parameters() {
    let model = model(&walker());
    let mut batch = Batch::<f64>::new(model.clone(), 3).expect("valid");
    let doubled: Vec<f64> = model.params.body_mass.iter().map(|m| 2.0 * m).collect();
    batch.randomize("body_mass", &[1], &doubled).expect("valid");
    let subtree = batch.param("body_subtreemass", 1).expect("known");
    for (b, mass) in subtree.iter().enumerate() {
        let expected = 2.0 * model.params.body_subtreemass[b];
        assert!(
            (mass - expected).abs() < 1e-12 * expected.max(1.0),
            "body {b}"
        );
    }
    assert_eq!(
        batch.param("body_subtreemass", 0),
        Ok(model.params.body_subtreemass.clone())
    );
    let larger = model.params.geom_size.iter();
    let larger: Vec<f64> = larger.flat_map(|s| (*s * 1.5).to_array()).collect();
    batch
        .randomize("geom_size", &[2, 0], &[larger.clone(), larger].concat())
        .expect("valid");
    let radii = batch.param("geom_rbound", 2).expect("known");
    for (g, radius) in radii.iter().enumerate() {
        let expected = 1.5 * model.params.geom_rbound[g];
        assert!((radius - expected).abs() < 1e-12, "geom {g}");
    }
    assert_eq!(
        batch.param("geom_rbound", 1),
        Ok(model.params.geom_rbound.clone())
    );
}

#[test]
fn equalities_between_sites_follow_the_sites() {
    let model = model(&tied_sites());
    let moved = [0.1, 0.0, 0.2, -0.1, 0.3, 0.0];
    let turned = [0.8, 0.6, 0.0, 0.0, 0.0, 0.0, 0.6, -0.8];
    let mut batch = Batch::<f64>::new(model.clone(), 2).expect("valid");
    let mut sim = Sim::<f64>::new(model.clone()).expect("valid");
    for (field, numbers) in [("site_pos", &moved[..]), ("site_quat", &turned[..])] {
        batch.randomize(field, &[1], numbers).expect("valid");
        sim.set_param(field, numbers).expect("valid");
    }
    for (field, second) in [("eq_anchor", 3), ("eq_quat", 4)] {
        let all = if second == 3 { &moved[..] } else { &turned[..] };
        for (end, expected) in [("1", &all[..second]), ("2", &all[second..])] {
            let field = &format!("{field}{end}");
            assert_eq!(sim.param(field).expect("known"), expected, "{field}");
            assert_eq!(batch.param(field, 1).expect("known"), expected, "{field}");
            let of_model = model
                .params
                .read_lane(ParamField::find(field).expect("known"), 0);
            assert_eq!(batch.param(field, 0).expect("known"), of_model, "{field}");
        }
    }
}

#[test]
fn directions_are_made_unit() {
    let model = model(&walker());
    let mut batch = Batch::<f64>::new(model.clone(), 1).expect("valid");
    let long: Vec<f64> = model
        .params
        .jnt_axis
        .iter()
        .flat_map(|a| (*a * 3.0).to_array())
        .collect();
    batch.randomize("jnt_axis", &[0], &long).expect("valid");
    let axes = batch.param("jnt_axis", 0).expect("known");
    for axis in axes.chunks(3) {
        let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((norm - 1.0).abs() < 1e-15);
    }
}

#[test]
fn a_reset_keeps_the_numbers() {
    let model = model(&walker());
    let mut batch = Batch::<f64>::new(model, 4).expect("valid");
    batch
        .randomize("gravity", &[2], &[0.0, 0.0, -1.0])
        .expect("valid");
    let before = batch.save().expect("valid");
    batch.step_n(20).expect("valid");
    batch.reset(2).expect("it exists");
    assert_eq!(batch.param("gravity", 2), Ok(vec![0.0, 0.0, -1.0]));
    batch.restore(&before).expect("its own");
    assert_eq!(batch.param("gravity", 2), Ok(vec![0.0, 0.0, -1.0]));
    assert_eq!(batch.param("gravity", 1), Ok(vec![0.0, 0.0, -9.81]));
}

/// Invalid parameters return errors.
#[test]
fn bad_parameters_are_errors_and_change_nothing() {
    let model = model(&walker());
    let (nbody, njnt) = (model.nbody(), model.joints.len());
    let mut batch = Batch::<f64>::new(model.clone(), 2).expect("valid");
    let mut sim = Sim::<f64>::new(model.clone()).expect("valid");
    let mass = |b: usize, m: f64| {
        let mut masses = model.params.body_mass.clone();
        masses[b] = m;
        masses
    };
    assert_eq!(sim.param("bodymass"), batch.param("bodymass", 0));
    assert!(sim.param("bodymass").is_err());
    let range = |low: f64, high: f64| [low, high].repeat(njnt);
    for (field, values, message) in [
        (
            "bodymass",
            vec![],
            "there is no parameter \"bodymass\"; did you mean \"body_mass\"?",
        ),
        (
            "body_subtreemass",
            vec![],
            "body_subtreemass is computed from body_mass: set body_mass instead",
        ),
        (
            "geom_rbound",
            vec![],
            "geom_rbound is computed from geom_size: set geom_size instead",
        ),
        (
            "gravity",
            vec![1.0],
            "gravity has 1 numbers where the model needs 3",
        ),
        (
            "timestep",
            vec![0.0],
            "timestep[0] is 0, but must be positive and finite",
        ),
        (
            "gravity",
            vec![0.0, f64::NAN, 0.0],
            "gravity[1] is NaN, but must be finite",
        ),
        (
            "body_mass",
            mass(2, 0.0),
            "body_mass[2] is 0, but must be positive and finite",
        ),
        (
            "body_mass",
            mass(0, -1.0),
            "body_mass[0] is -1, but must be finite, zero or more",
        ),
        (
            "body_mass",
            mass(1, f64::INFINITY),
            "body_mass[1] is inf, but must be positive and finite",
        ),
        (
            "dof_armature",
            vec![-0.1; model.nv],
            "dof_armature[0] is -0.1, but must be finite, zero or more",
        ),
        (
            "jnt_range",
            range(0.5, -0.5),
            "jnt_range[1] is -0.5, but must be at least the preceding number",
        ),
        (
            "jnt_range",
            range(f64::NAN, 0.0),
            "jnt_range[0] is NaN, but must be a number, or infinite",
        ),
        (
            "body_quat",
            vec![0.0; 4 * nbody],
            "body_quat[0] is 0, but must be part of a direction whose length is finite and not too small",
        ),
    ] {
        let together = batch.randomize(field, &[0, 1], &values.repeat(2));
        let alone = sim.set_param(field, &values).expect_err("bad");
        assert_eq!(alone.to_string(), message);
        let together = together.expect_err("bad").to_string();
        if !matches!(alone, SimError::WrongLength { .. }) {
            assert_eq!(together, message);
        }
    }
    let far = batch
        .randomize("gravity", &[0, 2], &[0.0; 6])
        .expect_err("two environments");
    assert_eq!(far.to_string(), "there is no environment 2: there are 2");
    let unlike = batch
        .randomize("qqqqqq", &[], &[])
        .expect_err("no such name")
        .to_string();
    assert!(unlike.contains("there are timestep, gravity"), "{unlike}");
    for field in ParamField::ALL {
        let expected = model.params.read_lane(*field, 0);
        assert_eq!(batch.param(field.name(), 0).expect("known"), expected);
        assert_eq!(sim.params().read_lane(*field, 0), expected);
    }
}

#[test]
fn constants_in_single_precision_are_those_of_a_simulation() {
    let model = model(&walker());
    let heavier: Vec<f32> = model
        .params
        .body_mass
        .iter()
        .map(|m| 1.1 * *m as f32)
        .collect();
    let mut batch = Batch::<f32>::new(model.clone(), 2).expect("valid");
    let mut sim = Sim::<f32>::new(model).expect("valid");
    batch.randomize("body_mass", &[1], &heavier).expect("valid");
    sim.set_param("body_mass", &heavier).expect("valid");
    batch.set_constants(&[1]).expect("positive");
    sim.set_constants().expect("positive");
    for field in ParamField::ALL.iter().map(|field| field.name()) {
        assert_eq!(batch.param(field, 1), sim.param(field), "{field}");
    }
}

fn directions_keep_their_bits<S: Precision>() {
    let model = model(&tied_sites());
    let mut sim = Sim::<S>::new(model.clone()).expect("valid");
    let mut batch = Batch::<S>::new(model.clone(), 1).expect("valid");
    for field in ["body_quat", "body_iquat", "geom_quat", "eq_quat2"] {
        for k in 1..40 {
            let count = sim.param(field).expect("known").len();
            let numbers = (0..count).map(|i| S::new((1.7 * (i * k) as f64 + 1.0).sin()));
            sim.set_param(field, &Vec::from_iter(numbers))
                .expect("valid");
            let once = sim.param(field).expect("known");
            let what = || format!("{field} {k}");
            sim.set_param(field, &once).expect("valid");
            assert_bits(&sim.param(field).expect("known"), &once, &what);
            batch.randomize(field, &[0], &once).expect("valid");
            assert_bits(&batch.param(field, 0).expect("known"), &once, &what);
        }
    }
}

#[test]
fn directions_that_are_read_and_set_again_keep_their_bits() {
    directions_keep_their_bits::<f64>();
    directions_keep_their_bits::<f32>();
}
