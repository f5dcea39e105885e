//! `Batch.rollout` in one precision. Shapes are checked before the first step, and recorded arrays are returned without
//! a copy.

use crate::arrays::{numbers, require_shape, shape_text};
use crate::error::sim_error;
use crate::state_views::StateViews;
use crate::view::{Keeper, view};
use clench::{Batch, Controls, Output, Precision};
use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyKeyboardInterrupt, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// A copy of an array.
struct Copied<S> {
    shape: Vec<usize>,
    numbers: Vec<S>,
}

impl<S: Element + Copy> Copied<S> {
    fn of(array: PyReadonlyArrayDyn<'_, S>) -> PyResult<Self> {
        Ok(Copied {
            shape: array.shape().to_vec(),
            numbers: array.as_slice()?.to_vec(),
        })
    }
}

/// Reads the states that environments start from: one row each, or one row for all.
fn initial_rows<S: Precision + Element>(
    values: &Bound<'_, PyAny>,
    n: usize,
    width: usize,
) -> PyResult<Copied<S>> {
    let initial = Copied::of(numbers::<S>("initial", values)?)?;
    if initial.shape != [width] {
        require_shape("initial", &initial.shape, &[n, width])?;
        return Ok(initial);
    }
    Ok(Copied {
        shape: vec![n, width],
        numbers: initial.numbers.repeat(n),
    })
}

/// The initial states of a rollout.
pub(crate) enum Start<'a, 'py> {
    /// The current states.
    Here,
    /// Rows of time, positions, velocities and activations.
    Rows(&'a Bound<'py, PyAny>),
    /// A `clench.State`, which is copied into the arrays of the batch.
    State(&'a StateViews, &'a Bound<'py, PyAny>),
}

/// Implements `Batch.rollout`.
pub(crate) fn rollout<'py, S: Precision + Element>(
    py: Python<'py>,
    batch: &mut Batch<S>,
    start: &Start<'_, 'py>,
    ctrl: Option<&Bound<'py, PyAny>>,
    record: &[String],
    steps: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (n, model) = (batch.count(), Arc::clone(batch.model()));
    // These are copies: other threads may write to the arrays during the steps.
    let ctrl = ctrl
        .map(|values| Copied::of(numbers::<S>("ctrl", values)?))
        .transpose()?;
    let steps = match (&ctrl, steps) {
        (None, None) => return Err(PyValueError::new_err("rollout needs ctrl or steps")),
        (None, Some(steps)) => steps,
        (Some(values), steps) => match values.shape[..] {
            [own, _] | [_, own, _] => steps.unwrap_or(own),
            ref other => {
                let (found, nu) = (shape_text(other), model.nu());
                return Err(PyValueError::new_err(format!(
                    "ctrl has shape {found}, but must have (steps, {nu}) or ({n}, steps, {nu})"
                )));
            }
        },
    };
    let controls = match &ctrl {
        None => Controls::Held,
        Some(values) if values.shape.len() == 2 => {
            require_shape("ctrl", &values.shape, &[steps, model.nu()])?;
            Controls::Shared(&values.numbers)
        }
        Some(values) => {
            require_shape("ctrl", &values.shape, &[n, steps, model.nu()])?;
            Controls::Each(&values.numbers)
        }
    };
    let width = 1 + model.nq + model.nv + model.na;
    let names = Vec::from_iter(record.iter().map(String::as_str));
    let initial = match start {
        Start::Here => None,
        Start::Rows(values) => Some(initial_rows(values, n, width)?),
        Start::State(views, state) => {
            // All other errors of the call are found before the states change.
            names
                .iter()
                .try_for_each(|name| Output::find(name).map(drop))
                .map_err(sim_error)?;
            views.assign_from(state)?;
            (0..n)
                .try_for_each(|env| batch.revive(env))
                .map_err(sim_error)?;
            None
        }
    };
    let start = initial.as_ref().map(|values| &values.numbers[..]);
    let progress = progress.map(Bound::as_unbound);
    let report = |py: Python<'_>, done: usize| {
        progress.map_or(Ok(()), |report| report.call1(py, (done, steps)).map(drop))
    };
    let (mut done, mut stopped) = (steps, Ok(()));
    let recording = py.detach(|| {
        batch.rollout_while(start, steps, controls, &names, |so_far| {
            done = so_far;
            stopped = Python::attach(|py| py.check_signals().and_then(|()| report(py, so_far)));
            stopped.is_ok()
        })
    });
    let recording = recording.map_err(sim_error)?;
    match stopped {
        Ok(()) => report(py, steps)?,
        Err(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => {
            let say = module(py)?.getattr("interrupted")?;
            say.call1((done, steps))?;
        }
        Err(error) => return Err(error),
    }
    let arrays = PyDict::new(py);
    for (output, mut rows) in recording.into_rows() {
        let start = rows.as_mut_ptr();
        let keeper = Keeper::new(py, Arc::new(rows))?;
        let shape = [&[n, steps], &output.shape(&model)[..]].concat();
        // SAFETY: the table has this shape, and `keeper` owns it.
        arrays.set_item(output.name(), unsafe { view(&keeper, start, &shape) }?)?;
    }
    Ok(arrays)
}

/// Returns the module with the Python part of rollouts.
pub(crate) fn module(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("clench._rollout")
}

/// Returns the progress function of a rollout of `n` environments: the given one, a line on stderr for True, or none.
pub(crate) fn progress<'py>(
    wanted: Option<Bound<'py, PyAny>>,
    n: usize,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(wanted) = wanted.filter(|wanted| !wanted.is_none()) else {
        return Ok(None);
    };
    if wanted.is_callable() {
        return Ok(Some(wanted));
    }
    let shown = wanted.extract::<bool>().map_err(|_| {
        PyTypeError::new_err("progress must be a bool or a function of (steps done, steps)")
    })?;
    let line = |py| module(py)?.getattr("Progress")?.call1((n,));
    shown.then(|| line(wanted.py())).transpose()
}
