//! What of a frame differs from the one before it, so that what does not move is not sent again.
//!
//! A delta has the head of a frame with the letters `CLND` in place of `CLNF`: flags, time, number of sections, how many rows each has.
//! Then comes each section: 0 (u32) and nothing where it is as before; 1 and a bit a row, in words of 32 bits from the lowest bit on,
//! and the rows whose bit is set, where it has as many rows as before; 2 and all rows otherwise.

use crate::frame::{MAGIC, SECTIONS};

/// What a delta begins with.
pub const DELTA: [u8; 4] = *b"CLND";

/// Bytes of a number.
const NUMBER: usize = 4;
/// Letters, flags, time and the number of sections.
const HEAD: usize = 20;

/// The bytes that turn one frame into the next; `None` where the frame itself is as short, or either is none.
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

/// The rows of each section of a frame.
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

/// Appends which rows of so many bytes differ, and those rows.
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
