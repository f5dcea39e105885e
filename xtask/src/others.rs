//! `cargo xtask others`: tests of the Python package with large external packages, which `cargo xtask test` omits. They
//! are in separate folders below `.venv`, so that no other test imports them.

use crate::package;
use crate::python::{install, interpreter, prepare};
use crate::run::{Profile, command, root, run};

/// A group of packages and the tests that need them.
struct Group {
    name: &'static str,
    /// The list of packages in `parity`.
    list: &'static str,
    /// The folder of the packages.
    folder: &'static str,
    tests: &'static [&'static str],
}

const GROUPS: [Group; 3] = [
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
            "python/tests/test_torch.py",
            "python/tests/test_jax.py",
            "python/tests/test_dlpack.py",
            "python/tests/test_unisim.py",
            "python/tests/test_learning_examples.py",
            "python/tests/gymnasium/test_stable_baselines3.py",
            "python/tests/gymnasium/test_torchrl.py",
        ],
    },
    Group {
        name: "lerobot",
        list: "others-lerobot.txt",
        folder: ".venv/lerobot",
        tests: &["python/tests/test_lerobot_env.py"],
    },
];

/// Tests the package with all groups, or the one that `args` names.
///
/// # Errors
/// Returns an error if a name is unknown, or an installation or a test fails.
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
