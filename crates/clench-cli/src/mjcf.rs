//! `clench mjcf`: the supported part of MJCF.

use anyhow::{Result, ensure};
use clap::Args;
use clench::formats::supported;
use std::io::{self, Write};

/// The arguments of `clench mjcf`.
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(crate) struct Arguments {
    /// Only this element; `parent/name` selects one of several with the same name
    element: Option<String>,
}

/// The notation of the output, for the help.
const DETAILS: &str = "\
Each element is printed with the attributes that are read, those that are ignored because they do not affect motion,
those that are refused (`name=value`: refused unless they have this value, which has no effect), and the elements that
it may contain.";

/// Prints everything to standard output.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut out = io::stdout().lock();
    let mut found = false;
    let wanted = |element: &str| match arguments.element.as_deref() {
        Some(name) => {
            name == element || element.rsplit_once('/').is_some_and(|(_, own)| name == own)
        }
        None => true,
    };
    for support in supported().filter(|support| wanted(&support.element)) {
        found = true;
        writeln!(out, "{}", support.element)?;
        let lists = [
            ("read", support.read),
            ("ignored", support.ignored),
            ("refused", support.refused),
            ("children", support.children),
        ];
        for (what, names) in lists.iter().filter(|(_, names)| !names.is_empty()) {
            writeln!(out, "  {what:<8} {}", names.join(" "))?;
        }
    }
    let element = arguments.element.as_deref().unwrap_or_default();
    ensure!(
        found,
        "MJCF has no element {element:?}, or Clench refuses it: `clench mjcf` lists the elements that it reads"
    );
    Ok(())
}
