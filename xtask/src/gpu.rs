//! The tests of `clench-gpu`, of `clench-render` and of the films of the program, on a graphics device or on Mesa's software device.

use crate::install::try_to_install;
use crate::python;
use crate::run::{cargo, run};
use std::path::Path;

/// Where drivers for Vulkan register on Linux.
const DRIVERS: [&str; 2] = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// Runs them. All packages are named, so that nothing is compiled anew for other features.
///
/// # Errors
/// That a test failed.
pub(crate) fn test() -> Result<(), String> {
    let mut tests = cargo(&["test", "--quiet", "--workspace"]);
    tests.args(["--features", "clench-cli/gpu,clench-cli/render"]);
    for test in [
        "stages",
        "steps",
        "refusals",
        "gymnasium",
        "dm_control",
        "gpu",
        "silhouettes",
        "surfaces",
        "films",
    ] {
        tests.args(["--test", test]);
    }
    tests.env("CLENCH_GPU", "require");
    // A part of Mesa that would choose the device complains on stderr where there is no display.
    tests.env("NODEVICE_SELECT", "1");
    tests.env("CLENCH_GYMNASIUM", python::gymnasium_assets()?);
    tests.env("CLENCH_DM_CONTROL", python::dm_control_suite());
    run(tests)
}

/// Why they cannot run here, if they cannot. Where the tests may, they install Mesa's drivers.
pub(crate) fn no_device() -> Option<String> {
    if !cfg!(target_os = "linux") || has_driver() {
        return None;
    }
    try_to_install("mesa-vulkan-drivers");
    let missing = "there is no driver for Vulkan; install that of your card, or Debian's package mesa-vulkan-drivers";
    (!has_driver()).then(|| missing.to_owned())
}

fn has_driver() -> bool {
    let files = |folder: &&str| Path::new(folder).read_dir().into_iter().flatten().count();
    DRIVERS.iter().any(|folder| files(folder) > 0)
}
