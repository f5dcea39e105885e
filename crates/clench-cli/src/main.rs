//! The `clench` program; see the library beside it.

use std::process::ExitCode;

fn main() -> ExitCode {
    clench_cli::main()
}
