//! Paths of the workspace, and commands that run in its root.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The features that are off by default; checks and tests enable them.
pub(crate) const ALL_FEATURES: &str = "clench-cli/gpu,clench-cli/render,clench-python/gpu,clench-python/render,clench-python/derivatives";

/// The environment variable that selects instruction sets; see the build script of clench-math.
const INSTRUCTIONS: &str = "CLENCH_INSTRUCTIONS";

/// Returns the workspace's root folder.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// Returns the folder that cargo builds in.
pub(crate) fn target() -> PathBuf {
    let chosen =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
    root().join(chosen)
}

/// The cargo profile and the instruction sets of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Profile {
    /// The profile of tests, for all instruction sets: the tests run those that the processor supports.
    Dev,
    /// The same for the widest set of this processor.
    Quick,
    /// Optimized, without debug checks; quick to build.
    Release,
    /// The distributed and benchmarked build: slower to build, a few percent faster.
    Dist,
}

impl Profile {
    /// Returns the name of the profile in `Cargo.toml`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Profile::Dev | Profile::Quick => "dev",
            Profile::Release => "release",
            Profile::Dist => "dist",
        }
    }

    /// Returns the output folder of the profile.
    pub(crate) fn folder(self) -> PathBuf {
        target().join(match self {
            Profile::Dev | Profile::Quick => "debug",
            other => other.name(),
        })
    }

    /// Returns the path of a program built with the profile.
    pub(crate) fn program(self, name: &str) -> PathBuf {
        let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        self.folder().join(name)
    }

    /// Returns a cargo command that may compile. All commands of a run select the same instruction sets: other sets
    /// would recompile everything.
    pub(crate) fn cargo(self, args: &[&str]) -> Command {
        let mut cargo = cargo(args);
        self.choose_instructions(&mut cargo);
        cargo
    }

    /// Selects the instruction sets of a command that runs cargo.
    pub(crate) fn choose_instructions(self, command: &mut Command) {
        match self {
            Profile::Dev | Profile::Dist => command.env(INSTRUCTIONS, "all"),
            // Leave it unset: a plain `cargo build` then shares the compiled code.
            Profile::Quick | Profile::Release => command.env_remove(INSTRUCTIONS),
        };
    }
}

/// Creates a command that runs in the workspace's root.
pub(crate) fn command(program: impl AsRef<std::ffi::OsStr>, args: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(args).current_dir(root());
    command
}

/// Creates a command of the cargo that runs this program, so that the selected toolchain is kept.
pub(crate) fn cargo(args: &[&str]) -> Command {
    command(
        std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()),
        args,
    )
}

/// Runs a command to its end and passes its output through.
///
/// # Errors
/// Returns a line with the failed command and its status.
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

/// Formats a command as a command line.
pub(crate) fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words
        .map(|w| w.to_string_lossy().into_owned())
        .collect::<Vec<_>>()
        .join(" ")
}
