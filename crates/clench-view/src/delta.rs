//! The difference between two consecutive frames; unchanged rows are not sent again.
//!
//! A delta has the header of a frame with the letters `CLND` instead of `CLNF`: flags, time, number of sections, row
//! count of each section. Each section follows: 0 (u32) if it is unchanged; if the row count is unchanged, 1, a bitmask
//! of changed rows in 32-bit words from the lowest bit on, and the changed rows; otherwise 2 and all rows.

use crate::frame::{MAGIC, SECTIONS};

/// The first bytes of a delta.
pub const DELTA: [u8; 4] = *b"CLND";

/// The size of a number, bytes.
const NUMBER: usize = 4;
/// The size of the letters, flags, time and number of sections, bytes.
const HEAD: usize = 20;

/// Returns the bytes that turn one frame into the next; `None` if the frame itself is not longer, or either input is
/// not a frame.
pub fn delta(before: &[u8], now: &[u8]) -> Option<Vec<u8>> {
    let (old, new) = (sections(before)?, sections(now)?);
    let mut bytes = Vec::from(DELTA);
    bytes.extend(&now[NUMBER..HEAD + NUMBER * SECTIONS.len()]);
    for ((section, old), new) in SECTIONS.iter().zip(old).zip(new) {
        if old == new {
            bytes.extend(0_u32.to_le_bytes());
        } else if old.len() == new.len() {
            bytes.extend(1_u32.to_le_bytes());
            changed_rows(section.width * NUMBER, old, new, &mut bytes);
        } else {
            bytes.extend(2_u32.to_le_bytes());
            bytes.extend(new);
        }
    }
    (bytes.len() < now.len()).then_some(bytes)
}

/// Splits a frame into the rows of each section.
fn sections(frame: &[u8]) -> Option<Vec<&[u8]>> {
    let counts = frame.get(HEAD..HEAD + NUMBER * SECTIONS.len())?;
    let mut rest = &frame[HEAD + counts.len()..];
    let mut found = Vec::with_capacity(SECTIONS.len());
    for (section, &count) in SECTIONS.iter().zip(counts.as_chunks::<NUMBER>().0) {
        let bytes = u32::from_le_bytes(count) as usize * section.width * NUMBER;
        let (rows, others) = rest.split_at_checked(bytes)?;
        found.push(rows);
        rest = others;
    }
    frame.starts_with(&MAGIC).then_some(found)
}

/// Appends the bitmask of the rows of `row` bytes that differ, and those rows.
fn changed_rows(row: usize, old: &[u8], new: &[u8], bytes: &mut Vec<u8>) {
    let pairs = || old.chunks_exact(row).zip(new.chunks_exact(row));
    let differs: Vec<bool> = pairs().map(|(old, new)| old != new).collect();
    for word in differs.chunks(32) {
        let bits = word
            .iter()
            .rev()
            .fold(0, |bits, &bit| 2 * bits + u32::from(bit));
        bytes.extend(bits.to_le_bytes());
    }
    let rows = new.chunks_exact(row).zip(&differs);
    rows.filter(|(_, differs)| **differs)
        .for_each(|(row, _)| bytes.extend(row));
}
