//! NumPy files: arrays in, archives of arrays out.

use anyhow::{Context, Result, bail, ensure};
use npyz::{DType, NpyFile, TypeChar, WriterBuilder};
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;
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
pub fn read_rows(flag: &str, path: &Path, width: usize) -> Result<Rows> {
    read(path, width).with_context(|| format!("{flag} {}", path.display()))
}

fn read(path: &Path, width: usize) -> Result<Rows> {
    let file = NpyFile::new(BufReader::new(File::open(path)?))?;
    let shape = file.shape().to_vec();
    ensure!(
        shape.len() == 2 && shape[1] == width as u64,
        "an array of shape (N, {width}) is needed, this one has shape {shape:?}"
    );
    ensure!(
        file.order() == npyz::Order::C,
        "the array is stored column by column; save it with numpy.ascontiguousarray"
    );
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

/// All numbers of a file. Room is made as they come, not for what the header promises.
fn numbers<T: npyz::Deserialize + Into<f64>>(file: NpyFile<BufReader<File>>) -> Result<Vec<f64>> {
    let mut values = Vec::new();
    for value in file.data::<T>()? {
        values.push(value?.into());
    }
    Ok(values)
}

/// An uncompressed zip archive of `.npy` files: what NumPy calls an `.npz`.
pub struct Npz(ZipWriter<BufWriter<File>>);

impl Npz {
    /// An empty archive in this file.
    pub fn new(file: File) -> Self {
        Npz(ZipWriter::new(BufWriter::new(file)))
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
        self.0.start_file(format!("{name}.npy"), options)?;
        let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
        let mut writer = (npyz::WriteOptions::new().default_dtype())
            .shape(&shape)
            .writer(&mut self.0)
            .begin_nd()?;
        writer.extend(values)?;
        writer.finish()?;
        Ok(())
    }

    /// Ends the archive.
    pub fn finish(self) -> Result<()> {
        self.0.finish()?;
        Ok(())
    }
}
