//! Outputs that a batch records.

use super::{AnyBatch, Batch};
use crate::arrays::numbers;
use crate::busy::lock;
use crate::error::sim_error;
use crate::recorded::not_recorded;
use crate::sim::sensor_numbers;
use clench::Output;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PySlice, PyTuple};
use std::collections::HashMap;

#[pymethods]
impl Batch {
    /// Records outputs from now on, in addition to those that are recorded already.
    ///
    /// They are computed immediately. Every step and forward leaves them as of its last forward pass, like MuJoCo's
    /// fields: those that depend on positions are of the start of the last time step (with the Runge-Kutta integrator,
    /// of its last stage). If positions, velocities, mocap poses or parameters of an environment were written since,
    /// reading an output by name (`output`, ``batch.xpos``) recomputes that environment's values. Rows of environments
    /// that are not running do not change.
    ///
    /// Parameters
    /// ----------
    /// *names : str
    ///     Names of outputs, see `clench.OUTPUTS`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no output has a name.
    #[pyo3(signature = (*names))]
    fn record(&self, py: Python<'_>, names: Vec<String>) -> PyResult<()> {
        self.record_outputs(py, &names)
    }

    /// tuple of str : The outputs that are recorded.
    #[getter]
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let outputs = self.recorded.outputs()?;
        PyTuple::new(py, outputs.iter().map(|output| output.name()))
    }

    /// Returns a recorded output.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     The name of the output.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A live read-only view, with environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the output is not recorded.
    fn output(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let output = Output::find(name).map_err(sim_error)?;
        let view = self.current_view(py, output)?;
        view.ok_or_else(|| PyValueError::new_err(not_recorded(name)))
    }

    /// Returns the values of one sensor in every environment: its part of `sensordata`, which must be recorded.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The name or index of the sensor.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A live read-only view, with environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no sensor has the name, or `sensordata` is not recorded.
    /// IndexError
    ///     If the index is negative or too large.
    fn sensor<'py>(
        &self,
        py: Python<'py>,
        which: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let numbers = sensor_numbers(py, self.model.get().inner(), which)?;
        let all = self.output(py, "sensordata")?.into_bound(py);
        all.get_item((PySlice::full(py), numbers))
    }

    /// Replaces all recorded outputs by those of a batch with the same states, for pickles; see `clench._pickle`.
    fn _restore_outputs(&self, outputs: HashMap<String, Bound<'_, PyAny>>) -> PyResult<()> {
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => {
            let values = outputs.iter().map(|(name, values)| {
                let values = numbers(name, values)?.as_slice()?.to_vec();
                Ok((name.as_str(), values))
            });
            let values = values.collect::<PyResult<Vec<_>>>()?;
            batch.restore_outputs(&values).map_err(sim_error)
        })
    }
}
