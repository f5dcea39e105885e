//! Which environments run.

use super::{AnyBatch, Batch};
use crate::busy::lock;
use clench::{EnvStatus, Fault};
use numpy::PyArray1;
use pyo3::prelude::*;

#[pymethods]
impl Batch {
    /// numpy.ndarray : Whether each environment runs (n), and if not why: codes of `EnvStatus`, int8. A copy.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let guard = lock(&self.inner, "batch")?;
        let codes = each!(&*guard, batch => batch.statuses().iter().map(code));
        Ok(PyArray1::from_iter(py, codes))
    }

    /// numpy.ndarray : Which environments run (n), bool. A copy.
    #[getter]
    fn running<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let guard = lock(&self.inner, "batch")?;
        let statuses = each!(&*guard, batch => batch.statuses());
        let runs = statuses.iter().map(|status| *status == EnvStatus::Running);
        Ok(PyArray1::from_iter(py, runs))
    }

    /// numpy.ndarray : How often each environment started over from the initial state (n), with the option `autoreset`, int64. A
    /// copy.
    #[getter]
    fn resets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let guard = lock(&self.inner, "batch")?;
        let resets = each!(&*guard, batch => batch.resets());
        let counts = resets.iter().map(|&count| count as i64);
        Ok(PyArray1::from_iter(py, counts))
    }

    /// Why an environment cannot go on.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     Which environment.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     None if it runs.
    fn fault(&self, env: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        Ok(match each!(&*guard, batch => batch.status(env)) {
            EnvStatus::Running => None,
            EnvStatus::Failed(fault) => Some(fault.to_string()),
        })
    }
}

/// The code of `clench.EnvStatus`.
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
