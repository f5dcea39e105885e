//! ZIP archives of uncompressed files: each file follows its own header, and a directory of all files comes last.

use std::io::{self, Write};

/// The placeholder of a 32-bit number whose 64-bit value is in a ZIP64 record.
const ELSEWHERE: u32 = u32::MAX;
/// The placeholder of a 16-bit number.
const ELSEWHERE_SHORT: u16 = u16::MAX;
/// The identifier of the field with the 64-bit numbers of a file.
const ZIP64: u16 = 1;
/// The required versions of the format: without and with 64-bit numbers.
const VERSIONS: [u16; 2] = [20, 45];
/// The archive is a single file.
const DISK: u16 = 0;
const NO_COMMENT: u16 = 0;

/// Concatenates the bytes of numbers.
macro_rules! bytes {
    ($($number:expr),* $(,)?) => {
        [$(&$number.to_le_bytes()[..]),*].concat()
    };
}

/// An archive under construction.
pub(crate) struct Archive<W> {
    to: W,
    position: u64,
    directory: Vec<u8>,
    count: u64,
    /// The smallest length or position that is written with 64 bits.
    wide: u64,
}

impl<W: Write> Archive<W> {
    /// Creates an archive without files.
    pub(crate) fn new(to: W) -> Self {
        Archive {
            to,
            position: 0,
            directory: Vec::new(),
            count: 0,
            wide: u64::from(ELSEWHERE),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.position += bytes.len() as u64;
        self.to.write_all(bytes)
    }

    /// Adds a file of these pieces, which are iterated twice: the file's length and checksum precede it.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub(crate) fn add<P>(&mut self, name: &str, pieces: P) -> io::Result<()>
    where
        P: Iterator<Item: AsRef<[u8]>> + Clone,
    {
        let (mut length, mut checksum) = (0, crc32fast::Hasher::new());
        for piece in pieces.clone() {
            length += piece.as_ref().len() as u64;
            checksum.update(piece.as_ref());
        }
        let entry = Entry {
            name,
            length,
            checksum: checksum.finalize(),
            start: self.position,
        };
        self.directory.extend(entry.in_directory(self.wide));
        self.count += 1;
        self.write(&entry.header(self.wide))?;
        for piece in pieces {
            self.write(piece.as_ref())?;
        }
        Ok(())
    }

    /// Writes the directory.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        let (start, count) = (self.position, self.count);
        let directory = std::mem::take(&mut self.directory);
        self.write(&directory)?;
        let (end, length) = (self.position, directory.len() as u64);
        let narrow = end < self.wide && count < u64::from(ELSEWHERE_SHORT);
        if !narrow {
            /// The number of bytes after the length field.
            const LENGTH: u64 = 44;
            const DISK: u32 = 0;
            const DISKS: u32 = 1;
            let [_, version] = VERSIONS;
            let sizes = [count, count, length, start].map(u64::to_le_bytes);
            self.write(b"PK\x06\x06")?;
            self.write(&bytes![LENGTH, version, version, DISK, DISK])?;
            self.write(sizes.as_flattened())?;
            self.write(b"PK\x06\x07")?;
            self.write(&bytes![DISK, end, DISKS])?;
        }
        let (count, length, start) = match narrow {
            true => (count as u16, length as u32, start as u32),
            false => (ELSEWHERE_SHORT, ELSEWHERE, ELSEWHERE),
        };
        self.write(b"PK\x05\x06")?;
        self.write(&bytes![DISK, DISK, count, count, length, start, NO_COMMENT])?;
        self.to.flush()
    }
}

/// The metadata of a file.
struct Entry<'a> {
    name: &'a str,
    length: u64,
    checksum: u32,
    /// The position of the header.
    start: u64,
}

impl Entry<'_> {
    /// Returns the header that precedes the file.
    fn header(&self, wide: u64) -> Vec<u8> {
        let (numbers, extra) = match self.length < wide {
            true => self.numbers(&[]),
            false => self.numbers(&[self.length, self.length]),
        };
        [b"PK\x03\x04", &numbers[..], self.name.as_bytes(), &extra].concat()
    }

    /// Returns the entry of the directory.
    fn in_directory(&self, wide: u64) -> Vec<u8> {
        const NO_ATTRIBUTES: [u8; 6] = [0; 6];
        let narrow = self.length.max(self.start) < wide;
        let (start, (numbers, extra)) = match narrow {
            true => (self.start as u32, self.numbers(&[])),
            false => {
                let wide = [self.length, self.length, self.start];
                (ELSEWHERE, self.numbers(&wide))
            }
        };
        let made_by = VERSIONS[usize::from(!narrow)];
        let mut part = b"PK\x01\x02".to_vec();
        part.extend(bytes![made_by]);
        part.extend(numbers);
        part.extend(bytes![NO_COMMENT, DISK]);
        part.extend(NO_ATTRIBUTES);
        part.extend(bytes![start]);
        part.extend(self.name.as_bytes());
        part.extend(extra);
        part
    }

    /// Returns the fields that both share, and the extra field of these 64-bit numbers.
    fn numbers(&self, wide: &[u64]) -> (Vec<u8>, Vec<u8>) {
        const NO_FLAGS: u16 = 0;
        const STORED: u16 = 0;
        /// The earliest time, the beginning of 1980: equal runs give equal bytes.
        const TIME: u16 = 0;
        const DATE: u16 = 1 << 5 | 1;
        let (mut length, mut extra) = (self.length as u32, Vec::new());
        if !wide.is_empty() {
            length = ELSEWHERE;
            extra = bytes![ZIP64, (8 * wide.len() as u16)];
            extra.extend(wide.iter().flat_map(|number| number.to_le_bytes()));
        }
        let version = VERSIONS[usize::from(!wide.is_empty())];
        let lengths = [self.name.len() as u16, extra.len() as u16];
        let numbers = bytes![
            version,
            NO_FLAGS,
            STORED,
            TIME,
            DATE,
            self.checksum,
            length,
            length,
            lengths[0],
            lengths[1],
        ];
        (numbers, extra)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Read};

    /// Writes an archive with 64-bit numbers from `wide` on, and reads it with another library.
    fn there_and_back(files: &[(&str, &[u8])], wide: u64) {
        let mut bytes = Vec::new();
        let mut archive = Archive::new(&mut bytes);
        archive.wide = wide;
        for (name, contents) in files {
            archive.add(name, contents.chunks(3)).unwrap();
        }
        archive.finish().unwrap();
        let mut read = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        assert_eq!(read.len(), files.len());
        for (index, (name, contents)) in files.iter().enumerate() {
            let mut entry = read.by_index(index).unwrap();
            assert_eq!(entry.name().unwrap(), *name);
            assert_eq!(entry.size(), contents.len() as u64);
            let mut found = Vec::new();
            entry
                .read_to_end(&mut found)
                .expect("the checksum is right");
            assert_eq!(found, *contents);
        }
    }

    #[test]
    fn archives_are_read_by_others() {
        let files: [(&str, &[u8]); 3] = [
            ("a.npy", b"first of three"),
            ("none", b""),
            ("c", &[7; 1000]),
        ];
        for wide in [u64::from(ELSEWHERE), 0, 1, 15, 1000, 1001] {
            there_and_back(&files, wide);
            there_and_back(&[], wide);
        }
    }

    #[test]
    fn more_files_than_sixteen_bits_count() {
        let names: Vec<String> = (0..70_000).map(|k| k.to_string()).collect();
        let files: Vec<(&str, &[u8])> = names.iter().map(|name| (&name[..], &[][..])).collect();
        there_and_back(&files, u64::from(ELSEWHERE));
    }
}
