//! Rows of what happened after every K-th step, for an `.npz` file.

use crate::npy::Npz;
use crate::simulate::summary::worst_penetration;
use anyhow::{Context, Result};
use clench::math::Scalar;
use clench::rigid::Precision;
use clench::{Batch, Model, Sim};
use std::fs::File;
use std::path::{Path, PathBuf};

/// The outputs of a batch that a record holds beside states.
pub const BATCH_OUTPUTS: [&str; 2] = ["contact_count", "solver_iterations"];

/// A file that a record goes to.
struct Target {
    path: PathBuf,
    file: File,
}

impl Target {
    /// The file is made at once: a path that cannot be written should not cost the user a run.
    fn create(path: &Path) -> Result<Self> {
        let file = File::create(path).with_context(|| format!("--record {}", path.display()))?;
        Ok(Target {
            path: path.to_path_buf(),
            file,
        })
    }

    fn fill(self, write: impl FnOnce(&mut Npz) -> Result<()>) -> Result<()> {
        let mut npz = Npz::new(self.file);
        write(&mut npz)
            .and_then(|()| npz.finish())
            .with_context(|| format!("--record {}", self.path.display()))
    }
}

/// The record of one environment.
pub struct Recorder {
    every: usize,
    time: Vec<f64>,
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    ctrl: Vec<f64>,
    contacts: Vec<i64>,
    penetration: Vec<f64>,
    iterations: Vec<i64>,
    gradient: Vec<f64>,
    improvement: Vec<f64>,
    gap: Vec<f64>,
    status: Vec<i64>,
    target: Target,
}

impl Recorder {
    /// An empty record that keeps every `every`-th step.
    pub fn create(path: &Path, every: usize) -> Result<Self> {
        Ok(Recorder {
            every,
            time: Vec::new(),
            qpos: Vec::new(),
            qvel: Vec::new(),
            ctrl: Vec::new(),
            contacts: Vec::new(),
            penetration: Vec::new(),
            iterations: Vec::new(),
            gradient: Vec::new(),
            improvement: Vec::new(),
            gap: Vec::new(),
            status: Vec::new(),
            target: Target::create(path)?,
        })
    }

    /// Appends the state that step number `step` (from 0) led to, and the statistics of its solve.
    pub fn after_step<T: Precision>(&mut self, step: usize, sim: &Sim<T>) {
        if !(step + 1).is_multiple_of(self.every) {
            return;
        }
        self.time.push(sim.state.time.to_f64());
        extend(&mut self.qpos, &sim.state.qpos);
        extend(&mut self.qvel, &sim.state.qvel);
        extend(&mut self.ctrl, &sim.state.ctrl);
        let stats = sim.stats();
        self.contacts.push(sim.contacts().len() as i64);
        self.penetration.push(worst_penetration(sim));
        self.iterations.push(stats.iterations as i64);
        self.gradient.push(stats.gradient);
        self.improvement.push(stats.improvement);
        self.gap.push(stats.gap);
        self.status.push(stats.status as i64);
    }

    /// Writes the record.
    ///
    /// Arrays: `time` (n), `qpos` (n, nq), `qvel` (n, nv), `ctrl` (n, nu), `contacts`, `penetration`, `iterations`,
    /// `gradient`, `improvement`, `gap`, `status` (n).
    pub fn write(self, model: &Model) -> Result<()> {
        let n = self.time.len();
        self.target.fill(|npz| {
            npz.array("time", &[n], self.time)?;
            npz.array("qpos", &[n, model.nq], self.qpos)?;
            npz.array("qvel", &[n, model.nv], self.qvel)?;
            npz.array("ctrl", &[n, model.nu()], self.ctrl)?;
            npz.array("contacts", &[n], self.contacts)?;
            npz.array("penetration", &[n], self.penetration)?;
            npz.array("iterations", &[n], self.iterations)?;
            npz.array("gradient", &[n], self.gradient)?;
            npz.array("improvement", &[n], self.improvement)?;
            npz.array("gap", &[n], self.gap)?;
            npz.array("status", &[n], self.status)
        })
    }
}

/// The record of a batch. Numbers come step by step and are written environment by environment.
pub struct BatchRecorder {
    time: Vec<f64>,
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    contacts: Vec<f64>,
    iterations: Vec<f64>,
    /// The same in all environments.
    ctrl: Vec<f64>,
    target: Target,
}

impl BatchRecorder {
    /// An empty record with room for `rows` steps of `envs` environments: like a path that cannot be written, a lack of
    /// memory should not cost the user a run.
    pub fn create(path: &Path, model: &Model, envs: usize, rows: usize) -> Result<Self> {
        let target = Target::create(path)?;
        let room = |width: usize| {
            let numbers = rows.saturating_mul(envs).saturating_mul(width);
            let mut values = Vec::new();
            let outcome = values.try_reserve_exact(numbers);
            outcome.with_context(|| {
                let shape = format!("{envs} environments and {rows} steps");
                format!(
                    "--record {}: {shape} need more memory than there is",
                    path.display()
                )
            })?;
            anyhow::Ok(values)
        };
        Ok(BatchRecorder {
            time: room(1)?,
            qpos: room(model.nq)?,
            qvel: room(model.nv)?,
            contacts: room(1)?,
            iterations: room(1)?,
            ctrl: Vec::new(),
            target,
        })
    }

    /// Appends the states, and what the last step gave out; `ctrl` are its controls.
    pub fn after_step<S: Precision>(&mut self, batch: &Batch<S>, ctrl: &[S]) {
        extend(&mut self.time, batch.state.time.as_slice());
        extend(&mut self.qpos, batch.state.qpos.as_slice());
        extend(&mut self.qvel, batch.state.qvel.as_slice());
        let outputs = [&mut self.contacts, &mut self.iterations];
        for (column, name) in outputs.into_iter().zip(BATCH_OUTPUTS) {
            let rows = batch.output(name);
            extend(column, rows.map_or(&[], |rows| rows.as_slice()));
        }
        extend(&mut self.ctrl, ctrl);
    }

    /// Writes the record.
    ///
    /// Arrays: `time` (envs, n), `qpos` (envs, n, nq), `qvel` (envs, n, nv), `ctrl` (envs, n, nu), `contacts`, `iterations`
    /// (envs, n).
    pub fn write(self, model: &Model, envs: usize) -> Result<()> {
        let n = self.time.len() / envs;
        // From steps of environments to environments of steps; `count` environments take part in each step.
        let by_env = |values: Vec<f64>, count: usize, width: usize| {
            (0..envs * n * width).map(move |i| {
                let (row, column) = (i / width, i % width);
                let (env, step) = (row / n, row % n);
                values[(step * count + env % count) * width + column]
            })
        };
        let whole = |x: f64| x as i64;
        let Model { nq, nv, .. } = *model;
        self.target.fill(|npz| {
            npz.array("time", &[envs, n], by_env(self.time, envs, 1))?;
            npz.array("qpos", &[envs, n, nq], by_env(self.qpos, envs, nq))?;
            npz.array("qvel", &[envs, n, nv], by_env(self.qvel, envs, nv))?;
            npz.array(
                "ctrl",
                &[envs, n, model.nu()],
                by_env(self.ctrl, 1, model.nu()),
            )?;
            let contacts = by_env(self.contacts, envs, 1).map(whole);
            npz.array("contacts", &[envs, n], contacts)?;
            let iterations = by_env(self.iterations, envs, 1).map(whole);
            npz.array("iterations", &[envs, n], iterations)
        })
    }
}

fn extend<T: Scalar>(to: &mut Vec<f64>, values: &[T]) {
    to.extend(values.iter().map(|x| x.to_f64()));
}
