//! NumPy files: arrays in, archives of arrays out.

use crate::limits::{MAX_NPY_HEADER, MAX_NPY_NESTING, MemoryLimit};
use anyhow::{Context, Result, bail, ensure};
use npyz::{DType, NpyFile, TypeChar, WriterBuilder};
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::rc::Rc;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// An (N, width) array of numbers.
pub struct Rows {
    count: usize,
    width: usize,
    values: Vec<f64>,
}

impl Rows {
    /// N.
    pub fn count(&self) -> usize {
        self.count
    }
    /// Row `k`.
    pub fn row(&self, k: usize) -> &[f64] {
        &self.values[k * self.width..(k + 1) * self.width]
    }
    /// All numbers, row after row.
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
    let header = read_header(&mut file)?;
    let file = NpyFile::new(Cursor::new(header).chain(file))?;
    let shape = file.shape().to_vec();
    ensure!(
        shape.len() == 2 && shape[1] == width as u64,
        "an array of shape (N, {width}) is needed, this one has shape {shape:?}"
    );
    ensure!(
        file.order() == npyz::Order::C,
        "the array is stored column by column; save it with numpy.ascontiguousarray"
    );
    let count = shape[0].saturating_mul(shape[1]);
    limit.admit(format_args!("{count} numbers"), count, size_of::<f64>())?;
    let DType::Plain(kind) = file.dtype() else {
        bail!(
            "an array of plain numbers is needed, this one holds {}",
            file.dtype().descr()
        )
    };
    let values: Vec<f64> = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 8) => numbers::<f64>(file)?,
        (TypeChar::Float, 4) => numbers::<f32>(file)?,
        _ => bail!("numbers of type float64 or float32 are needed, this array holds {kind}"),
    };
    ensure!(
        shape[0].checked_mul(shape[1]) == Some(values.len() as u64),
        "the file does not hold as many numbers as its shape {shape:?} says"
    );
    if let Some(bad) = values.iter().position(|v| !v.is_finite()) {
        bail!(
            "row {}, column {}: {} is not a finite number",
            bad / width,
            bad % width,
            values[bad]
        );
    }
    Ok(Rows {
        // An array of no columns still has its number of rows.
        count: usize::try_from(shape[0])?,
        width,
        values,
    })
}

/// The bytes before the numbers, if they are few and simple enough to be read on.
fn read_header(file: &mut impl Read) -> Result<Vec<u8>> {
    /// Magic string and version; the length of the text follows in two bytes, from version 2 on in four.
    const START: usize = 8;
    let mut header = vec![0; START];
    let cut = "the file is no NumPy array: it ends before its header does";
    file.read_exact(&mut header).context(cut)?;
    ensure!(
        header.starts_with(b"\x93NUMPY"),
        "the file is no NumPy array: its first bytes are others"
    );
    let wide = header[6] > 1;
    let mut length = [0; 4];
    let digits = &mut length[..if wide { 4 } else { 2 }];
    file.read_exact(digits).context(cut)?;
    header.extend_from_slice(digits);
    let length = u32::from_le_bytes(length) as usize;
    ensure!(
        length <= MAX_NPY_HEADER,
        "its header is {length} bytes long, and at most {MAX_NPY_HEADER} are read"
    );
    let mut text = vec![0; length];
    file.read_exact(&mut text).context(cut)?;
    let mut depth = 0_usize;
    for &byte in &text {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        ensure!(
            depth <= MAX_NPY_NESTING,
            "its header has brackets within each other more than {MAX_NPY_NESTING} deep"
        );
    }
    header.append(&mut text);
    Ok(header)
}

/// All numbers of a file. Room is made as they come, not for what the header promises.
fn numbers<T: npyz::Deserialize + Into<f64>>(file: NpyFile<impl Read>) -> Result<Vec<f64>> {
    let mut values = Vec::new();
    for value in file.data::<T>()? {
        values.push(value?.into());
    }
    Ok(values)
}

/// Where an archive goes, up to the first error. That one is kept, and what comes later is dropped: a `ZipWriter` that is let
/// go writes what is still missing, and prints if it cannot.
struct Sink {
    file: BufWriter<File>,
    error: Rc<RefCell<Option<io::Error>>>,
    /// Where it would stand without the error.
    position: u64,
    end: u64,
}

impl Sink {
    /// Does something with the file, if nothing went wrong yet.
    fn attempt<R>(&mut self, work: impl FnOnce(&mut BufWriter<File>) -> io::Result<R>) {
        let mut error = self.error.borrow_mut();
        if error.is_none() {
            *error = work(&mut self.file).err();
        }
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.attempt(|file| file.write_all(bytes));
        self.position += bytes.len() as u64;
        self.end = self.end.max(self.position);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        self.attempt(|file| file.flush());
        Ok(())
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(offset) => self.position.checked_add_signed(offset),
            SeekFrom::End(offset) => self.end.checked_add_signed(offset),
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        let position = SeekFrom::Start(self.position);
        self.attempt(|file| file.seek(position));
        Ok(self.position)
    }
}

/// An uncompressed zip archive of `.npy` files: what NumPy calls an `.npz`.
pub struct Npz {
    zip: ZipWriter<Sink>,
    error: Rc<RefCell<Option<io::Error>>>,
}

impl Npz {
    /// An empty archive in this file, which is empty too.
    pub fn new(file: File) -> Self {
        let error = Rc::default();
        let sink = Sink {
            file: BufWriter::new(file),
            error: Rc::clone(&error),
            position: 0,
            end: 0,
        };
        Npz {
            zip: ZipWriter::new(sink),
            error,
        }
    }

    /// The first error that writing met.
    fn check(&self) -> Result<()> {
        let Some(error) = self.error.take() else {
            return Ok(());
        };
        // What is still to come is dropped as before.
        self.error.replace(Some(error.kind().into()));
        Err(error.into())
    }

    /// Adds an array of this shape.
    pub fn array<T: npyz::AutoSerialize>(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = T>,
    ) -> Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored)
            .large_file(true);
        self.zip.start_file(format!("{name}.npy"), options)?;
        let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
        let mut writer = (npyz::WriteOptions::new().default_dtype())
            .shape(&shape)
            .writer(&mut self.zip)
            .begin_nd()?;
        writer.extend(values)?;
        writer.finish()?;
        self.check()
    }

    /// Ends the archive.
    pub fn finish(self) -> Result<()> {
        let Npz { zip, error } = self;
        zip.finish()?.flush()?;
        error.take().map_or(Ok(()), |error| Err(error.into()))
    }
}
