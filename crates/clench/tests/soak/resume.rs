//! A run that is saved every hundred steps. A new batch with other threads, grouping and lanes resumes it and must end
//! in the same states as the original, to the bit, failures included.

use crate::dice::Dice;
use crate::ledger::{motion, same};
use crate::poison::poison;
use crate::{Plan, batch_with, control, seed};
use clench::math::Instructions;
use clench::rigid::{EnvStatus, Precision};
use clench::{Batch, BatchOptions};

/// The number of steps between two saves.
const LEG: usize = 100;
/// A step resets one environment in `RESETS`, and poisons one in `POISONS`.
const RESETS: u64 = 500;
const POISONS: u64 = 2000;

pub fn resume<S: Precision>(plan: &Plan) {
    let mut left = batch_with::<S>(plan, BatchOptions::default());
    let mut failures = 0;
    for leg in 0..plan.steps / LEG {
        let saved = left.save().expect("rows of the right shapes");
        let mut resumed = batch_with::<S>(plan, otherwise::<S>(leg));
        resumed.restore(&saved).expect("a snapshot of such a batch");
        run(&mut left, leg);
        run(&mut resumed, leg);
        let times = [&left, &resumed].map(|batch| batch.state.time.as_slice());
        assert!(same(times[0], times[1]), "leg {leg}: other times");
        for (a, b) in motion(&left.state).into_iter().zip(motion(&resumed.state)) {
            for env in 0..plan.envs {
                assert!(
                    same(a.row(env), b.row(env)),
                    "leg {leg}: environment {env} arrived elsewhere"
                );
            }
        }
        let statuses = |batch: &Batch<S>| format!("{:?}", batch.statuses());
        assert_eq!(statuses(&left), statuses(&resumed), "leg {leg}");
        failures += (left.statuses().iter())
            .filter(|status| **status != EnvStatus::Running)
            .count();
    }
    assert!(
        failures > 0,
        "nothing failed: the soak has shown too little"
    );
    println!(
        "{}, {} bit: {} environments resumed {} times after {LEG} steps each, to the bit; {failures} were failed at the end of a leg",
        plan.model,
        8 * size_of::<S>(),
        plan.envs,
        plan.steps / LEG
    );
}

/// Returns options that may change only the speed.
fn otherwise<S: Precision>(leg: usize) -> BatchOptions {
    let available: Vec<Instructions> = Instructions::all_available::<S>().collect();
    BatchOptions {
        threads: Some(1 + leg % 3),
        instructions: Some(available[leg % available.len()]),
        grouping: leg.is_multiple_of(2),
        ..BatchOptions::default()
    }
}

/// Runs a leg: batches in equal states get equal controls, resets and poison.
fn run<S: Precision>(batch: &mut Batch<S>, leg: usize) {
    let mut dice = Dice::new(seed().wrapping_mul(1_000_003).wrapping_add(leg as u64));
    for _ in 0..LEG {
        control(batch, &mut dice);
        for env in 0..batch.count() {
            if dice.one_in(RESETS) {
                batch.reset(env).expect("an environment that is there");
            }
            if dice.one_in(POISONS) {
                poison(&mut batch.state, env, &mut dice);
            }
        }
        batch.step().expect("rows of the right shapes");
    }
}
