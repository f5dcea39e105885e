//! Correction of the checksums of PNG files, so that mutated bytes pass them.

/// The length of the signature of PNG files.
const SIGNATURE: usize = 8;

/// Returns the file with correct checksums of all chunks. Checksums inside the deflated data stay as they are.
pub fn mend(data: &[u8]) -> Vec<u8> {
    let mut bytes = data.to_vec();
    let mut at = SIGNATURE;
    // A chunk: the length of its data, four letters, the data, the checksum of letters and data.
    while let Some(head) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let Some(end) = (at + 8)
            .checked_add(length)
            .filter(|end| end + 4 <= bytes.len())
        else {
            break;
        };
        let sum = crc32(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
    bytes
}

/// Computes the cyclic redundancy check of the PNG specification.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
    let crc = bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc))
    });
    !crc
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_file_stays_as_it_is_and_a_changed_checksum_is_mended() {
        let hills: &[u8] = include_bytes!("../seeds/png/hills.png");
        assert_eq!(mend(hills), hills);
        let mut broken = hills.to_vec();
        let last = broken.len() - 1;
        broken[last] ^= 1;
        assert_eq!(mend(&broken), hills);
    }
}
