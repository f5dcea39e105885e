//! Gradients of functions of a step, from Python.

use crate::arrays::{numbers, require_finite, require_shape};
use crate::changes::{InputGradients, OutputGradients, Results};
use crate::derivatives::{Chosen, in_env, with_linearizer};
use crate::differentiated::{Derivative, Memory, Own};
use crate::error::sim_error;
use crate::row_sim::AnySim;
use crate::signals::Signals;
use clench::derivatives::{
    BatchLinearizer, InputGradient, Matrix, OutputGradient, RolloutGradient,
};
use clench::rigid::batch::Precision;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::slice::from_ref;

/// The gradients by the results: one for each environment.
pub(crate) struct Gradients {
    chosen: Chosen,
    each: Vec<OutputGradient>,
    /// The shape of the results before the dimension of their numbers.
    lead: Vec<usize>,
}

impl Gradients {
    /// Converts gradients of the shape (`lead`, numbers).
    pub(crate) fn new(
        model: &clench::Model,
        outputs: &[String],
        parameters: Option<&Bound<'_, PyAny>>,
        memory: bool,
        [x, y]: OutputGradients<'_, '_>,
        lead: &[usize],
    ) -> PyResult<Self> {
        // Derivatives of sensors take time.
        let sensors = y.is_some();
        let chosen = Chosen::new(model, outputs, parameters, [memory, sensors, false])?;
        let envs = lead.iter().product();
        let read = |name: &str, given: Option<&Bound<'_, PyAny>>, columns: usize| {
            let values = match given {
                Some(given) => {
                    let array = numbers::<f64>(name, given)?;
                    let array = array.as_array();
                    require_shape(name, array.shape(), &[lead, &[columns]].concat())?;
                    Vec::from_iter(array.iter().copied())
                }
                None => vec![0.0; envs * columns],
            };
            require_finite(name, &values)?;
            let row = |env: usize| Matrix {
                shape: [1, columns],
                values: values[env * columns..][..columns].to_vec(),
            };
            Ok::<_, PyErr>(Vec::from_iter((0..envs).map(row)))
        };
        let x = read("x", x, chosen.request.x_len(model))?;
        let y = read("y", y, chosen.request.y_len(model))?;
        let each = x.into_iter().zip(y);
        Ok(Gradients {
            each: each.map(|(x, y)| OutputGradient { x, y }).collect(),
            chosen,
            lead: lead.to_vec(),
        })
    }

    /// Copies results to arrays.
    fn export(&self, py: Python<'_>, results: &[InputGradient]) -> PyResult<InputGradients> {
        let array = |of: &dyn Fn(&InputGradient) -> &[f64]| {
            let mut values = Vec::new();
            for result in results {
                values.extend_from_slice(of(result));
            }
            let columns = results.first().map_or(0, |first| of(first).len());
            let shape = [&self.lead[..], &[columns]].concat();
            Ok::<_, PyErr>(PyArray1::from_vec(py, values).reshape(shape)?.unbind())
        };
        let by_parameters = PyDict::new(py);
        for (name, columns) in self.chosen.columns() {
            let by = array(&|result| &result.p.values[columns.clone()])?;
            by_parameters.set_item(name, by)?;
        }
        Ok((
            array(&|result| &result.x.values)?,
            array(&|result| &result.u.values)?,
            by_parameters.unbind(),
        ))
    }
}

impl Derivative for Gradients {
    type Result = InputGradients;

    fn of_sim(
        &self,
        py: Python<'_>,
        memory: &mut Memory,
        sim: &mut AnySim,
    ) -> PyResult<Self::Result> {
        let result = py.detach(|| {
            with_linearizer(memory, sim, |linearizer, sim| {
                linearizer.vjp(sim, &self.chosen.request, &self.each[0])
            })
        });
        self.export(py, from_ref(result.map_err(sim_error)?))
    }

    fn of_batch<S: Precision>(
        &self,
        py: Python<'_>,
        memory: &mut Own<S>,
        batch: &mut clench::Batch<S>,
    ) -> PyResult<Self::Result> {
        let results = py.detach(|| {
            let linearizer = memory.get_or_insert_with(|| BatchLinearizer::new(batch));
            linearizer.vjp(batch, &self.chosen.request, &self.each)
        });
        self.export(py, results.map_err(|error| in_env(py, error))?)
    }
}

/// The controls of rollouts, and the gradients by their states: a matrix for each environment.
pub(crate) struct Rollouts {
    memory: bool,
    controls: Vec<Matrix>,
    gradients: Vec<Matrix>,
    /// The shape of the results between the dimensions of steps and of numbers.
    envs: Vec<usize>,
}

impl Rollouts {
    /// Converts arrays of the shape (steps, `envs`, numbers).
    pub(crate) fn of_arrays(
        model: &clench::Model,
        ctrl: &Bound<'_, PyAny>,
        x: &Bound<'_, PyAny>,
        memory: bool,
        envs: &[usize],
    ) -> PyResult<Self> {
        let request = Chosen::new(model, &[], None, [memory, false, false])?.request;
        let mut steps = None;
        let mut read = |name: &str, given: &Bound<'_, PyAny>, columns: usize| {
            let array = numbers::<f64>(name, given)?;
            let array = array.as_array();
            let found = array.shape();
            let steps = *steps.get_or_insert(found.first().copied().unwrap_or(0));
            require_shape(name, found, &[&[steps], envs, &[columns]].concat())?;
            let values = Vec::from_iter(array.iter().copied());
            require_finite(name, &values)?;
            let count: usize = envs.iter().product();
            let matrix = |env: usize| {
                let rows = (0..steps).flat_map(|step| {
                    let start = (step * count + env) * columns;
                    &values[start..start + columns]
                });
                Matrix {
                    shape: [steps, columns],
                    values: rows.copied().collect(),
                }
            };
            Ok::<_, PyErr>(Vec::from_iter((0..count).map(matrix)))
        };
        Ok(Rollouts {
            memory,
            controls: read("ctrl", ctrl, model.nu())?,
            gradients: read("x", x, request.x_len(model))?,
            envs: envs.to_vec(),
        })
    }

    /// Copies results to arrays.
    fn export(&self, py: Python<'_>, results: &[RolloutGradient]) -> PyResult<Results> {
        let array = |of: fn(&RolloutGradient) -> &Matrix, lead: &[usize]| {
            let [rows, columns] = results.first().map_or([0, 0], |first| of(first).shape);
            let mut values = Vec::with_capacity(results.len() * rows * columns);
            for row in 0..rows {
                for result in results {
                    values.extend_from_slice(&of(result).values[row * columns..][..columns]);
                }
            }
            let shape = [lead, &self.envs, &[columns]].concat();
            Ok::<_, PyErr>(PyArray1::from_vec(py, values).reshape(shape)?.unbind())
        };
        let steps = self.controls.first().map_or(0, |first| first.shape[0]);
        Ok((
            array(|result| &result.x, &[])?,
            array(|result| &result.u, &[steps])?,
        ))
    }
}

impl Derivative for Rollouts {
    type Result = Results;

    fn of_sim(
        &self,
        py: Python<'_>,
        memory: &mut Memory,
        sim: &mut AnySim,
    ) -> PyResult<Self::Result> {
        let signals = Signals::new();
        let result = py.detach(|| {
            with_linearizer(memory, sim, |linearizer, sim| {
                let (controls, gradient) = (&self.controls[0], &self.gradients[0]);
                linearizer
                    .rollout_vjp_while(sim, self.memory, controls, gradient, &|| signals.none())
            })
        });
        let result = result.map_err(sim_error)?;
        signals.raise()?;
        self.export(py, from_ref(result))
    }

    fn of_batch<S: Precision>(
        &self,
        py: Python<'_>,
        memory: &mut Own<S>,
        batch: &mut clench::Batch<S>,
    ) -> PyResult<Self::Result> {
        let signals = Signals::new();
        let results = py.detach(|| {
            let linearizer = memory.get_or_insert_with(|| BatchLinearizer::new(batch));
            let (controls, gradients) = (&self.controls, &self.gradients);
            linearizer
                .rollout_vjp_while(batch, self.memory, controls, gradients, &|| signals.none())
        });
        let results = results.map_err(|error| in_env(py, error))?;
        signals.raise()?;
        self.export(py, results)
    }
}
