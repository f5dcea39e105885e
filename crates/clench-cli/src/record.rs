//! NumPy files: controls in, recorded arrays out.

use anyhow::{Result, bail, ensure};
use clench::Sim;
use npyz::{DType, NpyFile, TypeChar, WriterBuilder};
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// An uncompressed zip archive of `.npy` files: what NumPy calls an `.npz`.
type Npz = ZipWriter<BufWriter<File>>;

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
}

/// Reads an (N, `width`) array of finite numbers.
pub fn read_rows(path: &Path, width: usize) -> Result<Rows> {
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

/// Rows of what happened after every K-th step.
pub struct Recorder {
    every: u64,
    rows: u64,
    time: Vec<f64>,
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    ctrl: Vec<f64>,
    contacts: Vec<i64>,
    penetration: Vec<f64>,
    iterations: Vec<i64>,
    gradient: Vec<f64>,
    improvement: Vec<f64>,
    gap: Vec<f64>,
    status: Vec<i64>,
    widths: [u64; 3],
    file: File,
}

impl Recorder {
    /// An empty record that keeps every `every`-th step. The file is made at once: a path that cannot be written should
    /// not cost the user a run.
    pub fn create(path: &Path, sim: &Sim, every: u64) -> Result<Self> {
        let model = sim.model();
        Ok(Recorder {
            every,
            rows: 0,
            time: Vec::new(),
            qpos: Vec::new(),
            qvel: Vec::new(),
            ctrl: Vec::new(),
            contacts: Vec::new(),
            penetration: Vec::new(),
            iterations: Vec::new(),
            gradient: Vec::new(),
            improvement: Vec::new(),
            gap: Vec::new(),
            status: Vec::new(),
            widths: [model.nq, model.nv, model.nu()].map(|n| n as u64),
            file: File::create(path)?,
        })
    }

    /// Appends the state that step number `step` (from 0) led to, and the statistics of its solve.
    pub fn after_step(&mut self, step: usize, sim: &Sim) {
        if !(step as u64 + 1).is_multiple_of(self.every) {
            return;
        }
        self.rows += 1;
        self.time.push(sim.state.time);
        self.qpos.extend(&sim.state.qpos);
        self.qvel.extend(&sim.state.qvel);
        self.ctrl.extend(&sim.state.ctrl);
        let stats = sim.stats();
        self.contacts.push(sim.contacts().len() as i64);
        self.penetration.push(worst_penetration(sim));
        self.iterations.push(stats.iterations as i64);
        self.gradient.push(stats.gradient);
        self.improvement.push(stats.improvement);
        self.gap.push(stats.gap);
        self.status.push(stats.status as i64);
    }

    /// Writes the record as an uncompressed `.npz`.
    ///
    /// Arrays: `time` (n), `qpos` (n, nq), `qvel` (n, nv), `ctrl` (n, nu), `contacts` (n), `penetration` (n, m),
    /// `iterations`, `gradient`, `improvement`, `gap`, `status` (n).
    pub fn write(self) -> Result<()> {
        let mut npz = Npz::new(BufWriter::new(self.file));
        let n = self.rows;
        let [nq, nv, nu] = self.widths;
        array(&mut npz, "time", &[n], &self.time)?;
        array(&mut npz, "qpos", &[n, nq], &self.qpos)?;
        array(&mut npz, "qvel", &[n, nv], &self.qvel)?;
        array(&mut npz, "ctrl", &[n, nu], &self.ctrl)?;
        array(&mut npz, "contacts", &[n], &self.contacts)?;
        array(&mut npz, "penetration", &[n], &self.penetration)?;
        array(&mut npz, "iterations", &[n], &self.iterations)?;
        array(&mut npz, "gradient", &[n], &self.gradient)?;
        array(&mut npz, "improvement", &[n], &self.improvement)?;
        array(&mut npz, "gap", &[n], &self.gap)?;
        array(&mut npz, "status", &[n], &self.status)?;
        npz.finish()?;
        Ok(())
    }
}

/// The deepest penetration among the contacts, m; zero where nothing penetrates.
pub fn worst_penetration(sim: &Sim) -> f64 {
    (sim.contacts().iter()).fold(0.0, |worst, c| f64::max(worst, -c.dist))
}

fn array<T: npyz::AutoSerialize + Copy>(
    npz: &mut Npz,
    name: &str,
    shape: &[u64],
    values: &[T],
) -> Result<()> {
    let options = SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Stored)
        .large_file(true);
    npz.start_file(format!("{name}.npy"), options)?;
    let mut writer = (npyz::WriteOptions::new().default_dtype())
        .shape(shape)
        .writer(&mut *npz)
        .begin_nd()?;
    writer.extend(values.iter().copied())?;
    writer.finish()?;
    Ok(())
}
