//! Messages on standard error.

use std::fmt::Display;
use std::io::{self, Write};

/// Writes a line on standard error. That it cannot be written is nothing that anybody could be told, and no reason to stop.
pub(crate) fn tell(message: impl Display) {
    let _ = writeln!(io::stderr(), "{message}");
}
