//! `cargo xtask audit`: what the crates are that ours stand on, by `cargo deny`.

use crate::run::{cargo, run};

/// Licences, duplicate crates and where crates come from, by `cargo deny` and `deny.toml`; then advisories, whose database is
/// fetched.
///
/// # Errors
/// What `cargo deny` found, or that it is missing. A database that cannot be fetched is a remark.
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
            println!("Advisories were not looked at, for their database is out of reach: {error}");
            Ok(())
        }
    }
}
