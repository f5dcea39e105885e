//! `cargo xtask others`: the Python package beside large packages of others, which `cargo xtask test` does without. They lie in folders
//! of their own below `.venv`, so that no other test sees them.

use crate::package;
use crate::python::{install, interpreter, prepare};
use crate::run::{Profile, command, root, run};

/// Packages that belong together, and the tests that need them.
struct Group {
    name: &'static str,
    /// Their list in `parity`.
    list: &'static str,
    /// Their folder.
    folder: &'static str,
    tests: &'static [&'static str],
}

const GROUPS: [Group; 2] = [
    Group {
        name: "ray",
        list: "others-ray.txt",
        folder: ".venv/ray",
        tests: &["python/tests/test_ray.py"],
    },
    Group {
        name: "learning",
        list: "others-learning.txt",
        folder: ".venv/learning",
        tests: &[
            "python/tests/gymnasium/test_stable_baselines3.py",
            "python/tests/gymnasium/test_torchrl.py",
        ],
    },
];

/// Tests the package beside all of them, or the one that `args` names.
///
/// # Errors
/// Names that mean nothing, what could not be installed, or that a test failed.
pub(crate) fn test(args: &[String]) -> Result<(), String> {
    let chosen: Vec<&Group> = match args {
        [] => GROUPS.iter().collect(),
        [only] => GROUPS.iter().filter(|group| group.name == only).collect(),
        _ => Vec::new(),
    };
    if chosen.is_empty() {
        let names = GROUPS.map(|group| group.name).join(" or ");
        return Err(format!("others takes {names}, or nothing for all"));
    }
    prepare()?;
    package::install(Profile::Release)?;
    for group in chosen {
        install(group.list, &["--upgrade", "--target", group.folder])?;
        let mut pytest = command(interpreter(), &["-m", "pytest", "--quiet", "-rs"]);
        pytest.args(group.tests);
        pytest.env("PYTHONPATH", root().join(group.folder));
        run(pytest)?;
    }
    Ok(())
}
