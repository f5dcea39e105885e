//! Some environments are also stepped singly, without poison. Until poisoned, both must be equal to the bit.

use crate::ledger::same;
use clench::rigid::{Batch, EnvStatus, Fault, Precision};
use clench::{Sim, SimError};
use std::fmt::{self, Display, Formatter};

struct SingleEnv<S: Precision> {
    env: usize,
    sim: Sim<S>,
    /// True if neither poisoned nor failed since the last reset.
    healthy: bool,
}

pub struct Watch<S: Precision> {
    alone: Vec<SingleEnv<S>>,
    steps: usize,
    same_failures: usize,
}

impl<S: Precision> Watch<S> {
    /// Watches `count` environments of a batch, all of which are in the initial state.
    pub fn new(batch: &Batch<S>, count: usize) -> Self {
        let envs = (0..count).map(|i| i * batch.count() / count);
        let alone = envs.map(|env| SingleEnv {
            env,
            sim: batch.sim(env).expect("an environment that is there"),
            healthy: true,
        });
        Watch {
            alone: alone.collect(),
            steps: 0,
            same_failures: 0,
        }
    }

    fn find(&mut self, env: usize) -> Option<&mut SingleEnv<S>> {
        self.alone.iter_mut().find(|alone| alone.env == env)
    }

    /// Records that environment `env` was reset, to a keyframe or to the initial state.
    pub fn reset(&mut self, env: usize, keyframe: Option<usize>) {
        if let Some(alone) = self.find(env) {
            alone.healthy = true;
            match keyframe {
                Some(key) => alone.sim.reset_to_keyframe(key).expect("a keyframe"),
                None => alone.sim.reset(),
            }
        }
    }

    /// Records that environment `env` was poisoned.
    pub fn poisoned(&mut self, env: usize) {
        if let Some(alone) = self.find(env) {
            alone.healthy = false;
        }
    }

    /// Copies the controls of the batch.
    pub fn copy_controls(&mut self, batch: &Batch<S>) {
        for alone in self.alone.iter_mut().filter(|alone| alone.healthy) {
            let ctrl = batch.state.ctrl.row(alone.env);
            alone.sim.set_ctrl(ctrl).expect("finite controls");
        }
    }

    /// Steps the watched environments and compares them with the batch.
    pub fn step(&mut self, batch: &Batch<S>) {
        for alone in self.alone.iter_mut().filter(|alone| alone.healthy) {
            let SingleEnv { env, sim, healthy } = alone;
            let result = sim.step();
            self.steps += 1;
            match (batch.status(*env), result) {
                (EnvStatus::Running, Ok(())) if !sim.contact_overflow() => {
                    let (state, rows) = (&sim.state, &batch.state);
                    let equal = same(&state.qpos, rows.qpos.row(*env))
                        && same(&state.qvel, rows.qvel.row(*env))
                        && same(&state.act, rows.act.row(*env))
                        && same(&state.qacc_warmstart, rows.qacc_warmstart.row(*env))
                        && same(&[state.time], rows.time.row(*env));
                    assert!(equal, "environment {env} is not what it would be alone");
                }
                (EnvStatus::Failed(Fault::ContactOverflow { .. }), Ok(()))
                    if sim.contact_overflow() =>
                {
                    self.same_failures += 1;
                    *healthy = false;
                }
                (EnvStatus::Failed(fault), Err(SimError::Fault(other))) => {
                    assert_eq!(fault.to_string(), other.to_string(), "environment {env}");
                    self.same_failures += 1;
                    *healthy = false;
                }
                (status, result) => {
                    panic!("environment {env}: {status:?} in the batch, {result:?} alone")
                }
            }
        }
    }

    pub fn check_everything_happened(&self) {
        assert!(self.steps > 0 && self.same_failures > 0, "{self}");
    }
}

impl<S: Precision> Display for Watch<S> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(
            f,
            "{} environments were watched: {} steps and {} failures as alone, to the bit",
            self.alone.len(),
            self.steps,
            self.same_failures
        )
    }
}
