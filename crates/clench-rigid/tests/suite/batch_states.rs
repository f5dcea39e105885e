//! States of environments: save, restore, reset, read and write rows; invalid input is refused.

use crate::batches::*;
use clench_math::{Instructions, Quat, Vec3};
use clench_rigid::batch::{Controls, StateRows};
use clench_rigid::model::JointKind;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions, EnvStatus, SimError, State};

const ENVS: usize = 13;

fn moving() -> Batch<f64> {
    let envs: Vec<usize> = (0..ENVS).collect();
    let options = with(Instructions::widest(), 2, RigidOptions::new());
    let mut batch = batch::<f64>(&model(&loose_parts()), &envs, options);
    batch.step_n(40).expect("valid");
    batch
}

fn states(batch: &Batch<f64>) -> Vec<State<f64>> {
    (0..batch.count())
        .map(|env| batch.sim(env).expect("it exists").state)
        .collect()
}

#[test]
fn what_is_restored_moves_on_as_it_would_have() {
    let mut batch = moving();
    // Fill every table.
    for (i, x) in batch
        .state
        .xfrc_applied
        .as_mut_slice()
        .iter_mut()
        .enumerate()
    {
        *x = 0.1 * (i as f64).sin();
    }
    batch.state.qfrc_applied.as_mut_slice().fill(0.2);
    batch.state.qpos.row_mut(5)[0] = f64::NAN;
    batch.step().expect("valid");
    assert!(matches!(batch.status(5), EnvStatus::Failed(_)));
    let saved = batch.save().expect("valid");
    batch.step_n(60).expect("valid");
    let first = states(&batch);
    batch.state.xfrc_applied.as_mut_slice().fill(0.0);
    batch.state.eq_active.as_mut_slice().fill(1);
    batch.reset(5).expect("it exists");
    batch.step_n(10).expect("valid");
    batch.restore(&saved).expect("its own");
    assert!(
        matches!(batch.status(5), EnvStatus::Failed(_)),
        "as it was saved"
    );
    batch.step_n(60).expect("valid");
    for (env, state) in first.iter().enumerate() {
        assert_state_but(&batch, env, state, env == 5);
    }
}

/// Calls `assert_state` unless the row holds a NaN.
fn assert_state_but(batch: &Batch<f64>, env: usize, state: &State<f64>, skip: bool) {
    if !skip {
        assert_state(batch, env, state, &|| "again".into());
    }
}

#[test]
fn a_state_can_be_given_to_others() {
    let mut batch = moving();
    let saved = batch.save_envs(&[3, 7]).expect("they exist");
    assert_eq!(saved.envs(), [3, 7]);
    assert_eq!(saved.state().qpos.row(1), batch.state.qpos.row(7));
    batch.restore_to(&saved, &[0, 12]).expect("they exist");
    batch.step_n(30).expect("valid");
    let after = states(&batch);
    assert_state(&batch, 0, &after[3], &|| "a copy of 3".into());
    assert_state(&batch, 12, &after[7], &|| "a copy of 7".into());
    for (snapshot, envs) in [(&saved, &[0][..]), (&saved, &[0, 1, 2]), (&saved, &[0, 13])] {
        assert!(batch.restore_to(snapshot, envs).is_err());
    }
    assert!(batch.save_envs(&[13]).is_err());
    let other = Batch::<f64>::new(model(&walker()), ENVS).expect("valid");
    let foreign = other.save().expect("valid");
    assert!(batch.restore(&foreign).is_err(), "of another model");
    for (env, state) in after.iter().enumerate() {
        assert_state(&batch, env, state, &|| "nothing changed".into());
    }
}

#[test]
fn environments_are_reset_individually() {
    let mut batch = moving();
    let before = states(&batch);
    let model = batch.model().clone();
    let initial = State::<f64>::new(&model);
    let mut keyed = initial.clone();
    keyed.set_keyframe(&model, &model.keyframes[0]);
    batch.state.ctrl.as_mut_slice().fill(1.0);
    batch.state.qpos.row_mut(2)[3] = f64::INFINITY;
    batch.step().expect("valid");
    let after = states(&batch);
    batch.reset(2).expect("it exists");
    batch.reset_to_keyframe(4, 0).expect("they exist");
    let mut mask = [false; ENVS];
    (mask[0], mask[11]) = (true, true);
    batch.reset_mask(&mask).expect("as long");
    for env in 0..ENVS {
        assert_eq!(batch.status(env), EnvStatus::Running);
        let expected = match env {
            0 | 2 | 11 => &initial,
            4 => &keyed,
            _ => &after[env],
        };
        assert_state(&batch, env, expected, &|| "after resets".into());
        assert_ne!(before[env].time, expected.time);
    }
    assert_eq!((keyed.time, keyed.qvel[2]), (2.0, 3.0));
    for error in [
        batch.reset(ENVS),
        batch.revive(ENVS),
        batch.reset_to_keyframe(ENVS, 0),
        batch.reset_to_keyframe(0, 1),
        batch.reset_mask(&[true; ENVS - 1]),
        batch.sim(ENVS).map(drop),
    ] {
        assert!(error.is_err());
    }
}

#[test]
fn a_simulation_of_an_environment_is_independent() {
    let mut batch = moving();
    let mut sims: Vec<_> = (0..ENVS)
        .map(|env| batch.sim(env).expect("it exists"))
        .collect();
    batch.step_n(25).expect("valid");
    for (env, sim) in sims.iter_mut().enumerate() {
        for _ in 0..25 {
            sim.step().expect("finite");
        }
        assert_state(&batch, env, &sim.state, &|| "alone".into());
    }
}

#[test]
fn rows_do_not_move_in_memory() {
    let mut batch = moving();
    let places = |batch: &Batch<f64>| {
        let rows = &batch.state;
        [&rows.qpos, &rows.qvel, &rows.ctrl, &rows.time].map(|rows| rows.as_slice().as_ptr())
    };
    let before = places(&batch);
    let aligned = |p: &*const f64| (*p as usize).is_multiple_of(64);
    assert!(before.iter().all(aligned));
    batch.step_n(3).expect("valid");
    batch.reset_mask(&[true; ENVS]).expect("as long");
    batch.record(&["xpos"]).expect("known");
    let saved = batch.save().expect("valid");
    batch.restore(&saved).expect("its own");
    assert_eq!(places(&batch), before);
    assert_eq!(batch.state.qpos.as_ptr(), before[0]);
    assert_eq!(batch.state.qpos.as_mut_ptr().cast_const(), before[0]);
    assert_eq!(batch.state.qpos.iter().count(), ENVS);
    assert_eq!(
        batch.state.qpos.iter().nth(3),
        Some(batch.state.qpos.row(3))
    );
}

#[test]
fn states_go_into_rows_and_out_of_them() {
    let model = model(&everything());
    let mut rows = StateRows::<f64>::new(&model, 3).expect("few");
    assert_eq!(rows.count(), 3);
    let mut state = State::new(&model);
    begin(4, &mut state);
    state.time = 0.5;
    state.xfrc_applied[1].angular.y = 2.0;
    rows.write(1, &state).expect("of the model");
    let mut found = State::new(&model);
    rows.read(1, &mut found).expect("of the model");
    assert_eq!(found, state);
    rows.read(2, &mut found).expect("of the model");
    let sum = |state: &State<f64>| state.qpos.iter().map(|x| x.abs()).sum::<f64>();
    assert_eq!((found.time, sum(&found)), (0.0, 0.0), "new rows are zero");
    let gone = rows.write(3, &state).expect_err("there are three");
    assert_eq!(gone.to_string(), "there is no environment 3: there are 3");
    state.qpos.pop();
    for error in [rows.read(1, &mut state), rows.write(1, &state)] {
        let error = error.expect_err("too short");
        assert!(matches!(error, SimError::WrongLength { field: "qpos", .. }));
    }
}

#[test]
fn foreign_tables_are_refused() {
    let (mut batch, mut larger) = (
        moving(),
        Batch::<f64>::new(model(&walker()), 40).expect("valid"),
    );
    std::mem::swap(&mut batch.state.qvel, &mut larger.state.qvel);
    for result in [batch.step(), batch.forward(), larger.step_n(3)] {
        let error = result.expect_err("not its own");
        assert!(
            matches!(error, SimError::WrongLength { field: "qvel", .. }),
            "{error}"
        );
    }
    let refused = [
        batch.reset(0),
        batch.reset_to_keyframe(0, 0),
        batch.reset_mask(&[true; ENVS]),
        batch.sim(0).map(drop),
        batch.save().map(drop),
        (batch.rollout_from(&[], 1, Controls::Held, &[])).map(drop),
    ];
    for result in refused {
        assert!(matches!(result, Err(SimError::WrongLength { .. })));
    }
    std::mem::swap(&mut batch.state.qvel, &mut larger.state.qvel);
    batch.step().expect("all is well again");
}

/// Rows of another width are refused even if the total length is equal.
#[test]
fn tables_of_another_width_are_refused() {
    let mut b = world();
    for name in ["one", "two"] {
        let slide = joint(JointKind::Slide, name, [1.0, 0.0, 0.0]);
        add(&mut b, 0, name, [0.0; 3], vec![slide], vec![sphere(0.1)]);
    }
    let two = model(&b);
    b.bodies.pop();
    let one = model(&b);
    let mut wide = Batch::<f64>::new(two, 2).expect("valid");
    let mut narrow = Batch::<f64>::new(one, 4).expect("valid");
    std::mem::swap(&mut wide.state.qpos, &mut narrow.state.qpos);
    for error in [wide.step(), narrow.step()].map(|r| r.expect_err("not its own")) {
        assert!(matches!(error, SimError::WrongLength { field: "qpos", .. }));
    }
}

#[test]
fn options_that_cannot_be_are_errors() {
    let model = model(&walker());
    let make = |count: usize, edit: fn(&mut BatchOptions)| {
        let mut options = BatchOptions::default();
        edit(&mut options);
        Batch::<f64>::with_options(model.clone(), count, options).map(drop)
    };
    assert!(make(3, |_| {}).is_ok());
    let bad = make(3, |o| o.threads = Some(0)).expect_err("no threads");
    assert_eq!(bad.to_string(), "threads is 0, but must be at least 1");
    assert!(make(3, |o| o.options = RigidOptions::new().tolerance(-1.0)).is_err());
    for count in [usize::MAX, 1 << 32] {
        let error = make(count, |_| {}).expect_err("too many");
        assert!(
            error.to_string().starts_with("number of environments is"),
            "{error}"
        );
    }
    let crowd = BatchOptions {
        threads: Some(usize::MAX),
        ..BatchOptions::default()
    };
    let crowd = Batch::<f64>::with_options(model.clone(), 3, crowd).expect("valid");
    assert_eq!(crowd.threads(), 3, "one an environment at most");
    let mut batch = Batch::<f64>::new(model.clone(), 3).expect("valid");
    let error = batch.rollout(usize::MAX / 64, Controls::Held, &["xpos"]);
    let error = error.expect_err("too long");
    assert!(matches!(error, SimError::OutOfMemory { .. }), "{error}");
    let missing = [Instructions::Neon, Instructions::Avx2, Instructions::Avx512];
    for instructions in missing.into_iter().filter(|i| !i.available()) {
        let options = with(instructions, 1, RigidOptions::new());
        let error = Batch::<f64>::with_options(model.clone(), 3, options).map(drop);
        assert_eq!(error, Err(SimError::Instructions(instructions)));
    }
}

#[test]
fn no_environment_and_no_dof_are_fine() {
    let mut none = Batch::<f64>::new(model(&walker()), 0).expect("valid");
    let summary = none.step_n(3).expect("valid");
    assert_eq!((summary.failed, summary.running), (0, 0));
    let mut still = Batch::<f64>::new(model(&world()), 3).expect("valid");
    still.record(&["xpos", "qacc", "energy"]).expect("known");
    still.step_n(2).expect("valid");
    assert_eq!(still.state.time.as_slice(), [0.004; 3]);
}

#[test]
fn states_are_equal_bit_by_bit() {
    let model = model(&everything());
    let state = State::<f64>::new(&model);
    assert_eq!(state, state.clone());
    let changes: [fn(&mut State<f64>); 12] = [
        |s| s.time = -0.0,
        |s| s.qpos[0] = f64::NAN,
        |s| s.qvel[0] = -0.0,
        |s| s.act.push(0.0),
        |s| s.history.push(0.0),
        |s| s.ctrl.push(0.0),
        |s| s.qfrc_applied[0] = 1.0,
        |s| s.xfrc_applied[1].angular.z = 1.0,
        |s| s.mocap_pos.push(Vec3::ZERO),
        |s| s.mocap_quat.push(Quat::IDENTITY),
        |s| s.eq_active.push(true),
        |s| s.qacc_warmstart[0] = f64::MIN_POSITIVE,
    ];
    for (i, change) in changes.iter().enumerate() {
        let mut other = state.clone();
        change(&mut other);
        assert_ne!(state, other, "change {i}");
        assert_eq!(other, other.clone(), "change {i}");
    }
}

#[test]
#[should_panic(expected = "there is no environment 13")]
fn an_environment_that_does_not_exist_has_no_geoms() {
    moving().own_geom(ENVS, 0);
}
