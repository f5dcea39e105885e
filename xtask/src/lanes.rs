//! `cargo xtask lanes`: lists calls of lane operations in the release program.
//!
//! A plain function between two kernels is compiled for the oldest processor, and each lane operation in it becomes a
//! call (see `clench_math::kernel`). This costs a factor of two to four in speed and fails no test; this list shows it.

use crate::run::{Profile, cargo, command, run};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::{ChildStdout, Stdio};

/// The number of calls below which a function is omitted: they are in its prologue and epilogue.
const FEW: usize = 8;

/// Prints the functions with such calls in descending order.
///
/// # Errors
/// Returns an error if the program cannot be built or `objdump` is missing.
pub(crate) fn list() -> Result<(), String> {
    if !cfg!(target_arch = "x86_64") {
        return Err("this list needs a program for x86-64".to_owned());
    }
    run(cargo(&["build", "--release", "--package", "clench-cli"]))?;
    let mut dump = command(
        "objdump",
        &["--disassemble", "--demangle", "--no-show-raw-insn"],
    );
    dump.arg(Profile::Release.program("clench"));
    let failed = |e: std::io::Error| format!("cannot run objdump, of the package binutils: {e}");
    let mut child = dump.stdout(Stdio::piped()).spawn().map_err(failed)?;
    let output = child.stdout.take().ok_or("objdump prints nothing")?;
    let calls = count(output).map_err(failed)?;
    let status = child.wait().map_err(failed)?;
    if !status.success() {
        return Err(format!("objdump: {status}"));
    }
    let mut rows = Vec::from_iter(calls.into_iter().filter(|&(_, calls)| calls >= FEW));
    rows.sort_by_key(|(name, calls)| (std::cmp::Reverse(*calls), name.clone()));
    println!(
        "{} functions in which operations on lanes are calls:",
        rows.len()
    );
    for (name, calls) in rows {
        println!("{calls:>6}  {name}");
    }
    Ok(())
}

/// Returns the maximum number of lane operation calls over the instances of each function.
fn count(output: ChildStdout) -> std::io::Result<BTreeMap<String, usize>> {
    let mut counts = BTreeMap::new();
    let (mut function, mut calls) = (String::new(), 0);
    for line in BufReader::new(output).split(b'\n') {
        let line = String::from_utf8_lossy(&line?).into_owned();
        if let Some(name) = header(&line) {
            record(&mut counts, &function, calls);
            (function, calls) = (name.to_owned(), 0);
        } else if is_call_of_lanes(&line) {
            calls += 1;
        }
    }
    record(&mut counts, &function, calls);
    Ok(counts)
}

fn record(counts: &mut BTreeMap<String, usize>, function: &str, calls: usize) {
    if calls > 0 {
        let known = counts.entry(function.to_owned()).or_default();
        *known = calls.max(*known);
    }
}

/// Returns the function, without its hash, that begins at a line such as
/// `00000000004c9370 <clench_collide::narrow::collide::h0123456789abcdef>:`.
fn header(line: &str) -> Option<&str> {
    let (address, rest) = line.split_once(" <")?;
    let name = rest.strip_suffix(">:")?;
    let is_address = !address.is_empty() && address.bytes().all(|b| b.is_ascii_hexdigit());
    let plain = match name.rsplit_once("::h") {
        Some((plain, hash)) if hash.len() == 16 => plain,
        _ => name,
    };
    is_address.then_some(plain)
}

/// Returns true if a line calls a lane operation: a processor intrinsic or a lane register type.
fn is_call_of_lanes(line: &str) -> bool {
    let Some((_, target)) = line.split_once("call ") else {
        return false;
    };
    let operations = ["core_arch::x86::", "lanes::registers::Registers<"];
    operations.iter().any(|name| target.contains(name)) && !target.contains("vectorize")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_lose_their_hash() {
        let line = "00000000004c9370 <clench_collide::narrow::collide::h0123456789abcdef>:";
        assert_eq!(header(line), Some("clench_collide::narrow::collide"));
        assert_eq!(header("  4c9370:\tret"), None);
    }

    #[test]
    fn calls_of_operations_are_distinguished_from_other_calls() {
        let line = |target: &str| format!("  4c93a1:\tcall   4c9370 <{target}>");
        let operation = "core::core_arch::x86::avx512f::_mm512_mul_pd::h0123456789abcdef";
        assert!(is_call_of_lanes(&line(operation)));
        assert!(!is_call_of_lanes(&line("clench_collide::narrow::collide")));
        assert!(!is_call_of_lanes("  4c93a1:\tvmulpd zmm0,zmm1,zmm2"));
    }
}
