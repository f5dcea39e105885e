//! `cargo xtask soak`: long searches for rare failures.

use crate::gpu;
use crate::package;
use crate::python;
use crate::run::{Profile, cargo, command, run};
use crate::stages::build;

/// The long form of a test.
struct Soak {
    name: &'static str,
    package: &'static str,
    /// The test program, and the test in it.
    test: &'static str,
    case: &'static str,
}

const SOAKS: [Soak; 5] = [
    Soak {
        name: "batch",
        package: "clench",
        test: "soak",
        case: "long",
    },
    Soak {
        name: "endurance",
        package: "clench",
        test: "soak",
        case: "endurance",
    },
    Soak {
        name: "resume",
        package: "clench",
        test: "soak",
        case: "resume_long",
    },
    Soak {
        name: "collide",
        package: "clench-collide",
        test: "suite",
        case: "",
    },
    Soak {
        name: "recordings",
        package: "clench-cli",
        test: "suite",
        case: "killed::long",
    },
];

/// The soak that is a script: comparison of random models with MuJoCo.
const MODELS: &str = "models";
/// The soak of random models on a GPU.
const DEVICE: &str = "device";
/// The soak of the Python package: derivatives of public models.
const DERIVATIVES: &str = "derivatives";

/// The variable of the environment that tests read the seed from.
const SEED: &str = "SOAK_SEED";

/// Runs all soaks. `args` may select one by `--only`, and contain a seed.
///
/// # Errors
/// Returns an error if the arguments are invalid or a soak fails.
pub(crate) fn soak(args: &[String]) -> Result<(), String> {
    let (only, rest) = match args {
        [flag, only, rest @ ..] if flag == "--only" => (Some(only.as_str()), rest),
        _ => (None, args),
    };
    let seed = match rest {
        [] => 1,
        [seed] => seed
            .parse::<u64>()
            .map_err(|_| format!("`{seed}` is not a seed: it must be an integer"))?,
        _ => return Err("soak takes `--only NAME` and a seed, in that order".into()),
    };
    let chosen: Vec<&Soak> = (SOAKS.iter())
        .filter(|soak| only.is_none_or(|only| only == soak.name))
        .collect();
    let is_chosen = |name: &str| only.is_none_or(|only| only == name);
    if chosen.is_empty() && ![MODELS, DEVICE, DERIVATIVES].into_iter().any(is_chosen) {
        let names = SOAKS.map(|soak| soak.name).join(", ");
        return Err(format!(
            "soak accepts --only with one of {MODELS}, {DEVICE}, {DERIVATIVES}, {names}"
        ));
    }
    if is_chosen(MODELS) {
        soak_models(seed)?;
    }
    if is_chosen(DEVICE) {
        gpu::soak(seed)?;
    }
    if is_chosen(DERIVATIVES) {
        package::install(Profile::Release)?;
        // A model takes minutes.
        let patient = "--override-ini=faulthandler_timeout=0";
        let mut test = python::tests(
            Profile::Release,
            &[patient, "python/tests/test_public_derivatives.py"],
        );
        test.env(SEED, seed.to_string());
        run(test)?;
    }
    for soak in chosen {
        let mut test = cargo(&["test", "--release", "--package", soak.package]);
        test.args(["--test", soak.test, "--", "--ignored", "--nocapture"]);
        if !soak.case.is_empty() {
            test.args(["--exact", soak.case]);
        }
        test.env(SEED, seed.to_string());
        run(test)?;
    }
    Ok(())
}

/// Compares many random models with MuJoCo.
fn soak_models(seed: u64) -> Result<(), String> {
    let profile = Profile::Release;
    build(profile)?;
    python::prepare()?;
    let mut script = command(python::interpreter(), &["parity/soak_models.py"]);
    script.arg(seed.to_string());
    script.env("CLENCH", profile.program("clench"));
    run(script)
}
