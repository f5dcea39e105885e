//! The status of environments.

use super::{AnyBatch, Batch};
use crate::busy::lock;
use clench::{EnvStatus, Fault};
use numpy::PyArray1;
use pyo3::prelude::*;

#[pymethods]
impl Batch {
    /// numpy.ndarray : Status of each environment (n): codes of `EnvStatus`, int8. A copy.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let guard = lock(&self.inner, "batch")?;
        let codes = each!(&*guard, batch => batch.statuses().iter().map(code));
        Ok(PyArray1::from_iter(py, codes))
    }

    /// numpy.ndarray : True for each environment that is running (n), bool. A copy.
    #[getter]
    fn running<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let guard = lock(&self.inner, "batch")?;
        let statuses = each!(&*guard, batch => batch.statuses());
        let runs = statuses.iter().map(|status| *status == EnvStatus::Running);
        Ok(PyArray1::from_iter(py, runs))
    }

    /// numpy.ndarray : Number of restarts of each environment from the initial state (n), with the option `autoreset`,
    /// int64. A copy.
    #[getter]
    fn resets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let guard = lock(&self.inner, "batch")?;
        let resets = each!(&*guard, batch => batch.resets());
        let counts = resets.iter().map(|&count| count as i64);
        Ok(PyArray1::from_iter(py, counts))
    }

    /// Returns the reason why an environment failed.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     The index of the environment.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     None if it runs.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such environment.
    fn fault(&self, env: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        Ok(match each!(&*guard, batch => batch.status(env)) {
            EnvStatus::Running => None,
            EnvStatus::Failed(fault) => Some(fault.to_string()),
        })
    }
}

/// Returns the code of `clench.EnvStatus`.
fn code(status: &EnvStatus) -> i8 {
    match status {
        EnvStatus::Running => 0,
        EnvStatus::Failed(Fault::NotFinite { .. }) => 1,
        EnvStatus::Failed(Fault::Singular { .. }) => 2,
        EnvStatus::Failed(Fault::Diverged { .. }) => 3,
        EnvStatus::Failed(Fault::ContactOverflow { .. }) => 4,
        EnvStatus::Failed(Fault::OverBudget { .. }) => 5,
        EnvStatus::Failed(Fault::Unfinished { .. }) => 6,
    }
}
