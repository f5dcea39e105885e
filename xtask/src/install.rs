//! What the tests install by themselves where they may: Debian's packages, in a container.

use std::process::{Command, Stdio};

/// Whether this is a machine where nobody is asked: the superuser's, as in a container.
fn may_install() -> bool {
    let user = Command::new("id").arg("-u").output();
    user.is_ok_and(|user| user.stdout.trim_ascii() == b"0")
}

/// Installs a package of Debian where the tests may. Whether it worked shows in what is there afterwards.
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
