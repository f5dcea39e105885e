//! A ledger of environments: which run, which failed and why, and that none is lost.

use clench::math::Scalar;

use clench::rigid::batch::{Rows, StateRows, Summary};
use clench::rigid::{Batch, EnvStatus, Fault, Precision};
use std::fmt::{self, Display, Formatter};

/// Returns the tables that a step may change.
pub fn motion<S: Precision>(state: &StateRows<S>) -> [&Rows<S>; 4] {
    let StateRows {
        qpos,
        qvel,
        act,
        qacc_warmstart,
        ..
    } = state;
    [qpos, qvel, act, qacc_warmstart]
}

/// Returns true if the bits are equal, NaN included.
pub fn same<S: Scalar>(a: &[S], b: &[S]) -> bool {
    let bits = |x: &S| x.to_f64().to_bits();
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| bits(a) == bits(b))
}

/// The expectation for an environment in the next step.
#[derive(Clone, Copy, Default)]
pub struct Expectation {
    /// True if it was just reset and not changed since.
    pub runs: bool,
    /// The field of its state that holds an invalid number.
    pub not_finite: Option<&'static str>,
}

pub struct Ledger<S> {
    expected: Vec<Expectation>,
    running: Vec<bool>,
    times: Vec<f64>,
    before: [Vec<S>; 4],
    pub resets: usize,
    pub poisoned: usize,
    not_finite: usize,
    diverged: usize,
    singular: usize,
    overflows: usize,
}

impl<S: Precision> Ledger<S> {
    pub fn new(batch: &Batch<S>) -> Self {
        Ledger {
            expected: vec![Expectation::default(); batch.count()],
            running: vec![true; batch.count()],
            times: batch.state.time.as_slice().to_vec(),
            before: motion(&batch.state).map(|rows| rows.as_slice().to_vec()),
            resets: 0,
            poisoned: 0,
            not_finite: 0,
            diverged: 0,
            singular: 0,
            overflows: 0,
        }
    }

    /// Returns the expectation for environment `env`, to be set.
    pub fn expect(&mut self, env: usize) -> &mut Expectation {
        &mut self.expected[env]
    }

    pub fn before_step(&mut self, batch: &Batch<S>) {
        for (copy, rows) in self.before.iter_mut().zip(motion(&batch.state)) {
            copy.copy_from_slice(rows.as_slice());
        }
        (self.times).copy_from_slice(batch.state.time.as_slice());
        for (running, status) in self.running.iter_mut().zip(batch.statuses()) {
            *running = *status == EnvStatus::Running;
        }
    }

    pub fn after_step(&mut self, batch: &Batch<S>, summary: Summary) {
        let (mut failed, mut running) = (0, 0);
        for env in 0..batch.count() {
            let expected = std::mem::take(&mut self.expected[env]);
            match (self.running[env], batch.status(env)) {
                (true, EnvStatus::Running) => {
                    running += 1;
                    assert!(
                        expected.not_finite.is_none(),
                        "environment {env} ran on poison"
                    );
                    self.check_advanced(batch, env);
                }
                (true, EnvStatus::Failed(fault)) => {
                    failed += 1;
                    assert!(
                        !expected.runs,
                        "environment {env} did not come back: {fault}"
                    );
                    self.note(env, expected, fault);
                    self.check_kept(batch, env);
                }
                (false, EnvStatus::Failed(_)) => self.check_kept(batch, env),
                (false, EnvStatus::Running) => panic!("environment {env} came back by itself"),
            }
        }
        assert_eq!((summary.failed, summary.running), (failed, running));
    }

    fn check_advanced(&self, batch: &Batch<S>, env: usize) {
        let timestep = S::new(batch.model().params.timestep).to_f64();
        let time = batch.state.time.row(env)[0];
        assert!(
            time == self.times[env] + timestep,
            "time of environment {env}"
        );
        for rows in motion(&batch.state) {
            let finite = rows.row(env).iter().all(|x| x.to_f64().is_finite());
            assert!(finite, "environment {env} runs and is not finite");
        }
    }

    /// Checks that a failed environment keeps its last good state.
    fn check_kept(&self, batch: &Batch<S>, env: usize) {
        let time = batch.state.time.row(env);
        assert!(
            same(time, &self.times[env..=env]),
            "time of environment {env}"
        );
        for (rows, before) in motion(&batch.state).into_iter().zip(&self.before) {
            let before = &before[env * rows.width()..][..rows.width()];
            assert!(same(rows.row(env), before), "environment {env} moved");
        }
    }

    fn note(&mut self, env: usize, expected: Expectation, fault: Fault) {
        if let Some(poisoned) = expected.not_finite {
            let named = matches!(fault, Fault::NotFinite { field, .. } if field == poisoned);
            assert!(
                named,
                "environment {env} was poisoned in {poisoned}: {fault}"
            );
        }
        match fault {
            Fault::NotFinite { .. } => self.not_finite += 1,
            Fault::Diverged { .. } => self.diverged += 1,
            Fault::Singular { .. } => self.singular += 1,
            Fault::ContactOverflow { .. } => self.overflows += 1,
            Fault::OverBudget { .. } | Fault::Unfinished { .. } => {
                panic!("environment {env}: {fault}")
            }
        }
    }

    /// Checks that every kind of event happened.
    pub fn check_everything_happened(&self) {
        let counts = [self.resets, self.poisoned, self.not_finite, self.diverged];
        assert!(
            counts.iter().all(|&n| n > 0) && self.overflows > 0,
            "{self}"
        );
    }
}

impl<S> Display for Ledger<S> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(
            f,
            "{} times poisoned, {} times reset; failed: {} not finite, {} diverged, {} singular, {} with too many contacts",
            self.poisoned,
            self.resets,
            self.not_finite,
            self.diverged,
            self.singular,
            self.overflows
        )
    }
}
