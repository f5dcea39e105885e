//! The Python side of the checks: a virtual environment with MuJoCo, and public robot models to compare on.
//!
//! `parity/requirements.txt` names what is installed in `.venv`. `parity/wheels.txt` names the packages that are only
//! unpacked, into `.cache/NAME-VERSION`, for the model files inside them. Both steps do nothing when they are done.

use crate::run::{command, root, run};
use std::fs;
use std::path::{Path, PathBuf};

/// Makes what is missing of the environment and of the models.
///
/// # Errors
/// What failed, and what to install or check.
pub fn prepare() -> Result<(), String> {
    make_environment()?;
    install_requirements()?;
    unpack_wheels()
}

/// The interpreter of `.venv`.
pub fn interpreter() -> PathBuf {
    root().join(if cfg!(windows) {
        ".venv/Scripts/python.exe"
    } else {
        ".venv/bin/python"
    })
}

/// `.venv` with pip in it. One left half made by an interrupted run is made again.
fn make_environment() -> Result<(), String> {
    let has_pip = |mut c: std::process::Command| c.output().is_ok_and(|o| o.status.success());
    if interpreter().is_file() && has_pip(command(interpreter(), &["-m", "pip", "--version"])) {
        return Ok(());
    }
    println!("making .venv");
    run(command("python3", &["-m", "venv", "--clear", ".venv"])).map_err(|e| {
        format!("{e}\nMaking .venv needs Python 3.11 or later with its venv module; on Debian and Ubuntu: apt install python3-venv")
    })
}

/// Installs `parity/requirements.txt` unless a copy of it, kept in `.venv`, says that this was done.
fn install_requirements() -> Result<(), String> {
    let wanted = read(&root().join("parity/requirements.txt"))?;
    let done = root().join(".venv/requirements-installed.txt");
    if fs::read_to_string(&done).is_ok_and(|have| have == wanted) {
        return Ok(());
    }
    println!("installing parity/requirements.txt");
    run(command(interpreter(), &["-m", "pip", "install", "--quiet", "-r", "parity/requirements.txt"])).map_err(
        |e| format!("{e}\nA package index must be reachable, and Python be 3.11 or later (MuJoCo 4.0 needs it)."),
    )?;
    fs::write(&done, wanted).map_err(|e| format!("cannot write {}: {e}", done.display()))
}

/// Downloads and unpacks each line of `parity/wheels.txt` that is not in `.cache` yet.
fn unpack_wheels() -> Result<(), String> {
    let list = read(&root().join("parity/wheels.txt"))?;
    for line in list
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty() && !l.starts_with('#'))
    {
        let Some((name, version)) = line.split_once("==") else {
            return Err(format!(
                "parity/wheels.txt: expected NAME==VERSION, got `{line}`"
            ));
        };
        let folder = root().join(".cache").join(format!("{name}-{version}"));
        if folder.is_dir() {
            continue;
        }
        println!("fetching {line} for its model files");
        unpack_wheel(line, &folder)?;
    }
    Ok(())
}

/// One wheel into `folder`. It is unpacked beside its place and renamed, so a folder that is there is whole.
fn unpack_wheel(requirement: &str, folder: &Path) -> Result<(), String> {
    let partial = folder.with_extension("partial");
    if partial.exists() {
        fs::remove_dir_all(&partial)
            .map_err(|e| format!("cannot remove {}: {e}", partial.display()))?;
    }
    let target = partial.to_string_lossy().into_owned();
    let download = [
        "-m",
        "pip",
        "download",
        "--quiet",
        "--no-deps",
        "--only-binary",
        ":all:",
        "-d",
        &target,
        requirement,
    ];
    run(command(interpreter(), &download))
        .map_err(|e| format!("{e}\nA package index must be reachable."))?;
    let unpack = "import pathlib, sys, zipfile\n\
                  for wheel in pathlib.Path(sys.argv[1]).glob('*.whl'):\n\
                  \x20   zipfile.ZipFile(wheel).extractall(sys.argv[1])\n\
                  \x20   wheel.unlink()\n";
    run(command(interpreter(), &["-c", unpack, &target]))?;
    fs::rename(&partial, folder).map_err(|e| format!("cannot rename {}: {e}", partial.display()))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}
