//! The Python environment of the checks: a virtual environment, `.venv`, with `parity/requirements.txt`, and in
//! `.venv/models` the packages whose models are compared. It is created once.

use crate::run::{Profile, command, root, run};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The options for packages that serve as folders of files: no dependencies, no compilation, old files replaced.
const UNPACK_ONLY: &[&str] = &[
    "--no-deps",
    "--no-compile",
    "--upgrade",
    "--target",
    ".venv/models",
];

/// Creates the missing parts of the environment.
///
/// # Errors
/// Returns the failure and a remedy.
pub(crate) fn prepare() -> Result<(), String> {
    make_environment()?;
    install("requirements.txt", &[])?;
    install("model-packages.txt", UNPACK_ONLY)
}

/// Returns the path of the `.venv` interpreter.
pub(crate) fn interpreter() -> PathBuf {
    root().join(if cfg!(windows) {
        ".venv/Scripts/python.exe"
    } else {
        ".venv/bin/python"
    })
}

/// Returns the command for Python tests, distributed over the cores with work stealing. A quick run omits tests that
/// are marked as long.
pub(crate) fn tests(profile: Profile, arguments: &[&str]) -> Command {
    let mut pytest = command(interpreter(), &["-m", "pytest", "--quiet"]);
    pytest.args(["--numprocesses", "auto", "--dist", "worksteal"]);
    if profile == Profile::Quick {
        pytest.args(["-m", "not long"]);
    }
    pytest.args(arguments);
    pytest
}

/// Returns the folder of the robots of Gymnasium's MuJoCo tasks.
///
/// # Errors
/// Returns an error if Gymnasium is not in `.venv`.
pub(crate) fn gymnasium_assets() -> Result<PathBuf, String> {
    let where_is = "import gymnasium, pathlib; print(pathlib.Path(gymnasium.__file__).parent)";
    let found = command(interpreter(), &["-c", where_is]).output();
    let found = found.map_err(|e| format!("{}: {e}", interpreter().display()))?;
    if !found.status.success() {
        return Err("Gymnasium is not in .venv; run `cargo xtask test python`".to_owned());
    }
    let package = String::from_utf8_lossy(&found.stdout).trim().to_owned();
    Ok(PathBuf::from(package).join("envs/mujoco/assets"))
}

/// Returns the folder of the models of dm-control's suite.
pub(crate) fn dm_control_suite() -> PathBuf {
    root().join(".venv/models/dm_control/suite")
}

/// Creates `.venv` with pip, also after an interrupted run.
fn make_environment() -> Result<(), String> {
    let has_pip = |mut c: Command| c.output().is_ok_and(|o| o.status.success());
    if interpreter().is_file() && has_pip(command(interpreter(), &["-m", "pip", "--version"])) {
        return Ok(());
    }
    println!("making .venv");
    run(command("python3", &["-m", "venv", "--clear", ".venv"])).map_err(|e| {
        format!("{e}\nMaking .venv needs Python 3.11 or later with its venv module; on Debian and Ubuntu: apt install python3-venv")
    })
}

/// Installs the packages of a list in `parity`, unless a copy of the list in `.venv` shows that this was done.
///
/// # Errors
/// Returns the failure and a remedy.
pub(crate) fn install(list: &str, options: &[&str]) -> Result<(), String> {
    let wanted = read(&root().join("parity").join(list))?;
    let done = root().join(".venv").join(format!("installed-{list}"));
    if fs::read_to_string(&done).is_ok_and(|have| have == wanted) {
        return Ok(());
    }
    println!("installing parity/{list}");
    let path = format!("parity/{list}");
    let mut pip = command(interpreter(), &["-m", "pip", "install", "--quiet"]);
    pip.args(options).args(["-r", &path]);
    run(pip).map_err(
        |e| format!("{e}\nA package index must be reachable, and Python be 3.11 or later (MuJoCo 4.0 needs it)."),
    )?;
    fs::write(&done, wanted).map_err(|e| format!("cannot write {}: {e}", done.display()))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}
