//! The stage `size`: checks that the machine code and constants of released files stay below a limit.

use crate::run::{Profile, run};
use std::fs;
use std::path::Path;

/// The limits of the program and of the Python module, bytes, by `cargo build --release` for this processor.
const LIMITS: [(&str, &str, u64); 2] = [
    ("clench-cli", "clench", 9_000_000),
    ("clench-python", "libclench_python.so", 12_000_000),
];

/// Builds and measures both.
///
/// # Errors
/// Returns an error if one cannot be built or read, or is too large.
pub(crate) fn check() -> Result<(), String> {
    let mut too_large = Vec::new();
    for (package, file, limit) in LIMITS {
        run(Profile::Release.cargo(&["build", "--quiet", "--release", "--package", package]))?;
        let path = Profile::Release.folder().join(file);
        let bytes = text_segment(&path)?;
        let line = format!(
            "{file}: {:.2} MB of {} MB",
            bytes as f64 / 1e6,
            limit as f64 / 1e6
        );
        println!("{line}");
        if bytes > limit {
            too_large.push(line);
        }
    }
    match too_large.is_empty() {
        true => Ok(()),
        false => Err(format!(
            "The text segment is too large of\n{}",
            too_large.join("\n")
        )),
    }
}

/// Returns the reason if sizes cannot be measured here.
pub(crate) fn no_elf() -> Option<String> {
    let is_supported = cfg!(all(
        target_os = "linux",
        target_pointer_width = "64",
        target_endian = "little"
    ));
    (!is_supported).then(|| "only files for 64-bit Linux are measured".to_owned())
}

/// Returns the size of the text segment of an ELF file, bytes, as in `size`.
fn text_segment(path: &Path) -> Result<u64, String> {
    let bytes = fs::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    sum_of_sections(&bytes).ok_or_else(|| {
        format!(
            "{} is not a 64-bit ELF file, or is truncated",
            path.display()
        )
    })
}

/// Returns the total size of all sections that are in memory and not writable: code, constants, unwind tables. See
/// "System V Application Binary Interface", chapter 4, with the offsets of 64-bit files.
fn sum_of_sections(file: &[u8]) -> Option<u64> {
    const MAGIC_64_LITTLE: &[u8] = b"\x7fELF\x02\x01";
    const WRITABLE: u64 = 1;
    const IN_MEMORY: u64 = 2;
    if !file.starts_with(MAGIC_64_LITTLE) {
        return None;
    }
    let table = usize::try_from(number::<8>(file, 0x28)?).ok()?;
    let size = number::<2>(file, 0x3A)? as usize;
    let count = number::<2>(file, 0x3C)? as usize;
    let mut sum = 0_u64;
    for index in 0..count {
        let header = file.get(table.checked_add(index * size)?..)?;
        let flags = number::<8>(header, 0x08)?;
        if flags & (IN_MEMORY | WRITABLE) == IN_MEMORY {
            sum = sum.checked_add(number::<8>(header, 0x20)?)?;
        }
    }
    Some(sum)
}

/// Reads a little-endian number of `N` bytes.
fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<u64> {
    let bytes = bytes.get(at..)?.first_chunk::<N>()?;
    Some(
        bytes
            .iter()
            .rev()
            .fold(0, |sum, &byte| sum << 8 | u64::from(byte)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a file that contains only section headers, each with flags and a size.
    fn file(sections: &[(u64, u64)]) -> Vec<u8> {
        let mut file = vec![0; 64];
        file[..6].copy_from_slice(b"\x7fELF\x02\x01");
        file[0x28] = 64;
        file[0x3A] = 64;
        file[0x3C] = sections.len() as u8;
        for (flags, size) in sections {
            let mut header = [0; 64];
            header[0x08..0x10].copy_from_slice(&flags.to_le_bytes());
            header[0x20..0x28].copy_from_slice(&size.to_le_bytes());
            file.extend(header);
        }
        file
    }

    #[test]
    fn code_and_constants_count_and_writable_sections_do_not() {
        let (code, constants, data, notes) = (6, 2, 3, 0);
        let sections = [(code, 100_000), (constants, 20), (data, 7000), (notes, 900)];
        assert_eq!(sum_of_sections(&file(&sections)), Some(100_020));
    }

    #[test]
    fn truncated_and_other_files_are_refused() {
        let whole = file(&[(2, 1)]);
        for broken in [&b""[..], b"#!/bin/sh", &whole[..50], &whole[..90]] {
            assert_eq!(sum_of_sections(broken), None);
        }
        let mut far = whole;
        far[0x28..0x30].copy_from_slice(&u64::MAX.to_le_bytes());
        assert_eq!(sum_of_sections(&far), None);
    }

    #[test]
    #[cfg(all(
        target_os = "linux",
        target_pointer_width = "64",
        target_endian = "little"
    ))]
    fn this_program_has_a_text_segment_within_its_file() {
        let path = std::env::current_exe().expect("a path");
        let size = fs::metadata(&path).expect("the file").len();
        let text = text_segment(&path).expect("an ELF file");
        assert!(text > size / 100 && text < size, "{text} of {size}");
    }
}
