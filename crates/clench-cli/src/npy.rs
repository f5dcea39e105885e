//! NumPy files: reading arrays, writing archives of arrays.

use crate::limits::{MAX_NPY_HEADER, MemoryLimit};
use crate::zip::Archive;
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, ErrorKind, Read};
use std::iter;
use std::path::Path;

/// The first bytes of a file, before its version.
const MAGIC: &[u8] = b"\x93NUMPY";

/// An (N, width) array of numbers.
pub struct Rows {
    count: usize,
    width: usize,
    values: Vec<f64>,
}

impl Rows {
    /// Returns N.
    pub fn count(&self) -> usize {
        self.count
    }
    /// Returns row `k`.
    pub fn row(&self, k: usize) -> &[f64] {
        &self.values[k * self.width..(k + 1) * self.width]
    }
    /// Returns all numbers in row-major order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Reads an (N, `width`) array of finite numbers, given by the user as `flag`.
pub fn read_rows(flag: &str, path: &Path, width: usize, limit: MemoryLimit) -> Result<Rows> {
    read(path, width, limit).with_context(|| format!("{flag} {}", path.display()))
}

fn read(path: &Path, width: usize, limit: MemoryLimit) -> Result<Rows> {
    let mut file = BufReader::new(File::open(path)?);
    let text = read_header(&mut file)?;
    let Header {
        descr,
        by_columns,
        shape,
    } = Header::parse(&text)?;
    ensure!(
        shape.len() == 2 && shape[1] == width as u64,
        "an array of shape (N, {width}) is needed, this one has shape {shape:?}"
    );
    ensure!(
        !by_columns,
        "the array is stored column by column; save it with numpy.ascontiguousarray"
    );
    let count = shape[0].saturating_mul(shape[1]);
    limit.admit(format_args!("{count} numbers"), count, size_of::<f64>())?;
    let values = match unquoted(descr) {
        Some("<f8") => numbers(file, count, f64::from_le_bytes)?,
        Some(">f8") => numbers(file, count, f64::from_be_bytes)?,
        Some("<f4") => numbers(file, count, |bytes| f32::from_le_bytes(bytes).into())?,
        Some(">f4") => numbers(file, count, |bytes| f32::from_be_bytes(bytes).into())?,
        _ => bail!("numbers of type float64 or float32 are needed, this array holds {descr}"),
    };
    if let Some(bad) = values.iter().position(|v| !v.is_finite()) {
        bail!(
            "row {}, column {}: {} is not a finite number",
            bad / width,
            bad % width,
            values[bad]
        );
    }
    Ok(Rows {
        // An array of no columns still has a number of rows.
        count: usize::try_from(shape[0])?,
        width,
        values,
    })
}

/// Reads the header text, which describes the numbers.
fn read_header(file: &mut impl Read) -> Result<String> {
    let mut start = [0; MAGIC.len() + 2];
    file.read_exact(&mut start).map_err(header_error)?;
    let (magic, version) = start.split_at(MAGIC.len());
    ensure!(
        magic == MAGIC,
        "the file is not a NumPy array: it does not start with \\x93NUMPY"
    );
    let mut length = [0; 4];
    let digits = match version {
        [1, 0] => &mut length[..2],
        [2 | 3, 0] => &mut length[..],
        _ => bail!(
            "version {}.{} of the format is not supported",
            version[0],
            version[1]
        ),
    };
    file.read_exact(digits).map_err(header_error)?;
    let length = u32::from_le_bytes(length) as usize;
    ensure!(
        length <= MAX_NPY_HEADER,
        "its header is {length} bytes long, and at most {MAX_NPY_HEADER} are read"
    );
    let mut text = vec![0; length];
    file.read_exact(&mut text).map_err(header_error)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Returns the message for an error of reading the header.
fn header_error(error: io::Error) -> anyhow::Error {
    match error.kind() {
        ErrorKind::UnexpectedEof => {
            anyhow!("the file is not a NumPy array: it ends within its header")
        }
        _ => error.into(),
    }
}

/// The header of an array, a Python dictionary literal.
struct Header<'a> {
    /// The type of the numbers as written in the header.
    descr: &'a str,
    /// True for column-major order.
    by_columns: bool,
    shape: Vec<u64>,
}

impl<'a> Header<'a> {
    fn parse(text: &'a str) -> Result<Self> {
        let (mut descr, mut by_columns, mut shape) = (None, None, None);
        let pairs = between(text, '{', '}').context("its header is not a dictionary in braces")?;
        for pair in parts(pairs) {
            let (key, value) = (pair.split_once(':')).with_context(|| {
                format!("its header has {pair} where a key and a value should be")
            })?;
            let value = value.trim();
            match (unquoted(key), value) {
                (Some("descr"), _) => descr = Some(value),
                (Some("fortran_order"), "False") => by_columns = Some(false),
                (Some("fortran_order"), "True") => by_columns = Some(true),
                (Some("shape"), _) => shape = Some(lengths(value)?),
                _ => bail!("its header has the unknown entry {pair}"),
            }
        }
        Ok(Header {
            descr: descr.context("its header lacks the type of the numbers, 'descr'")?,
            by_columns: by_columns.context("its header lacks their order, 'fortran_order'")?,
            shape: shape.context("its header lacks their 'shape'")?,
        })
    }
}

/// Returns the text between two enclosing brackets.
fn between(text: &str, open: char, close: char) -> Option<&str> {
    text.trim().strip_prefix(open)?.strip_suffix(close)
}

fn unquoted(text: &str) -> Option<&str> {
    between(text, '\'', '\'').or_else(|| between(text, '"', '"'))
}

/// Parses the lengths of a shape.
fn lengths(tuple: &str) -> Result<Vec<u64>> {
    let lengths = between(tuple, '(', ')').and_then(|inside| {
        let lengths = parts(inside).into_iter().map(str::parse);
        lengths.collect::<Result<_, _>>().ok()
    });
    lengths.with_context(|| format!("its shape {tuple} is not a tuple of integers"))
}

/// Splits at commas outside of brackets and quotes. The text may end with a comma.
fn parts(text: &str) -> Vec<&str> {
    let (mut parts, mut start) = (Vec::new(), 0);
    let (mut depth, mut quote) = (0_usize, None);
    for (at, c) in text.char_indices() {
        match c {
            _ if quote == Some(c) => quote = None,
            _ if quote.is_some() => {}
            '\'' | '"' => quote = Some(c),
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                parts.push(text[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
    }
    let rest = text[start..].trim();
    parts.extend((!rest.is_empty()).then_some(rest));
    parts
}

/// Reads `count` numbers of a file. Memory grows with the data that is read, not with the size in the header.
fn numbers<const N: usize>(
    mut file: impl Read,
    count: u64,
    number: impl Fn([u8; N]) -> f64,
) -> Result<Vec<f64>> {
    let mut values = Vec::new();
    for found in 0..count {
        let mut bytes = [0; N];
        match file.read_exact(&mut bytes) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                bail!("the file holds {found} numbers, fewer than the {count} of its shape")
            }
            read => read?,
        }
        values.push(number(bytes));
    }
    Ok(values)
}

/// A 64-bit number of an archive's arrays.
pub trait Number: Copy {
    /// The NumPy name of the type.
    const DESCR: &'static str;
    /// Returns the bytes of the number in the file.
    fn to_bytes(self) -> [u8; 8];
}

impl Number for f64 {
    const DESCR: &'static str = "<f8";
    fn to_bytes(self) -> [u8; 8] {
        self.to_le_bytes()
    }
}

impl Number for i64 {
    const DESCR: &'static str = "<i8";
    fn to_bytes(self) -> [u8; 8] {
        self.to_le_bytes()
    }
}

/// An uncompressed zip archive of `.npy` files, which NumPy calls `.npz`.
pub struct Npz(Archive<BufWriter<File>>);

impl Npz {
    /// Creates an empty archive in this empty file.
    pub fn new(file: File) -> Self {
        Npz(Archive::new(BufWriter::new(file)))
    }

    /// Adds an array of this shape. The values are iterated twice.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn array<T: Number>(
        &mut self,
        name: &str,
        shape: &[usize],
        mut values: impl Iterator<Item = T> + Clone,
    ) -> Result<()> {
        /// The number of values that are written together.
        const TOGETHER: usize = 8192;
        let pieces = iter::from_fn(move || {
            let mut piece = Vec::new();
            for value in values.by_ref().take(TOGETHER) {
                piece.extend_from_slice(&value.to_bytes());
            }
            (!piece.is_empty()).then_some(piece)
        });
        let header = header(T::DESCR, shape);
        Ok((self.0).add(&format!("{name}.npy"), iter::once(header).chain(pieces))?)
    }

    /// Finishes the archive.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(self) -> Result<()> {
        Ok(self.0.finish()?)
    }
}

/// Returns the header of a row-major array of this type and shape.
fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    /// The alignment of the numbers, bytes.
    const ALIGNMENT: usize = 64;
    const VERSION: [u8; 2] = [1, 0];
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}");
    let before = MAGIC.len() + VERSION.len() + size_of::<u16>();
    let whole = (before + text.len() + 1).next_multiple_of(ALIGNMENT);
    let length = whole - before;
    // Pad with spaces, and end the line.
    text = format!("{text:<0$}\n", length - 1);
    [
        MAGIC,
        &VERSION,
        &(length as u16).to_le_bytes(),
        text.as_bytes(),
    ]
    .concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read_as_python_reads_them() {
        for (text, descr, by_columns, shape) in [
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }  \n",
                "'<f8'",
                false,
                &[2, 3][..],
            ),
            (
                "{\"shape\":(7,),\"fortran_order\":True,\"descr\":\">f4\"}",
                "\">f4\"",
                true,
                &[7],
            ),
            (
                "{'descr': [('a,}', '<i4', (2,)), ('b', '<f8')], 'fortran_order': False, 'shape': ()}",
                "[('a,}', '<i4', (2,)), ('b', '<f8')]",
                false,
                &[],
            ),
        ] {
            let header = Header::parse(text).unwrap();
            assert_eq!(header.descr, descr);
            assert_eq!(header.by_columns, by_columns);
            assert_eq!(header.shape, shape);
        }
    }

    #[test]
    fn errors_of_a_header_name_the_fault() {
        for (text, complaint) in [
            ("", "not a dictionary"),
            ("{'descr': '<f8'", "not a dictionary"),
            ("{'descr': '<f8', 'shape': (1,)}", "'fortran_order'"),
            ("{'descr': '<f8', 'fortran_order': False}", "'shape'"),
            ("{'fortran_order': False, 'shape': (1,)}", "'descr'"),
            ("{'descr', 'shape': (1,)}", "'descr' where a key"),
            ("{'fortran_order': 1}", "'fortran_order': 1"),
            ("{'order': 'C'}", "'order': 'C'"),
            ("{'shape': 3}", "shape 3 "),
            ("{'shape': (-1,)}", "shape (-1,) "),
            ("{'shape': (1,,2)}", "shape (1,,2) "),
            (
                "{'shape': (18446744073709551616,)}",
                "shape (18446744073709551616,) ",
            ),
        ] {
            let error = Header::parse(text).err().expect(text).to_string();
            assert!(error.contains(complaint), "{text}: {error}");
        }
    }

    #[test]
    fn what_is_written_is_read() {
        for shape in [&[][..], &[5], &[0, 3], &[1000, 10_000, 100_000]] {
            let bytes = header("<i8", shape);
            assert_eq!(bytes.len() % 64, 0);
            let text = read_header(&mut &bytes[..]).unwrap();
            let found = Header::parse(&text).unwrap();
            let shape: Vec<u64> = shape.iter().map(|&length: &usize| length as u64).collect();
            assert_eq!(found.shape, shape);
            assert_eq!((found.descr, found.by_columns), ("'<i8'", false));
        }
    }
}
