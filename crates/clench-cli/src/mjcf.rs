//! `clench mjcf`: the supported part of MJCF.

use anyhow::Result;
use clap::Args;
use clench::formats::supported;
use std::io::{self, Write};

/// Prints each element of MJCF with the attributes that are read, those that are accepted without effect on motion,
/// those that are refused (`name=value`: unless they have that value, which has no effect), and the elements that it
/// may contain.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Only this element; `parent/name` if its meaning depends on the parent
    element: Option<String>,
}

/// Prints everything to standard output.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut out = io::stdout().lock();
    let wanted = |element: &str| arguments.element.as_deref().is_none_or(|e| e == element);
    for support in supported().filter(|support| wanted(&support.element)) {
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
    Ok(())
}
