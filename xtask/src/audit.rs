//! `cargo xtask audit`: checks of the dependencies, by `cargo deny`.

use crate::run::{cargo, run};

/// Checks licences, duplicate crates and sources, by `cargo deny` and `deny.toml`; then advisories, whose database is
/// fetched.
///
/// # Errors
/// Returns an error if `cargo deny` finds a problem or is missing. A database that cannot be fetched is only a remark.
pub(crate) fn audit() -> Result<(), String> {
    let deny = |args: &[&str]| {
        let mut deny = cargo(&["deny", "--workspace", "--all-features"]);
        deny.args(args);
        deny
    };
    run(deny(&["check", "licenses", "bans", "sources"])).map_err(|error| {
        format!("{error}\n`cargo install cargo-deny --locked` installs what this needs.")
    })?;
    match run(deny(&["fetch", "db"])) {
        Ok(()) => run(deny(&["check", "--disable-fetch", "advisories"])),
        Err(error) => {
            println!(
                "Advisories were not checked, because their database is not reachable: {error}"
            );
            Ok(())
        }
    }
}
