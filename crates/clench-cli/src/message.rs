//! Messages on standard error.

use std::fmt::Display;
use std::io::{self, Write};

/// Writes a line to standard error; a failure to write is ignored.
pub(crate) fn print_message(message: impl Display) {
    let _ = writeln!(io::stderr(), "{message}");
}
