//! Constraints that are added at run time in environments of a batch.

use super::{AnyBatch, Batch};
use crate::arrays::{indices, numbers, require_shape};
use crate::busy::lock;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::vector;
use clench::DynamicConstraint;
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

impl Batch {
    /// Returns the given environment indices, or all if there are none.
    pub(crate) fn chosen(&self, envs: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<usize>> {
        match envs {
            Some(envs) => indices("envs", envs, self.n_envs),
            None => Ok(Vec::from_iter(0..self.n_envs)),
        }
    }

    fn body_index(&self, which: &Bound<'_, PyAny>) -> PyResult<usize> {
        Kind::Body.find(self.model.get().inner(), which)
    }
}

/// Converts constraints to integer codes.
fn codes<'py>(py: Python<'py>, added: Vec<DynamicConstraint>) -> Bound<'py, PyArray1<i64>> {
    let codes = added.into_iter();
    PyArray1::from_iter(py, codes.map(|added| added.to_code().cast_signed()))
}

#[pymethods]
impl Batch {
    /// Welds two bodies in their current relative pose, in some environments; see `Sim.add_weld`.
    ///
    /// Parameters
    /// ----------
    /// body1, body2 : str or int
    ///     The bodies, by name or index.
    /// envs : array_like of int, optional
    ///     Indices of environments; by default all.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The constraint in each of these environments, in their order, as codes for `remove`, int64.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As for `Sim.add_weld`. The states do not change then.
    #[pyo3(signature = (body1, body2, envs = None))]
    fn add_weld<'py>(
        &self,
        py: Python<'py>,
        body1: &Bound<'py, PyAny>,
        body2: &Bound<'py, PyAny>,
        envs: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let (body1, body2) = (self.body_index(body1)?, self.body_index(body2)?);
        let envs = self.chosen(envs)?;
        let mut guard = lock(&self.inner, "batch")?;
        let added = each!(&mut *guard, batch => batch.add_weld(&envs, body1, body2));
        Ok(codes(py, added.map_err(sim_error)?))
    }

    /// Connects two bodies at a point in some environments; see `Sim.add_connect`.
    ///
    /// Parameters
    /// ----------
    /// body1, body2 : str or int
    ///     The bodies, by name or index.
    /// anchor : array_like
    ///     A point in the frame of the first body (3), m.
    /// envs : array_like of int, optional
    ///     Indices of environments; by default all.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The constraint in each of these environments, in their order, as codes for `remove`, int64.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As for `Sim.add_connect`. The states do not change then.
    #[pyo3(signature = (body1, body2, anchor, envs = None))]
    fn add_connect<'py>(
        &self,
        py: Python<'py>,
        body1: &Bound<'py, PyAny>,
        body2: &Bound<'py, PyAny>,
        anchor: &Bound<'py, PyAny>,
        envs: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let (body1, body2) = (self.body_index(body1)?, self.body_index(body2)?);
        let envs = self.chosen(envs)?;
        let mut guard = lock(&self.inner, "batch")?;
        let added = each!(&mut *guard, batch => {
            let anchor = vector("anchor", anchor)?;
            batch.add_connect(&envs, body1, body2, anchor)
        });
        Ok(codes(py, added.map_err(sim_error)?))
    }

    /// Removes constraints that `add_weld` or `add_connect` added, in some environments.
    ///
    /// Parameters
    /// ----------
    /// constraints : array_like of int
    ///     The codes that they returned, one for each of the environments.
    /// envs : array_like of int, optional
    ///     Indices of environments; by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a constraint does not exist. The states do not change then.
    #[pyo3(signature = (constraints, envs = None))]
    fn remove(
        &self,
        constraints: &Bound<'_, PyAny>,
        envs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let envs = self.chosen(envs)?;
        let codes = numbers::<i64>("constraints", constraints)?;
        require_shape("constraints", codes.shape(), &[envs.len()])?;
        let constraints = codes.as_slice()?.iter();
        let constraints: Vec<_> = constraints
            .map(|code| DynamicConstraint::from_code(code.cast_unsigned()))
            .collect();
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => batch.remove(&envs, &constraints)).map_err(sim_error)
    }

    /// Makes a weld or connect of the model hold its bodies in their current relative pose, in some environments; see
    /// `Sim.weld_here`.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The equality, by name or index.
    /// envs : array_like of int, optional
    ///     Indices of environments; by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the equality is of another kind.
    #[pyo3(signature = (which, envs = None))]
    fn weld_here(&self, which: &Bound<'_, PyAny>, envs: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let equality = Kind::Equality.find(self.model.get().inner(), which)?;
        let envs = self.chosen(envs)?;
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => batch.weld_here(&envs, equality)).map_err(sim_error)
    }

    /// list of int : The serial number of the last constraint that was added at run time in each environment, for
    /// pickles; see `clench._pickle`.
    #[getter(_last_serials)]
    fn last_serials(&self) -> PyResult<Vec<u32>> {
        let guard = lock(&self.inner, "batch")?;
        Ok(each!(&*guard, batch => batch.last_serials().to_vec()))
    }

    #[setter(_last_serials)]
    fn set_last_serials(&self, serials: Vec<u32>) -> PyResult<()> {
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => batch.set_last_serials(&serials)).map_err(sim_error)
    }
}
