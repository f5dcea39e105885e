//! The initial states of a run: the model's or a keyframe, then given positions and velocities, then noise.

use crate::limits::MemoryLimit;
use crate::npy::{Rows, read_rows};
use anyhow::{Result, bail, ensure};
use clap::Args;
use clench::math::Scalar;
use clench::rigid::Precision;
use clench::rigid::dynamics::integrate::integrate_positions;
use clench::{Batch, Model, Sim};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::path::{Path, PathBuf};

/// The initial state of a run.
#[derive(Args)]
#[command(next_help_heading = "Initial states")]
pub(crate) struct StartArguments {
    /// Start from this keyframe (name or index)
    #[arg(long, value_name = "K")]
    keyframe: Option<String>,
    /// Positions and velocities as a NumPy array (envs, nq + nv): one row per environment, qpos then qvel
    #[arg(long, value_name = "FILE.npy")]
    states: Option<PathBuf>,
    /// Add uniform noise from -S to S to the position (m, rad) and velocity (m/s, rad/s) of each dof
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    noise: f64,
    /// Seed of the noise; the noise of an environment does not depend on the number of environments
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
}

/// The initial states of the environments of a run.
pub(crate) struct Starts<'a> {
    model: &'a Model,
    pub(crate) keyframe: Option<usize>,
    states: Option<Rows>,
    noise: f64,
    seed: u64,
}

impl StartArguments {
    /// Returns the file of initial states, if there is one.
    pub(crate) fn states(&self) -> Option<&Path> {
        self.states.as_deref()
    }

    /// Reads and validates the initial states for `envs` environments.
    pub(crate) fn starts<'a>(
        &self,
        model: &'a Model,
        envs: usize,
        limit: MemoryLimit,
    ) -> Result<Starts<'a>> {
        ensure!(
            self.noise.is_finite() && self.noise >= 0.0,
            "--noise: {} must be finite and not negative",
            self.noise
        );
        let keyframe = self.keyframe.as_ref();
        let states = self.states.as_ref();
        let width = model.nq + model.nv;
        let states = states.map(|path| read_rows("--states", path, width, limit));
        let states = states.transpose()?;
        if let Some(rows) = &states {
            let count = rows.count();
            ensure!(
                count == envs,
                "--states: {count} rows for {envs} environments"
            );
        }
        Ok(Starts {
            model,
            keyframe: keyframe.map(|key| find_keyframe(model, key)).transpose()?,
            states,
            noise: self.noise,
            seed: self.seed,
        })
    }
}

impl Starts<'_> {
    /// Sets a simulation to the initial state of environment 0.
    pub(crate) fn start<T: Precision>(&self, sim: &mut Sim<T>) -> Result<()> {
        if let Some(key) = self.keyframe {
            sim.reset_to_keyframe(key)?;
        }
        let (mut qpos, mut qvel) = (widen(&sim.state.qpos), widen(&sim.state.qvel));
        self.apply(0, &mut qpos, &mut qvel);
        sim.set_configuration(&narrow::<T>(&qpos), &narrow::<T>(&qvel))?;
        Ok(())
    }

    /// Sets all environments of a batch to their initial states.
    pub(crate) fn start_all<S: Precision>(&self, batch: &mut Batch<S>) -> Result<()> {
        for env in 0..batch.count() {
            if let Some(key) = self.keyframe {
                batch.reset_to_keyframe(env, key)?;
            }
            if self.states.is_some() || self.noise > 0.0 {
                let state = &mut batch.state;
                let (qpos, qvel) = (state.qpos.row_mut(env), state.qvel.row_mut(env));
                let (mut positions, mut velocities) = (widen(qpos), widen(qvel));
                self.apply(env, &mut positions, &mut velocities);
                qpos.copy_from_slice(&narrow(&positions));
                qvel.copy_from_slice(&narrow(&velocities));
            }
        }
        Ok(())
    }

    /// Applies the given state and the noise of environment `env` to the positions and velocities of the model or
    /// keyframe.
    fn apply(&self, env: usize, qpos: &mut [f64], qvel: &mut [f64]) {
        if let Some(rows) = &self.states {
            let (positions, velocities) = rows.row(env).split_at(self.model.nq);
            qpos.copy_from_slice(positions);
            qvel.copy_from_slice(velocities);
        }
        if self.noise > 0.0 {
            let nv = self.model.nv;
            let mut noise = Noise::new(self.seed, env * 2 * nv);
            let mut draw = || self.noise * noise.draw();
            let shift: Vec<f64> = (0..nv).map(|_| draw()).collect();
            integrate_positions(self.model, qpos, &shift, 1.0);
            qvel.iter_mut().for_each(|v| *v += draw());
        }
    }
}

/// Converts numbers to the precision of a simulation.
pub(super) fn narrow<S: Scalar>(values: &[f64]) -> Vec<S> {
    values.iter().map(|&x| S::new(x)).collect()
}

/// Converts numbers to double precision.
pub(super) fn widen<S: Scalar>(values: &[S]) -> Vec<f64> {
    values.iter().map(|x| x.to_f64()).collect()
}

/// A generator of numbers uniform in -1 to 1, by PCG-XSL-RR 128/64.
struct Noise(Pcg64);

impl Noise {
    /// Creates the stream of a seed, advanced by `start` numbers.
    fn new(seed: u64, start: usize) -> Self {
        let mut generator = Pcg64::seed_from_u64(seed);
        generator.advance(start as u128);
        Noise(generator)
    }

    fn draw(&mut self) -> f64 {
        let bits = self.0.next_u64() >> (u64::BITS - f64::MANTISSA_DIGITS);
        bits as f64 * f64::EPSILON - 1.0
    }
}

/// Finds a keyframe by name or index.
///
/// # Errors
/// Returns an error that lists the keyframes if there is none such.
fn find_keyframe(model: &Model, key: &str) -> Result<usize> {
    let keyframes = &model.keyframes;
    if let Some(k) = keyframes.iter().position(|k| k.name == key) {
        return Ok(k);
    }
    match key.parse::<usize>() {
        Ok(k) if k < keyframes.len() => Ok(k),
        _ if keyframes.is_empty() => bail!("--keyframe {key}: the model has no keyframes"),
        _ => {
            let names: Vec<_> = keyframes.iter().map(|k| k.name.as_str()).collect();
            bail!(
                "--keyframe {key}: not a name or an index of the model's {} keyframes ({})",
                names.len(),
                names.join(", ")
            )
        }
    }
}
