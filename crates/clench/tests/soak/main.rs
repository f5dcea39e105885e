//! Runs many environments for long, with random controls, resets and poison. None is lost, none affects another,
//! nothing leaks, and a saved and resumed run ends in the same states.
//!
//! The short forms are ordinary tests; `cargo xtask soak` runs the long ones. `SOAK_SEED` chooses other random numbers,
//! `SOAK_SCALE=10` runs a tenth of the steps.

mod dice;
mod ledger;
mod poison;
mod resume;
mod watch;

use cap::Cap;
use clench::rigid::options::MaxContacts;
use clench::rigid::{EnvStatus, Precision};
use clench::{Batch, BatchOptions, RigidOptions};
use dice::Dice;
use ledger::{Expectation, Ledger};
use poison::poison;
use std::alloc::System;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use watch::Watch;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Serializes the tests, because the memory of the whole program is counted.
static TURN: Mutex<()> = Mutex::new(());

/// Waits for the turn of a test, which ends when the guard is dropped.
fn turn() -> MutexGuard<'static, ()> {
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The parameters of a soak.
struct Plan {
    model: &'static str,
    /// A limit that some poses exceed.
    max_contacts: usize,
    envs: usize,
    steps: usize,
    /// The number of environments that are also stepped singly, without poison.
    watched: usize,
}

/// A step resets one environment in `RESETS`, one failed in `COMEBACKS`, and poisons one in `POISONS`.
const RESETS: u64 = 1000;
const COMEBACKS: u64 = 20;
const POISONS: u64 = 400;

/// The bytes by which the batch may grow after a quarter of the steps: buffers still grow for groups with more
/// contacts. A byte per step and environment would be seven times as much in the long form.
const GROWTH: isize = 1 << 20;

/// Soaks a humanoid in double and a quadruped in single precision.
fn soak_both(envs: usize, steps: usize) {
    let _turn = turn();
    let size = |model, max_contacts| Plan {
        model,
        max_contacts,
        envs,
        steps,
        watched: 200,
    };
    soak::<f64>(&size("humanoid", 8));
    soak::<f32>(&size("quadruped", 5));
}

fn resume_both(envs: usize, steps: usize) {
    let _turn = turn();
    let size = |model, max_contacts| Plan {
        model,
        max_contacts,
        envs,
        steps,
        watched: 0,
    };
    resume::resume::<f64>(&size("humanoid", 8));
    resume::resume::<f32>(&size("quadruped", 5));
}

#[test]
fn short() {
    soak_both(200, 400);
}

#[test]
fn a_resumed_run_arrives_where_the_run_it_left_arrives() {
    resume_both(60, 300);
}

#[test]
#[ignore = "takes minutes: cargo xtask soak --only batch"]
fn long() {
    soak_both(10_000, 1_000 / scale());
}

#[test]
#[ignore = "takes an hour: cargo xtask soak --only endurance"]
fn endurance() {
    soak_both(10_000, 10_000 / scale());
}

#[test]
#[ignore = "takes minutes: cargo xtask soak --only resume"]
fn resume_long() {
    resume_both(1_000, 10_000 / scale());
}

/// Returns the divisor of the steps of a long form.
fn scale() -> usize {
    let text = std::env::var("SOAK_SCALE").unwrap_or("1".into());
    text.parse().expect("SOAK_SCALE is a whole number")
}

fn seed() -> u64 {
    let text = std::env::var("SOAK_SEED").unwrap_or("1".into());
    text.parse().expect("SOAK_SEED is a whole number")
}

fn soak<S: Precision>(plan: &Plan) {
    let mut batch = batch_with::<S>(plan, BatchOptions::default());
    let mut watch = Watch::new(&batch, plan.watched);
    let mut ledger = Ledger::new(&batch);
    let mut dice = Dice::new(seed());
    let begin = Instant::now();
    let (mut grown, mut warm) = (0, 0);
    for step in 0..plan.steps {
        control(&mut batch, &mut dice);
        // A reset frees the record of a failure's location that a step allocates.
        let heap = ALLOCATOR.allocated();
        reset(&mut batch, &mut ledger, &mut watch, &mut dice);
        grown += ALLOCATOR.allocated() as isize - heap as isize;
        watch.copy_controls(&batch);
        give_poison(&mut batch, &mut ledger, &mut watch, &mut dice);
        ledger.before_step(&batch);
        let heap = ALLOCATOR.allocated();
        let summary = batch.step().expect("tables of the right shapes");
        grown += ALLOCATOR.allocated() as isize - heap as isize;
        if step == plan.steps / 4 {
            warm = grown;
        }
        ledger.after_step(&batch, summary);
        watch.step(&batch);
    }
    let seconds = begin.elapsed().as_secs_f64();
    let (model, bits, seed) = (plan.model, 8 * size_of::<S>(), seed());
    let (envs, steps) = (plan.envs, plan.steps);
    let megabytes = [warm, grown].map(|bytes| bytes as f64 / 1e6);
    println!(
        "{model}, {bits} bit: {envs} environments × {steps} steps, seed {seed}: {seconds:.0} s"
    );
    println!("  {ledger}\n  {watch}");
    println!(
        "  the batch has grown by {:.3} MB after a quarter of the steps, {:.3} MB at the end",
        megabytes[0], megabytes[1]
    );
    ledger.check_everything_happened();
    watch.check_everything_happened();
    assert!(grown <= warm + GROWTH, "the batch goes on growing");
    all_come_back(&mut batch);
}

fn batch_with<S: Precision>(plan: &Plan, options: BatchOptions) -> Batch<S> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let file = folder.join(plan.model).with_extension("xml");
    let model = clench::load(file).expect("our own model loads");
    let options = BatchOptions {
        options: RigidOptions {
            max_contacts: Some(MaxContacts::Limit(plan.max_contacts)),
            ..RigidOptions::new()
        },
        ..options
    };
    Batch::with_options(Arc::new(model), plan.envs, options).expect("a batch of our own model")
}

/// Sets new controls for one environment in ten.
fn control<S: Precision>(batch: &mut Batch<S>, dice: &mut Dice) {
    for env in 0..batch.count() {
        if dice.one_in(10) {
            let ctrl = batch.state.ctrl.row_mut(env);
            ctrl.fill_with(|| S::new(dice.unit()));
        }
    }
}

/// Resets some environments, more often failed ones, to the initial state or a keyframe.
fn reset<S: Precision>(
    batch: &mut Batch<S>,
    ledger: &mut Ledger<S>,
    watch: &mut Watch<S>,
    dice: &mut Dice,
) {
    let keyframes = batch.model().keyframes.len();
    for env in 0..batch.count() {
        let running = batch.status(env) == EnvStatus::Running;
        if dice.one_in(if running { RESETS } else { COMEBACKS }) {
            let key = Some(dice.below(keyframes + 1)).filter(|&key| key < keyframes);
            match key {
                Some(key) => batch.reset_to_keyframe(env, key),
                None => batch.reset(env),
            }
            .expect("an environment and a keyframe that are there");
            watch.reset(env, key);
            ledger.expect(env).runs = true;
            ledger.resets += 1;
        }
    }
}

/// Poisons some of the running environments.
fn give_poison<S: Precision>(
    batch: &mut Batch<S>,
    ledger: &mut Ledger<S>,
    watch: &mut Watch<S>,
    dice: &mut Dice,
) {
    for env in 0..batch.count() {
        if batch.status(env) == EnvStatus::Running && dice.one_in(POISONS) {
            let poison = poison(&mut batch.state, env, dice);
            watch.poisoned(env);
            *ledger.expect(env) = Expectation {
                runs: false,
                not_finite: Some(poison.field).filter(|_| !poison.finite),
            };
            ledger.poisoned += 1;
        }
    }
}

/// Checks that every environment runs after a reset.
fn all_come_back<S: Precision>(batch: &mut Batch<S>) {
    for env in 0..batch.count() {
        batch.reset(env).expect("an environment that is there");
    }
    let summary = batch.step().expect("tables of the right shapes");
    assert_eq!((summary.failed, summary.running), (0, batch.count()));
}
