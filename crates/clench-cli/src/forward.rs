//! `clench forward`: one JSON state a line in, one JSON result a line out.

use crate::options::ModelArguments;
use crate::protocol::{NextState, ResultLine, forward};
use crate::state_line;
use anyhow::{Context, Result};
use clap::Args;
use std::io::{self, BufRead, BufWriter, Write};

/// The arguments of `clench forward`.
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(crate) struct Arguments {
    /// Add the constraint Jacobian, one row per constraint row
    #[arg(long)]
    jacobian: bool,
    /// Add the mass matrix
    #[arg(long)]
    mass: bool,
    /// Add the state one step later, as `next`
    #[arg(long)]
    step: bool,

    // Last, because its help heading applies to all following arguments.
    #[command(flatten)]
    model: ModelArguments,
}

/// The format of the lines, for the help.
const DETAILS: &str = "\
Each line of standard input is a state: a JSON object with any of time, qpos, qvel, act, ctrl, qfrc_applied,
xfrc_applied (force, torque per body), mocap_pos, mocap_quat, eq_active, plastic, history, qacc_warmstart,
tree_asleep, pose_asleep, stick_references, stick_friction. Missing fields have the model's default. `contacts`, a
list of objects with the fields of MuJoCo's mjContact, replaces collision detection. Each line of standard output is
the result for that state; its `next` can be a state again, with the inputs added. The first invalid line ends the
program, with an error that names it and exit code 2.";

/// Processes every line of standard input; stops at the first invalid one with an error that names the line.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut sim = arguments.model.sim()?;
    let mut out = BufWriter::new(io::stdout().lock());
    for (number, line) in io::stdin().lock().lines().enumerate() {
        let context = || format!("standard input, line {}", number + 1);
        let line = line.with_context(context)?;
        if line.trim().is_empty() {
            continue;
        }
        sim.reset();
        let given = state_line::apply(&line, &mut sim).with_context(context)?;
        let step = || NextState::after(&mut sim, given.as_deref());
        let next = (arguments.step.then(step).transpose()).with_context(context)?;
        forward(&mut sim, given.as_deref()).with_context(context)?;
        let result = ResultLine::new(&sim, next, arguments.mass, arguments.jacobian);
        serde_json::to_writer(&mut out, &result)?;
        out.write_all(b"\n")?;
        out.flush()?;
    }
    Ok(())
}
