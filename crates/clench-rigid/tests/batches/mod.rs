//! What the tests of batches share: scenes in which environments go their own ways, and comparison to the bit.
#![allow(dead_code)] // Each test file uses some of these.

#[path = "../scenes/mod.rs"]
mod scenes;

use clench_math::Instructions;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::{Batch, BatchOptions, Model, Precision, Sim, State};
use clench_solver::RigidOptions;
pub use scenes::*;
use std::sync::Arc;

/// The humanoid, solved as a user would.
pub fn walker() -> ModelBuilder {
    let mut b = humanoid();
    b.options = RigidOptions::new();
    b
}

/// How environment `env` begins: thrown in a direction of its own; every fifth has its equalities the other way.
pub fn begin<S: Precision>(env: usize, state: &mut State<S>) {
    let mut numbers = Numbers(env as u64 + 1);
    for v in &mut state.qvel {
        *v = S::new(1.5 * numbers.next());
    }
    for on in &mut state.eq_active {
        *on ^= env % 5 == 4;
    }
}

/// The control `i` of environment `env` in a step.
pub fn control<S: Precision>(env: usize, step: usize, i: usize) -> S {
    let phase = 0.05 * step as f64 + 1.3 * i as f64 + 0.7 * env as f64;
    S::new(phase.sin())
}

/// A simulation of environment `env` at its beginning.
pub fn alone<S: Precision>(model: &Arc<Model>, options: RigidOptions, env: usize) -> Sim<S> {
    let mut sim = Sim::with_options(model.clone(), options).expect("valid");
    begin(env, &mut sim.state);
    sim
}

/// Sets the controls of a step.
pub fn drive_alone<S: Precision>(sim: &mut Sim<S>, env: usize, step: usize) {
    for (i, ctrl) in sim.state.ctrl.iter_mut().enumerate() {
        *ctrl = control(env, step, i);
    }
}

/// A batch whose row k is environment `envs[k]` at its beginning.
pub fn batch<S: Precision>(model: &Arc<Model>, envs: &[usize], options: BatchOptions) -> Batch<S> {
    let mut batch = Batch::with_options(model.clone(), envs.len(), options).expect("valid");
    let mut state = State::new(model);
    for (row, &env) in envs.iter().enumerate() {
        begin(env, &mut state);
        batch.state.qvel.row_mut(row).copy_from_slice(&state.qvel);
        let switches = batch.state.eq_active.row_mut(row).iter_mut();
        for (to, &on) in switches.zip(&state.eq_active) {
            *to = u8::from(on);
        }
        state = State::new(model);
    }
    batch
}

/// Sets the controls of a step, where row k is environment `envs[k]`.
pub fn drive<S: Precision>(batch: &mut Batch<S>, envs: &[usize], step: usize) {
    for (row, &env) in envs.iter().enumerate() {
        for (i, ctrl) in batch.state.ctrl.row_mut(row).iter_mut().enumerate() {
            *ctrl = control(env, step, i);
        }
    }
}

pub fn with(instructions: Instructions, threads: usize, options: RigidOptions) -> BatchOptions {
    BatchOptions {
        options,
        instructions: Some(instructions),
        threads: Some(threads),
        grouping: threads != 2,
    }
}

/// Asserts that numbers are equal to the bit.
pub fn assert_bits<S: Precision>(found: &[S], expected: &[S], what: &dyn Fn() -> String) {
    let bits = |x: S| x.to_f64().to_bits();
    let same = found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(&a, &b)| bits(a) == bits(b));
    assert!(
        same,
        "{}: {found:?} where {expected:?} was expected",
        what()
    );
}

/// Asserts that a row of a batch holds this state, to the bit.
pub fn assert_state<S: Precision>(
    batch: &Batch<S>,
    row: usize,
    expected: &State<S>,
    what: &dyn Fn() -> String,
) {
    let rows = &batch.state;
    for (field, found, expected) in [
        ("qpos", &rows.qpos, &expected.qpos),
        ("qvel", &rows.qvel, &expected.qvel),
        ("act", &rows.act, &expected.act),
        ("ctrl", &rows.ctrl, &expected.ctrl),
        ("qfrc_applied", &rows.qfrc_applied, &expected.qfrc_applied),
        (
            "qacc_warmstart",
            &rows.qacc_warmstart,
            &expected.qacc_warmstart,
        ),
    ] {
        let what = || format!("{}, row {row}: {field}", what());
        assert_bits(found.row(row), expected, &what);
    }
    assert_bits(rows.time.row(row), &[expected.time], what);
    let switches = rows.eq_active.row(row).iter().map(|&on| on != 0);
    assert!(
        switches.eq(expected.eq_active.iter().copied()),
        "{}, row {row}: eq_active",
        what()
    );
}
