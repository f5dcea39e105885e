//! Constraints that are added and removed while a simulation runs.

use crate::batches::*;
use clench_math::{Instructions, Vec3};
use clench_rigid::builder::{ConnectAnchor, EqualityKind, EqualitySpec, ModelBuilder};
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, DynamicConstraint, Model, Precision, Sim, SimError, State};
use std::sync::Arc;

/// Returns a weld of the model that is off.
fn weld(name: &str, body1: &str, body2: &str) -> EqualitySpec {
    let anchor = ConnectAnchor::Bodies {
        body1: body1.into(),
        body2: body2.into(),
        anchor: Vec3::ZERO,
    };
    let kind = EqualityKind::Weld {
        anchor,
        relpose: None,
        torquescale: 1.0,
    };
    EqualitySpec {
        active: false,
        ..EqualitySpec::new(name, kind)
    }
}

/// Builds three boxes in the air above a floor.
fn boxes() -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new();
    b.bodies[0].geoms.push(plane());
    for (name, x) in [("left", -0.3), ("middle", 0.0), ("right", 0.3)] {
        let solid = cuboid([0.1, 0.08, 0.06]);
        add(&mut b, 0, name, [x, 0.1 * x, 0.4 + x], free(), vec![solid]);
    }
    b
}

/// Returns a thrown simulation after a few steps.
fn thrown(model: &Arc<Model>) -> Sim {
    let mut sim = Sim::new(model.clone()).expect("valid");
    begin(3, &mut sim.state);
    (0..20).for_each(|_| sim.step().expect("finite"));
    sim
}

fn assert_same_motion(one: &Sim, other: &Sim) {
    let what = || "motion".to_owned();
    assert_bits(&one.state.qpos, &other.state.qpos, &what);
    assert_bits(&one.state.qvel, &other.state.qvel, &what);
}

#[test]
fn a_weld_added_now_is_one_of_the_file_that_holds_the_present_pose() {
    let mut builder = boxes();
    builder.equalities.push(weld("grip", "left", "right"));
    let model = model(&builder);
    let (mut added, mut switched) = (thrown(&model), thrown(&model));
    added.add_weld(1, 3).expect("there is room");
    switched.weld_here(0).expect("a weld");
    for _ in 0..200 {
        added.step().expect("finite");
        switched.step().expect("finite");
        assert_same_motion(&added, &switched);
    }
    assert_eq!(
        added.output("cfrc_ext").expect("known"),
        switched.output("cfrc_ext").expect("known")
    );
}

#[test]
fn a_batch_adopts_the_bits_of_the_pose_that_a_simulation_adopts() {
    let mut builder = boxes();
    builder.equalities.push(weld("grip", "left", "right"));
    let model = model(&builder);
    for env in 0..40 {
        let mut sim: Sim = alone(&model, RigidOptions::new(), env);
        (0..20).for_each(|_| sim.step().expect("finite"));
        let mut batch: Batch = Batch::new(model.clone(), 1).expect("valid");
        batch.state.write(0, &sim.state).expect("it is there");
        sim.weld_here(0).expect("a weld");
        batch.weld_here(&[0], 0).expect("a weld");
        let mut copy: Sim = Sim::new(model.clone()).expect("valid");
        for field in ["eq_anchor1", "eq_anchor2", "eq_quat1"] {
            let expected = sim.param(field).expect("known");
            copy.restore_param(field, &expected).expect("valid");
            for found in [batch.param(field, 0), copy.param(field)] {
                let what = || format!("{field} of environment {env}");
                assert_bits(&found.expect("known"), &expected, &what);
            }
        }
    }
}

#[test]
fn welded_bodies_keep_their_pose_until_they_are_released() {
    let model = model(&boxes());
    let mut sim = thrown(&model);
    let apart = |sim: &mut Sim| {
        let xpos = sim.output("xpos").expect("known");
        let turn = sim.output("xmat").expect("known");
        let between: Vec<f64> = (0..3).map(|i| xpos[9 + i] - xpos[3 + i]).collect();
        // In the frame of the first body.
        let along = |axis: usize| (0..3).map(|i| turn[9 + 3 * i + axis] * between[i]).sum();
        [along(0), along(1), along(2)]
    };
    sim.forward().expect("finite");
    let before: [f64; 3] = apart(&mut sim);
    let held = sim.add_weld(1, 3).expect("there is room");
    (0..300).for_each(|_| sim.step().expect("finite"));
    sim.forward().expect("finite");
    let after = apart(&mut sim);
    assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 0.02));
    sim.remove(held).expect("it is there");
    assert_eq!(sim.dynamic_constraints().count(), 0);
    sim.state.qvel[0] = 3.0;
    (0..100).for_each(|_| sim.step().expect("finite"));
    let freed = apart(&mut sim);
    assert!((freed[0] - after[0]).abs() > 0.1, "{after:?} {freed:?}");
}

#[test]
fn stale_handles_and_invalid_bodies_are_refused() {
    let mut builder = boxes();
    add(&mut builder, 0, "post", [1.0, 0.0, 0.0], vec![], vec![]);
    let mut found = builder.build().expect("valid");
    found.max_dynamic_constraints = 2;
    let model = Arc::new(found);
    let mut sim: Sim = Sim::new(model).expect("valid");
    let first = sim.add_weld(1, 2).expect("there is room");
    let start = sim.state.clone();
    let second = sim.add_connect(0, 3, Vec3::ZERO).expect("there is room");
    assert_eq!(sim.add_weld(2, 3), Err(SimError::NoFreeSlot { max: 2 }));
    sim.remove(first).expect("it is there");
    assert_eq!(sim.remove(first), Err(SimError::StaleConstraint));
    let third = sim.add_weld(2, 3).expect("there is room");
    assert_eq!(
        sim.remove(first),
        Err(SimError::StaleConstraint),
        "its slot has another"
    );
    assert_eq!(Vec::from_iter(sim.dynamic_constraints()), [third, second]);
    assert_eq!(DynamicConstraint::from_code(third.to_code()), third);
    sim.reset();
    assert_eq!(
        sim.remove(third),
        Err(SimError::StaleConstraint),
        "a reset removes it"
    );
    assert_ne!(sim.add_weld(1, 2), Ok(first), "numbers are not used again");
    sim.state.copy_from(&start);
    sim.remove(first).expect("the state has it");
    for (bodies, message) in [
        ([1, 1], "they are the same body"),
        ([0, 4], "both are static"),
        ([1, 9], "there is no body 9: there are 5"),
    ] {
        let error = sim.add_weld(bodies[0], bodies[1]).expect_err("impossible");
        assert!(error.to_string().contains(message), "{error}");
    }
    assert!(
        sim.add_connect(1, 2, Vec3::from_f64([f64::NAN, 0.0, 0.0]))
            .is_err()
    );
    assert!(sim.weld_here(0).is_err());
}

#[test]
fn a_slot_that_names_no_bodies_ties_nothing() {
    let model = model(&boxes());
    let (mut free, mut odd) = (thrown(&model), thrown(&model));
    odd.state.dynamic_kind.fill(2.0);
    odd.state.dynamic_body1.fill(99.0);
    odd.state.dynamic_body2.fill(-1.0);
    odd.state.dynamic_kind[1] = 7.5;
    for _ in 0..50 {
        free.step().expect("finite");
        odd.step().expect("finite");
    }
    assert_same_motion(&free, &odd);
}

#[test]
fn a_saved_state_contains_dynamic_constraints() {
    let model = model(&boxes());
    let mut sim = thrown(&model);
    sim.add_weld(1, 3).expect("there is room");
    sim.add_connect(2, 1, Vec3::from_f64([0.1, 0.0, 0.0]))
        .expect("there is room");
    let saved = sim.state.clone();
    (0..100).for_each(|_| sim.step().expect("finite"));
    let mut other: Sim = Sim::new(model).expect("valid");
    other.state.copy_from(&saved);
    (0..100).for_each(|_| other.step().expect("finite"));
    assert_eq!(sim.state, other.state);
}

/// The operations that add and remove constraints.
trait Grip<S: Precision> {
    fn weld(&mut self, bodies: [usize; 2]) -> DynamicConstraint;
    fn connect(&mut self, bodies: [usize; 2]) -> DynamicConstraint;
    fn let_go(&mut self, held: DynamicConstraint);
}

impl<S: Precision> Grip<S> for Sim<S> {
    fn weld(&mut self, [one, other]: [usize; 2]) -> DynamicConstraint {
        self.add_weld(one, other).expect("there is room")
    }
    fn connect(&mut self, [one, other]: [usize; 2]) -> DynamicConstraint {
        let anchor = Vec3::from_f64([0.05, 0.0, 0.0]);
        self.add_connect(one, other, anchor).expect("there is room")
    }
    fn let_go(&mut self, held: DynamicConstraint) {
        self.remove(held).expect("it is there");
    }
}

/// A row of a batch.
struct Row<'a, S: Precision>(&'a mut Batch<S>, usize);

impl<S: Precision> Grip<S> for Row<'_, S> {
    fn weld(&mut self, [one, other]: [usize; 2]) -> DynamicConstraint {
        self.0
            .add_weld(&[self.1], one, other)
            .expect("there is room")[0]
    }
    fn connect(&mut self, [one, other]: [usize; 2]) -> DynamicConstraint {
        let anchor = Vec3::from_f64([0.05, 0.0, 0.0]);
        let added = self.0.add_connect(&[self.1], one, other, anchor);
        added.expect("there is room")[0]
    }
    fn let_go(&mut self, held: DynamicConstraint) {
        self.0.remove(&[self.1], &[held]).expect("it is there");
    }
}

/// Adds and removes constraints; bodies, slots and times differ between environments.
fn act<S: Precision>(
    env: usize,
    step: usize,
    held: &mut Vec<DynamicConstraint>,
    to: &mut impl Grip<S>,
) {
    let pair = [1 + env % 3, 1 + (env + 1) % 3];
    match step {
        10 if env % 4 != 3 => held.push(to.weld(pair)),
        20 if env.is_multiple_of(2) => held.push(to.connect([0, 1 + env % 3])),
        40 if env.is_multiple_of(4) => to.let_go(held.remove(0)),
        50 => held.push(to.weld([1 + (env + 2) % 3, 0])),
        _ => {}
    }
}

fn lanes_equal_one_alone<S: Precision>() {
    const ENVS: usize = 19;
    let model = model(&boxes());
    let ends = Vec::from_iter((0..ENVS).map(|env| {
        let mut sim = alone::<S>(&model, RigidOptions::new(), env);
        let mut held = Vec::new();
        for step in 0..90 {
            act(env, step, &mut held, &mut sim);
            sim.step().expect("finite");
        }
        sim.state
    }));
    let envs = Vec::from_iter(0..ENVS);
    for (i, instructions) in Instructions::all_available::<S>().enumerate() {
        let how = with(instructions, 1 + i % 3, RigidOptions::new());
        let mut batch = batch::<S>(&model, &envs, how);
        let mut held = vec![Vec::new(); ENVS];
        for step in 0..90 {
            for (env, held) in held.iter_mut().enumerate() {
                act(env, step, held, &mut Row(&mut batch, env));
            }
            batch.step().expect("valid");
        }
        for (env, end) in ends.iter().enumerate() {
            assert_state(&batch, env, end, &|| format!("{instructions:?}"));
            let mut found = State::new(&model);
            batch.state.read(env, &mut found).expect("it is there");
            assert_eq!(found, *end, "{instructions:?}, row {env}");
        }
    }
}

#[test]
fn lanes_that_constrain_different_bodies_equal_a_single_one() {
    lanes_equal_one_alone::<f64>();
}

#[test]
fn lanes_that_constrain_different_bodies_equal_a_single_one_in_single_precision() {
    lanes_equal_one_alone::<f32>();
}

#[test]
fn more_slots_than_memory_are_an_error() {
    let mut found = boxes().build().expect("valid");
    found.max_dynamic_constraints = usize::MAX / 1000;
    let model = Arc::new(found);
    for error in [
        Sim::<f64>::new(model.clone()).err(),
        Batch::<f64>::new(model, 2).err(),
    ] {
        assert!(
            matches!(error, Some(SimError::OutOfMemory { .. })),
            "{error:?}"
        );
    }
}

#[test]
fn if_one_environment_fails_all_stay_unchanged() {
    let mut found = boxes().build().expect("valid");
    found.max_dynamic_constraints = 1;
    let mut batch: Batch = Batch::new(Arc::new(found), 3).expect("valid");
    let held = batch.add_weld(&[1], 1, 2).expect("there is room");
    assert_eq!(
        batch.add_weld(&[0, 2, 1], 2, 3),
        Err(SimError::NoFreeSlot { max: 1 })
    );
    assert_eq!(batch.state.dynamic_kind.as_slice(), [0, 2, 0]);
    let all = [held[0], held[0]];
    assert_eq!(batch.remove(&[1, 0], &all), Err(SimError::StaleConstraint));
    assert_eq!(batch.state.dynamic_kind.as_slice(), [0, 2, 0]);
    let saved = batch.save().expect("memory");
    batch.remove(&[1], &held).expect("it is there");
    batch.restore(&saved).expect("the same batch");
    batch.remove(&[1], &held).expect("it is there again");
    batch.reset(1).expect("it is there");
    assert_eq!(batch.remove(&[1], &held), Err(SimError::StaleConstraint));
}

#[test]
fn constrained_bodies_sleep_and_wake_together() {
    let mut builder = boxes();
    builder.physics.flags.sleep = true;
    let model = model(&builder);
    let mut sim: Sim = Sim::new(model).expect("valid");
    let asleep = |sim: &Sim| Vec::from_iter(sim.state.tree_asleep.iter().map(|&t| t >= 0.0));
    (0..4000).for_each(|_| sim.step().expect("finite"));
    assert_eq!(asleep(&sim), [true; 3]);
    let held = sim.add_weld(1, 3).expect("there is room");
    assert_eq!(asleep(&sim), [false, true, false]);
    (0..2000).for_each(|_| sim.step().expect("finite"));
    assert_eq!(asleep(&sim), [true; 3]);
    assert_eq!(sim.state.tree_asleep[0], 2.0, "they are one island");
    sim.state.qvel[0] = 0.1;
    sim.step().expect("finite");
    assert_eq!(asleep(&sim), [false, true, false]);
    (0..2000).for_each(|_| sim.step().expect("finite"));
    sim.remove(held).expect("it is there");
    assert_eq!(asleep(&sim), [false, true, false]);
}
