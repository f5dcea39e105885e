//! The `clench` program; see the library of this package.

use std::process::ExitCode;

fn main() -> ExitCode {
    clench_cli::main()
}
