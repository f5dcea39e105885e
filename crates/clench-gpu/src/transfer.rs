//! Transfers of environment rows: named fields, written and read environment by environment.
//!
//! The device interleaves the environments of a field; the host stores rows. Transfers transpose.

use crate::batch::GpuBatch;
use crate::error::GpuError;
use crate::fields::{Field, Fields};
use crate::precision::GpuReal;
use crate::tables::Tables;
use clench_rigid::{Model, State};
use zerocopy::{FromBytes, IntoBytes};

/// The largest valid position or velocity (MuJoCo's `mjMAXVAL`).
const MAX_VALUE: f64 = 1e10;

impl Tables {
    /// Adds the initial state of a model, field by field.
    pub(crate) fn initial_state(&mut self, model: &Model, fields: &Fields) {
        let state = State::<f64>::new(model);
        let mut row = Vec::new();
        for field in &fields.list {
            match field.name {
                "qpos" => row.extend(&state.qpos),
                "ctrl" => row.extend(&state.ctrl),
                "history" => row.extend(&state.history),
                "plastic" => row.extend(&state.plastic),
                "mocap_pos" => row.extend(state.mocap_pos.iter().flat_map(|v| v.to_array())),
                "mocap_quat" => row.extend(state.mocap_quat.iter().flat_map(|q| q.to_array())),
                "eq_active" => {
                    row.extend(state.eq_active.iter().map(|&on| f64::from(u8::from(on))))
                }
                "tree_asleep" => row.extend(&state.tree_asleep),
                "pose_asleep" => row.extend(&state.pose_asleep),
                _ => row.resize(row.len() + field.width, 0.0),
            }
        }
        self.numbers("INITIAL_STATE", row);
    }
}

impl<S: GpuReal> GpuBatch<S> {
    /// Writes a field of the state of all environments, row after row: `qpos`, `qvel`, `act`, `history`, `plastic`,
    /// `qacc_warmstart`, `stick_references`, `stick_friction`, `ctrl`, `qfrc_applied`, `xfrc_applied` (for each body
    /// the force at its centre of mass, then the torque, world axes), `mocap_pos`, `mocap_quat`, `eq_active` (zero if
    /// an equality is inactive), `tree_asleep`, `pose_asleep` (see [`State`]), `start_time` (the time of the first of
    /// the [`steps`](Self::steps), s, from which clock sensors count); and those of
    /// [`enable_dynamic_constraints`](Self::enable_dynamic_constraints).
    ///
    /// # Errors
    /// Returns an error if no such field exists, the length is wrong, a number is not finite, or a position or velocity
    /// is beyond 1e10.
    pub fn write(&mut self, name: &str, values: &[S]) -> Result<(), GpuError> {
        let field = self.writable(name)?;
        let expected = field.width * self.count;
        check_length(name, values.len(), expected)?;
        if expected == 0 {
            return Ok(());
        }
        for (env, row) in values.chunks_exact(field.width).enumerate() {
            check_row(name, env, row)?;
        }
        self.upload(field, values);
        Ok(())
    }

    /// Writes a state field of all environments, unchecked; the caller must step only environments with valid numbers.
    ///
    /// # Errors
    /// Returns an error if no state field has this name or the length is wrong.
    pub(crate) fn write_unchecked(&mut self, name: &str, values: &[S]) -> Result<(), GpuError> {
        let field = self.writable(name)?;
        check_length(name, values.len(), field.width * self.count)?;
        self.upload(field, values);
        Ok(())
    }

    fn upload(&self, field: Field, values: &[S]) {
        let turned = transpose(values, self.count, field.width);
        let start = (size_of::<S>() * field.offset * self.count) as u64;
        (self.device.queue).write_buffer(&self.arrays.state, start, turned.as_bytes());
    }

    /// Writes a field of the state of one environment.
    ///
    /// # Errors
    /// Same as [`write`](Self::write); also returns an error if the environment does not exist.
    pub fn write_env(&mut self, env: usize, name: &str, row: &[S]) -> Result<(), GpuError> {
        self.check_env(env)?;
        let field = self.writable(name)?;
        check_length(name, row.len(), field.width)?;
        check_row(name, env, row)?;
        for (k, value) in row.iter().enumerate() {
            let start = (size_of::<S>() * ((field.offset + k) * self.count + env)) as u64;
            (self.device.queue).write_buffer(&self.arrays.state, start, value.as_bytes());
        }
        Ok(())
    }

    /// Reads a field of all environments, row after row. A state field (see [`write`](Self::write)) is current; any
    /// other is as the last step or [`forward`](Self::forward) left it. After a step it belongs to the state at its
    /// start (Runge–Kutta: at its last stage). The names are those of [`names`](Self::names).
    ///
    /// # Errors
    /// Returns an error if no field has this name or the device was lost.
    pub fn read(&self, name: &str) -> Result<Vec<S>, GpuError> {
        let found = [
            (&self.state, &self.arrays.state),
            (&self.work, &self.arrays.work),
        ]
        .into_iter()
        .find_map(|(fields, array)| Some((fields.find(name)?, array)));
        let Some((field, array)) = found else {
            return self.read_rows(name);
        };
        let numbers = self.download::<S>(array, field)?;
        Ok(transpose(&numbers, field.width, self.count))
    }

    /// Reads a field of the convex problems. Only the number of rows that [`solves`](Self::solves) returns is valid.
    fn read_rows(&self, name: &str) -> Result<Vec<S>, GpuError> {
        let Some(field) = self.rows.find(name) else {
            return Err(GpuError::Unknown {
                name: name.to_owned(),
                names: self.names().join(", "),
            });
        };
        let bytes = (size_of::<S>() * self.rows.size * self.count) as u64;
        let all = self.device.download(&self.arrays.rows, 0, bytes)?;
        let all = decode::<S>(&all);
        let rows = all.chunks_exact(self.rows.size.max(1));
        let part = field.offset..field.offset + field.width;
        Ok(rows.flat_map(|row| row[part.clone()].to_vec()).collect())
    }

    /// Returns the names of all fields that can be read.
    pub fn names(&self) -> Vec<&'static str> {
        let fields = [&self.state, &self.work, &self.rows];
        let all = fields.into_iter().flat_map(|fields| &fields.list);
        all.map(|field| field.name).collect()
    }

    /// Returns the numbers of a field in each environment.
    pub fn width(&self, name: &str) -> Option<usize> {
        let fields = [&self.state, &self.work, &self.rows];
        let found = fields.into_iter().find_map(|fields| fields.find(name));
        found.map(|field| field.width)
    }

    pub(crate) fn report(&self, name: &str) -> Result<Vec<u32>, GpuError> {
        match self.reports.find(name) {
            Some(field) => self.download(&self.arrays.reports, field),
            None => Ok(Vec::new()),
        }
    }

    fn writable(&self, name: &str) -> Result<Field, GpuError> {
        if let Some(field) = self.state.find(name) {
            return Ok(field);
        }
        if self.width(name).is_some() {
            let field = name.to_owned();
            return Err(GpuError::ReadOnly { field });
        }
        let names = self.state.list.iter().map(|field| field.name);
        Err(GpuError::Unknown {
            name: name.to_owned(),
            names: Vec::from_iter(names).join(", "),
        })
    }

    fn download<E: FromBytes + Copy>(
        &self,
        array: &wgpu::Buffer,
        field: Field,
    ) -> Result<Vec<E>, GpuError> {
        let each = (size_of::<E>() * self.count) as u64;
        let start = field.offset as u64 * each;
        let bytes = self
            .device
            .download(array, start, field.width as u64 * each)?;
        Ok(decode(&bytes))
    }
}

/// Decodes bytes as numbers.
fn decode<E: FromBytes + Copy>(bytes: &[u8]) -> Vec<E> {
    let chunks = bytes.chunks_exact(size_of::<E>());
    chunks
        .filter_map(|chunk| E::read_from_bytes(chunk).ok())
        .collect()
}

/// Transposes `height` rows of `width` numbers in cache-sized blocks.
fn transpose<S: GpuReal>(values: &[S], height: usize, width: usize) -> Vec<S> {
    const BLOCK: usize = 32;
    let mut turned = vec![S::ZERO; height * width];
    for top in (0..height).step_by(BLOCK) {
        for left in (0..width).step_by(BLOCK) {
            for column in left..width.min(left + BLOCK) {
                let bottom = height.min(top + BLOCK);
                let to = &mut turned[column * height..][top..bottom];
                for (row, to) in (top..bottom).zip(to) {
                    *to = values[row * width + column];
                }
            }
        }
    }
    turned
}

fn check_length(field: &str, found: usize, expected: usize) -> Result<(), GpuError> {
    if found == expected {
        return Ok(());
    }
    Err(GpuError::WrongLength {
        field: field.to_owned(),
        found,
        expected,
    })
}

fn check_row<S: GpuReal>(field: &str, env: usize, row: &[S]) -> Result<(), GpuError> {
    let max = match field {
        "qpos" | "qvel" => MAX_VALUE,
        _ => f64::MAX,
    };
    match row
        .iter()
        .position(|x| x.to_f64().is_nan() || x.to_f64().abs() > max)
    {
        None => Ok(()),
        Some(index) => Err(GpuError::NotFinite {
            field: field.to_owned(),
            env,
            index,
            value: row[index].to_f64(),
        }),
    }
}
