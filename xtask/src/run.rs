//! Paths of the workspace, and running other programs from its root.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The parts of the program that are left out by default; checks and tests have them.
pub(crate) const ALL_FEATURES: &str =
    "clench-cli/gpu,clench-cli/render,clench-python/gpu,clench-python/render";

/// The environment variable that chooses instruction sets; see the build script of clench-math.
const INSTRUCTIONS: &str = "CLENCH_INSTRUCTIONS";

/// The workspace's root folder.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// The folder that cargo builds in.
pub(crate) fn target() -> PathBuf {
    let chosen =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
    root().join(chosen)
}

/// How cargo compiles what is not a test, and for which instruction sets it compiles all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Profile {
    /// As tests are compiled, which share it, for all instruction sets: the tests run those that the processor has.
    Dev,
    /// The same for the widest set of this processor.
    Quick,
    /// Faster, and without the checks of tests; quick to build.
    Release,
    /// What is shipped and timed: slower to build, a few percent faster.
    Dist,
}

impl Profile {
    /// Its name in `Cargo.toml`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Profile::Dev | Profile::Quick => "dev",
            Profile::Release => "release",
            Profile::Dist => "dist",
        }
    }

    /// Where cargo puts what is built with it.
    pub(crate) fn folder(self) -> PathBuf {
        target().join(match self {
            Profile::Dev | Profile::Quick => "debug",
            other => other.name(),
        })
    }

    /// A program built with it.
    pub(crate) fn program(self, name: &str) -> PathBuf {
        let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        self.folder().join(name)
    }

    /// A cargo command that may compile. All of a run choose the same instruction sets: with others everything is compiled anew.
    pub(crate) fn cargo(self, args: &[&str]) -> Command {
        let mut cargo = cargo(args);
        self.choose_instructions(&mut cargo);
        cargo
    }

    /// Chooses the instruction sets that a command compiles for, if it runs cargo.
    pub(crate) fn choose_instructions(self, command: &mut Command) {
        match self {
            Profile::Dev | Profile::Dist => command.env(INSTRUCTIONS, "all"),
            // Not by name: a plain `cargo build` then shares what was compiled.
            Profile::Quick | Profile::Release => command.env_remove(INSTRUCTIONS),
        };
    }
}

/// A command that will run in the workspace's root.
pub(crate) fn command(program: impl AsRef<std::ffi::OsStr>, args: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(args).current_dir(root());
    command
}

/// The cargo that runs this program, so that a chosen toolchain stays chosen.
pub(crate) fn cargo(args: &[&str]) -> Command {
    command(
        std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()),
        args,
    )
}

/// Runs a command to its end, its output passed through.
///
/// # Errors
/// A line saying which command failed and how.
pub(crate) fn run(mut command: Command) -> Result<(), String> {
    let status = command
        .status()
        .map_err(|e| format!("cannot start {}: {e}", shown(&command)))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{status}: {}", shown(&command)))
    }
}

/// A command as one would type it.
pub(crate) fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words
        .map(|w| w.to_string_lossy().into_owned())
        .collect::<Vec<_>>()
        .join(" ")
}
