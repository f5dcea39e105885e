//! Packages that the tests install if permitted: Debian's, in a container.

use std::process::{Command, Stdio};

/// Returns true if the user is the superuser, as in a container, so that no consent is needed.
fn may_install() -> bool {
    let user = Command::new("id").arg("-u").output();
    user.is_ok_and(|user| user.stdout.trim_ascii() == b"0")
}

/// Installs a Debian package if permitted. The caller checks the result.
pub(crate) fn try_to_install(package: &str) {
    if !may_install() {
        return;
    }
    println!("installing {package}");
    let install = ["install", "-qq", "--no-install-recommends", package];
    for arguments in [&["update", "-qq"][..], &install] {
        let mut apt = Command::new("apt-get");
        apt.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        let _ = apt.stdout(Stdio::null()).stderr(Stdio::null()).status();
    }
}
