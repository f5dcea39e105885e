//! The Python side of the checks: a virtual environment, `.venv`, with what `parity/requirements.txt` names, and beside it, in
//! `.venv/models`, the packages whose models are compared. It is made once.

use crate::run::{Profile, command, root, run};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages as mere folders of files: nothing that they need to run, nothing compiled, and what was there before replaced.
const UNPACK_ONLY: &[&str] = &[
    "--no-deps",
    "--no-compile",
    "--upgrade",
    "--target",
    ".venv/models",
];

/// Makes what is missing of the environment.
///
/// # Errors
/// What failed, and what to install or check.
pub(crate) fn prepare() -> Result<(), String> {
    make_environment()?;
    install("requirements.txt", &[])?;
    install("model-packages.txt", UNPACK_ONLY)
}

/// The interpreter of `.venv`.
pub(crate) fn interpreter() -> PathBuf {
    root().join(if cfg!(windows) {
        ".venv/Scripts/python.exe"
    } else {
        ".venv/bin/python"
    })
}

/// Tests in Python, some on each core; who is done takes over what others have left. A quick run leaves out those that are marked as long.
pub(crate) fn tests(profile: Profile, arguments: &[&str]) -> Command {
    let mut pytest = command(interpreter(), &["-m", "pytest", "--quiet"]);
    pytest.args(["--numprocesses", "auto", "--dist", "worksteal"]);
    if profile == Profile::Quick {
        pytest.args(["-m", "not long"]);
    }
    pytest.args(arguments);
    pytest
}

/// The folder of the robots of Gymnasium's MuJoCo tasks.
///
/// # Errors
/// That `.venv` does not have Gymnasium.
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

/// The folder of the models of dm-control's suite.
pub(crate) fn dm_control_suite() -> PathBuf {
    root().join(".venv/models/dm_control/suite")
}

/// `.venv` with pip in it. One left half made by an interrupted run is made again.
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

/// Installs what a file in `parity` lists, unless a copy of it, kept in `.venv`, says that this was done.
///
/// # Errors
/// What failed, and what to check.
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
