//! Outputs that a batch records.

use super::Batch;
use crate::error::sim_error;
use crate::recorded::not_recorded;
use crate::sim::sensor_numbers;
use clench::Output;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PySlice, PyTuple};

#[pymethods]
impl Batch {
    /// Keeps outputs from now on, beside those that are kept already.
    ///
    /// They are computed at once. Every step and forward leaves them as of its last forward pass, as MuJoCo leaves its fields: those
    /// that follow from positions are of the start of the last time step (with the Runge-Kutta integrator, of its last stage).
    /// Where positions, velocities, mocap poses or parameters of an environment were written since, asking for an output by
    /// name (`output`, ``batch.xpos``) computes that environment's anew. Rows of environments that do not run stay as they are.
    ///
    /// Parameters
    /// ----------
    /// *names : str
    ///     Names of outputs, see `clench.OUTPUTS`.
    #[pyo3(signature = (*names))]
    fn record(&self, py: Python<'_>, names: Vec<String>) -> PyResult<()> {
        self.keep(py, &names)
    }

    /// tuple of str : The outputs that are recorded.
    #[getter]
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let outputs = self.recorded.outputs()?;
        PyTuple::new(py, outputs.iter().map(|output| output.name()))
    }

    /// A recorded output.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A live view that cannot be written, with environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An output that is not recorded.
    fn output(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let output = Output::find(name).map_err(sim_error)?;
        let view = self.fresh(py, output)?;
        view.ok_or_else(|| PyValueError::new_err(not_recorded(name)))
    }

    /// What one sensor measured in every environment: its part of `sensordata`, which must be recorded.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     Its name or index.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A live view that cannot be written, with environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A name that no sensor has, or `sensordata` is not recorded.
    /// IndexError
    ///     A number that is negative or too large.
    fn sensor<'py>(
        &self,
        py: Python<'py>,
        which: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let numbers = sensor_numbers(py, self.model.get().inner(), which)?;
        let all = self.output(py, "sensordata")?.into_bound(py);
        all.get_item((PySlice::full(py), numbers))
    }
}
