//! The arguments of `clench simulate`.

use super::start::StartArguments;
use crate::limits::MemoryArguments;
use crate::options::ModelArguments;
use anyhow::Result;
use clap::{Args, ValueEnum};
use clench::math::Instructions;
use clench::{BatchOptions, RigidOptions};
use std::path::PathBuf;

/// Steps the model from its initial state, or a keyframe, and prints a summary: the speed without input and output,
/// contacts and solver iterations per step, the maximum duality gap (a proven bound of the cost above the minimum), the
/// maximum penetration, and the energy drift if no element of the model adds or removes energy. For a batch also: the
/// divergence of its environments, the memory, and the environments that failed. One keyword rates the quality of the
/// run, see below; its defects are also printed as warnings on standard error.
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(crate) struct Arguments {
    /// Steps to take [default: one simulated second, or as many as --ctrl has rows]
    #[arg(long, value_name = "N", conflicts_with = "time")]
    pub(super) steps: Option<usize>,
    /// Seconds to simulate
    #[arg(long, value_name = "SECONDS")]
    pub(super) time: Option<f64>,
    /// Controls as a NumPy array (N, nu): row k for step k, the same in every environment
    #[arg(long, value_name = "FILE.npy")]
    pub(super) ctrl: Option<PathBuf>,
    /// Write time, qpos, qvel, ctrl, contact and solver statistics as NumPy arrays (`.npz`); for a single environment
    /// also a page that replays the run in a browser (`.html`), or poses, shapes, forces and plots as messages for
    /// Foxglove (`.mcap`). The first two replace an old file at the end of the run; `.mcap` can be read up to the last
    /// second even if the run is killed
    #[arg(long, value_name = "OUT")]
    pub(super) record: Option<PathBuf>,
    /// Record every K-th step
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = at_least_one)]
    pub(super) every: usize,
    /// Floating-point precision [default: 64, on a GPU 32]
    #[arg(long, value_name = "BITS")]
    pub(super) precision: Option<Bits>,
    /// Report the time of each stage of a step, including the cost of reading the clock
    #[arg(long)]
    pub(super) profile: bool,
    /// Print the summary as one JSON object, the last line of the output
    #[arg(long)]
    pub(super) json: bool,

    #[command(flatten)]
    pub(super) start: StartArguments,

    #[command(flatten)]
    pub(super) batch: BatchArguments,

    #[command(flatten)]
    pub(super) memory: MemoryArguments,

    // Last, because its help heading applies to all following arguments.
    #[command(flatten)]
    pub(super) model: ModelArguments,
}

pub(super) const DETAILS: &str = "\
A record has one row per recorded step: time, qpos, qvel and ctrl after the step; contacts, penetration (m),
iterations, gradient, improvement, gap and status of its solve (0 unconstrained, 1 proven by the gap, 2 converged,
3 no progress at the working precision, 4 iteration limit, 5 not finite). The record of a batch has time, qpos, qvel, ctrl,
contacts and iterations of each environment; a failed environment repeats its last valid row.

The quality of a run is `good`, or the most severe of:
  energy_growth         mechanical energy rose by more than twice what actuators put in and what lifting each body by its own
                        radius of gyration takes, and a fifth of the kinetic energy (not tested if mocap bodies, gravity
                        compensation or wind can add energy)
  deep_penetration      in more than 1% of the steps a contact was deeper than half the thickness of one of its geoms,
                        and deeper than its softness explains: at rest under its force, or in an impact at 5 m/s
  constraint_violation  in more than 5% of the steps an equality or a limit was violated by more than 0.1 (m or rad),
                        and by more than its softness explains
  unconverged           the solves of more than 1% of the steps stopped at the iteration limit

Ctrl-C (SIGINT) and SIGTERM end a run after the current step: the record is written, the summary reports `interrupted`, and the
exit code is 130 or 143. A second signal ends the program at once, without a record. The exit code is 2 for bad input and for
runs that failed.";

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Bits {
    #[value(name = "64")]
    Double,
    #[value(name = "32")]
    Single,
}

pub(super) fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("it must be at least 1".into()),
        Ok(number) => Ok(number),
        Err(error) => Err(error.to_string()),
    }
}

/// The number of environments and the options of stepping them.
#[derive(Args)]
#[command(next_help_heading = "Many environments")]
pub(crate) struct BatchArguments {
    /// Step N environments as a batch
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub envs: Option<u32>,
    /// Another model for some environments: with the same bodies, joints, actuators and sensors, and geoms and numbers
    /// of its own. Environment i has the i-th of all models, in turn; repeat the flag for more
    #[arg(long, value_name = "FILE", requires = "envs")]
    pub(super) other_model: Vec<PathBuf>,
    /// Threads of a batch [default: the number of processors], or of each step of a single environment [default: 1]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Vector instructions of a batch [default: the fastest of this processor]
    #[arg(long, ignore_case = true, requires = "envs")]
    pub(super) instructions: Option<InstructionsName>,
    /// Device that steps a batch: the processor, or (with the feature `gpu`) a GPU
    #[arg(long, value_name = "DEVICE", default_value = "cpu", requires = "envs")]
    pub device: DeviceName,
    /// Do not group environments with similar contacts in the same SIMD lanes
    #[arg(long, requires = "envs")]
    pub(super) no_grouping: bool,
}

/// The device that steps environments.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DeviceName {
    Cpu,
    Gpu,
}

impl BatchArguments {
    /// Returns the first given flag that applies only to the CPU.
    #[cfg(feature = "gpu")]
    pub(crate) fn of_processor(&self) -> Option<&'static str> {
        let flags = [
            ("--threads", self.threads.is_some()),
            ("--instructions", self.instructions.is_some()),
            ("--no-grouping", self.no_grouping),
        ];
        let is_set = flags.into_iter().find(|&(_, is_set)| is_set);
        is_set.map(|(flag, _)| flag)
    }

    pub(super) fn options(&self, options: RigidOptions) -> BatchOptions {
        BatchOptions {
            options,
            instructions: self.instructions.map(|name| match name {
                InstructionsName::Scalar => Instructions::Scalar,
                InstructionsName::Portable => Instructions::Portable,
                InstructionsName::Neon => Instructions::Neon,
                InstructionsName::Avx2 => Instructions::Avx2,
                InstructionsName::Avx512 => Instructions::Avx512,
            }),
            threads: self.threads.map(usize::from),
            grouping: !self.no_grouping,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum InstructionsName {
    Scalar,
    Portable,
    Neon,
    Avx2,
    Avx512,
}
