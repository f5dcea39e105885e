//! Rows of the state after every K-th step, for an `.npz` file.

use super::summary::worst_penetration;
use crate::limits::MemoryLimit;
use crate::npy::Npz;
use crate::replacement::Replacement;
use anyhow::{Context, Result, ensure};
use clench::math::Scalar;
use clench::rigid::Precision;
use clench::{Batch, Model, Sim};
use std::path::{Path, PathBuf};

/// The outputs of a batch that a record contains in addition to states.
pub(crate) const BATCH_OUTPUTS: [&str; 2] = ["contact_count", "solver_iterations"];

/// The required file name extension of a record.
const EXTENSION: &str = "npz";

/// The options of a record.
pub(crate) struct RecordOptions<'a> {
    /// The path of the file.
    pub path: &'a Path,
    /// The number of steps between rows.
    pub every: usize,
    /// The number of rows of the whole run.
    pub rows: usize,
    /// The memory limit.
    pub limit: MemoryLimit,
}

impl RecordOptions<'_> {
    /// Creates a record of these columns with memory for all rows of `envs` environments, so that an unwritable path or
    /// a lack of memory shows before the run.
    fn begin(&self, envs: usize, batch: bool, columns: Vec<Column>) -> Result<Record> {
        let context = || format!("--record {}", self.path.display());
        ensure!(
            (self.path.extension()).is_some_and(|end| end.eq_ignore_ascii_case(EXTENSION)),
            "--record {}: the name must end in .{EXTENSION} (NumPy arrays) or, for a single environment, .html (a page) or .mcap \
             (messages)",
            self.path.display()
        );
        let file = Replacement::begin(self.path).with_context(context)?;
        let mut record = Record {
            path: self.path.to_path_buf(),
            file,
            every: self.every,
            rows: 0,
            envs,
            batch,
            columns,
        };
        let numbers: usize = record.columns.iter().map(|c| c.envs * c.width()).sum();
        let bytes = numbers * size_of::<f64>();
        let rows = self.rows;
        (self.limit)
            .admit(format_args!("{rows} rows"), rows as u64, bytes)
            .with_context(|| format!("{}: record fewer steps, see --every", context()))?;
        for column in &mut record.columns {
            let capacity = rows * column.envs * column.width();
            (column.values.try_reserve_exact(capacity)).with_context(|| {
                format!(
                    "{}: {rows} rows take more memory than is available",
                    context()
                )
            })?;
        }
        Ok(record)
    }
}

/// A named column of numbers.
struct Column {
    name: &'static str,
    /// The number of values in a row; `None` for a scalar.
    size: Option<usize>,
    /// True if the values are integers.
    whole: bool,
    /// The number of environments with separate values: all, or one for all.
    envs: usize,
    values: Vec<f64>,
}

impl Column {
    fn of_row(name: &'static str, size: usize) -> Self {
        let size = Some(size);
        Column {
            size,
            ..Column::number(name)
        }
    }
    fn number(name: &'static str) -> Self {
        Column {
            name,
            size: None,
            whole: false,
            envs: 1,
            values: Vec::new(),
        }
    }
    fn count(name: &'static str) -> Self {
        let whole = true;
        Column {
            whole,
            ..Column::number(name)
        }
    }
    /// Creates the column of sleep states, if any tree may sleep.
    fn asleep(model: &Model) -> Option<Self> {
        let trees = model.tree_asleep0.len();
        let column = Column {
            whole: true,
            ..Column::of_row("tree_asleep", trees)
        };
        (trees > 0).then_some(column)
    }
    fn of_each(self, envs: usize) -> Self {
        Column { envs, ..self }
    }

    fn width(&self) -> usize {
        self.size.unwrap_or(1)
    }

    /// Iterates over the values, stored step by step, environment by environment, for `rows` steps and `envs`
    /// environments.
    fn by_env(&self, rows: usize, envs: usize) -> impl Iterator<Item = f64> + Clone {
        let width = self.width();
        (0..envs * rows * width).map(move |i| {
            let (row, number) = (i / width, i % width);
            let (env, step) = (row / rows, row % rows);
            self.values[(step * self.envs + env % self.envs) * width + number]
        })
    }
}

/// A record under construction.
struct Record {
    path: PathBuf,
    file: Replacement,
    every: usize,
    rows: usize,
    envs: usize,
    /// True if arrays have an axis of environments.
    batch: bool,
    columns: Vec<Column>,
}

impl Record {
    fn wants(&self, steps: usize) -> bool {
        steps.is_multiple_of(self.every)
    }

    /// Appends a row: the times as the first column, then each of the others.
    fn push<'a, S: Scalar>(&mut self, times: &[f64], others: impl IntoIterator<Item = &'a [S]>) {
        let mut columns = self.columns.iter_mut();
        if let Some(first) = columns.next() {
            first.values.extend_from_slice(times);
        }
        for (column, values) in columns.zip(others) {
            column.values.extend(values.iter().map(|x| x.to_f64()));
        }
        self.rows += 1;
    }

    /// Writes the arrays with axes of environments (if present) and rows, finishes the file, and returns the number of
    /// rows.
    fn write(self) -> Result<usize> {
        let (rows, envs) = (self.rows, self.envs);
        let context = || format!("--record {}", self.path.display());
        let write = || {
            let mut npz = Npz::new(self.file.file()?);
            for column in &self.columns {
                let outer = self.batch.then_some(envs);
                let shape: Vec<usize> =
                    outer.into_iter().chain([rows]).chain(column.size).collect();
                let values = column.by_env(rows, envs);
                if column.whole {
                    npz.array(column.name, &shape, values.map(|x| x as i64))?;
                } else {
                    npz.array(column.name, &shape, values)?;
                }
            }
            npz.finish()
        };
        write().with_context(context)?;
        self.file
            .finish()
            .with_context(|| format!("--record {}", self.path.display()))?;
        Ok(rows)
    }
}

/// The record of one environment.
///
/// Arrays: `time` (n), `qpos` (n, nq), `qvel` (n, nv), `ctrl` (n, nu), `contacts`, `penetration`, `iterations`,
/// `gradient`, `improvement`, `gap`, `status` (n), and where the model may sleep `tree_asleep` (n, ntree).
pub(crate) struct Recorder(Record);

impl Recorder {
    /// Creates an empty record.
    pub(crate) fn create(options: &RecordOptions, model: &Model) -> Result<Self> {
        let mut columns = vec![
            Column::number("time"),
            Column::of_row("qpos", model.nq),
            Column::of_row("qvel", model.nv),
            Column::of_row("ctrl", model.nu()),
            Column::count("contacts"),
            Column::number("penetration"),
            Column::count("iterations"),
            Column::number("gradient"),
            Column::number("improvement"),
            Column::number("gap"),
            Column::count("status"),
        ];
        columns.extend(Column::asleep(model));
        options.begin(1, false, columns).map(Recorder)
    }

    /// Appends the state after `steps` steps, if it is due, and the statistics of the last solve.
    pub(crate) fn after_steps<T: Precision>(&mut self, steps: usize, sim: &Sim<T>) {
        if !self.0.wants(steps) {
            return;
        }
        let widen = |values: &[T]| Vec::from_iter(values.iter().map(|x| x.to_f64()));
        let (state, stats) = (&sim.state, sim.stats());
        let row = [
            widen(&state.qpos),
            widen(&state.qvel),
            widen(&state.ctrl),
            vec![sim.contacts().len() as f64],
            vec![worst_penetration(sim)],
            vec![stats.iterations as f64],
            vec![stats.gradient],
            vec![stats.improvement],
            vec![stats.gap],
            vec![f64::from(stats.status as u8)],
            widen(&state.tree_asleep),
        ];
        self.0.push(&[state.time], row.iter().map(Vec::as_slice));
    }

    /// Writes the record and returns the number of rows.
    pub(crate) fn write(self) -> Result<usize> {
        self.0.write()
    }
}

/// The record of a batch. Values are collected step by step and written environment by environment.
///
/// Arrays: `time` (envs, n), `qpos` (envs, n, nq), `qvel` (envs, n, nv), `ctrl` (envs, n, nu), `contacts`, `iterations`
/// (envs, n), and where the model may sleep `tree_asleep` (envs, n, ntree).
pub(crate) struct BatchRecorder(Record);

impl BatchRecorder {
    /// Creates an empty record.
    pub(crate) fn create(options: &RecordOptions, model: &Model, envs: usize) -> Result<Self> {
        let mut columns = vec![
            Column::number("time").of_each(envs),
            Column::of_row("qpos", model.nq).of_each(envs),
            Column::of_row("qvel", model.nv).of_each(envs),
            // Equal in all environments.
            Column::of_row("ctrl", model.nu()),
            Column::count("contacts").of_each(envs),
            Column::count("iterations").of_each(envs),
        ];
        columns.extend(Column::asleep(model).map(|column| column.of_each(envs)));
        options.begin(envs, true, columns).map(BatchRecorder)
    }

    /// Appends the states after `steps` steps, if they are due, and the outputs of the last step; `ctrl` are its
    /// controls.
    pub(crate) fn after_steps<S: Precision>(&mut self, steps: usize, batch: &Batch<S>, ctrl: &[S]) {
        if !self.0.wants(steps) {
            return;
        }
        let state = &batch.state;
        let states = [&state.qpos, &state.qvel].map(|rows| rows.as_slice());
        let output = |name| batch.output(name).map_or(&[][..], |rows| rows.as_slice());
        let outputs = BATCH_OUTPUTS.map(output);
        let asleep: Vec<S> = (state.tree_asleep.as_slice().iter())
            .map(|&tree| S::new(f64::from(tree)))
            .collect();
        let others = states.into_iter().chain([ctrl]).chain(outputs);
        let others = others.chain([&asleep[..]]);
        self.0.push(state.time.as_slice(), others);
    }

    /// Writes the record and returns the number of rows.
    pub(crate) fn write(self) -> Result<usize> {
        self.0.write()
    }
}
