//! Functions of `Model` on joint positions: integration and differentiation.

use crate::answer::{answer, each_row};
use crate::arrays::{numbers, require_finite, shape_text, shaped};
use crate::model::Model;
use clench::rigid::dynamics::integrate::{differentiate_positions, integrate_positions};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pymethods]
impl Model {
    /// Integrates positions at a constant velocity, like MuJoCo's ``mj_integratePos``.
    ///
    /// Parameters
    /// ----------
    /// qpos : array_like
    ///     Positions (nq,), or rows of them (k, nq).
    /// qvel : array_like
    ///     Velocities (nv,), or the same number of rows (k, nv).
    /// time : float
    ///     Duration, s.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Positions in the shape of `qpos`, float64.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape is wrong.
    #[pyo3(signature = (qpos, qvel, time = 1.0))]
    fn integrate_pos<'py>(
        &self,
        qpos: &Bound<'py, PyAny>,
        qvel: &Bound<'py, PyAny>,
        time: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.inner();
        require_finite("time", &[time])?;
        let mut rows = shaped_rows("qvel", qvel, qpos, model.nv)?.into_iter();
        each_row("qpos", qpos, model.nq, |row: &mut [f64]| {
            let velocity = rows.next().unwrap_or_default();
            integrate_positions(model, row, &velocity, time);
            Ok(())
        })
    }

    /// Computes the constant velocity that leads from one configuration to another, like MuJoCo's
    /// ``mj_differentiatePos``.
    ///
    /// Parameters
    /// ----------
    /// qpos1, qpos2 : array_like
    ///     Positions before and after (nq,), or rows of them (k, nq).
    /// time : float
    ///     Duration, s; not 0.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Velocities (nv,) or (k, nv), float64.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape is wrong, or `time` is 0.
    #[pyo3(signature = (qpos1, qpos2, time = 1.0))]
    fn differentiate_pos<'py>(
        &self,
        py: Python<'py>,
        qpos1: &Bound<'py, PyAny>,
        qpos2: &Bound<'py, PyAny>,
        time: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.inner();
        require_finite("1 / time", &[1.0 / time])?;
        let before = numbers::<f64>("qpos1", qpos1)?;
        let mut shape = before.shape().to_vec();
        let after = shaped_rows("qpos2", qpos2, qpos1, model.nq)?;
        if shape.pop() != Some(model.nq) || shape.len() > 1 {
            let (found, nq) = (shape_text(before.shape()), model.nq);
            return Err(PyValueError::new_err(format!(
                "qpos1 has shape {found}, but must have ({nq},) or (k, {nq})"
            )));
        }
        shape.push(model.nv);
        let mut all = vec![0.0; shape.iter().product()];
        let rows = all.chunks_exact_mut(model.nv.max(1));
        let from = before.as_slice()?.chunks_exact(model.nq.max(1));
        for ((velocity, from), to) in rows.zip(from).zip(&after) {
            differentiate_positions(model, from, to, time, velocity);
        }
        answer(py, all, &shape, None)
    }
}

/// Converts a value to rows of `width` numbers, as many as another array has.
fn shaped_rows(
    name: &str,
    values: &Bound<'_, PyAny>,
    qpos: &Bound<'_, PyAny>,
    width: usize,
) -> PyResult<Vec<Vec<f64>>> {
    let qpos = numbers::<f64>("qpos", qpos)?;
    let mut shape = qpos.shape().to_vec();
    shape.pop();
    shape.push(width);
    let array = shaped::<f64>(name, values, &shape)?;
    let rows = array.as_slice()?.chunks_exact(width.max(1));
    Ok(rows.map(<[f64]>::to_vec).collect())
}
