//! Exact derivatives of a step.

use crate::batch::{AnyBatch, Batch};
use crate::busy::lock;
use crate::error::sim_error;
use crate::row_sim::AnySim;
use crate::sim::Sim;
use clench::Output;
use clench::derivatives::{self, BatchLinearizer, Linearizer, Matrix, Request};
use clench::rigid::model::ParamField;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping};
use std::ops::Range;
use std::slice::from_ref;

/// The linear model of a step about a state: x⁺ changes by A dx + B du, y by C dx + D du.
///
/// x holds the motion of the positions along the dofs (nv; rotations about the axes of the child, rad), then the
/// velocities (nv) and the activations (na). u holds the controls (nu). y holds the sensors (nsensordata), then the
/// outputs that were asked for, row after row, of the state before the step. The matrices of a batch are stacked, (n,
/// rows, columns).
#[pyclass(frozen, get_all, module = "clench")]
#[allow(non_snake_case)] // Named as in control theory.
pub(crate) struct Linearization {
    /// numpy.ndarray : ∂x⁺/∂x.
    A: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂x⁺/∂u.
    B: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂y/∂x.
    C: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂y/∂u.
    D: Py<PyArrayDyn<f64>>,
    /// dict[str, numpy.ndarray] : ∂x⁺/∂p by parameter, with a column for each of its numbers that was asked for.
    parameters: Py<PyDict>,
    /// dict[str, numpy.ndarray] : ∂y/∂p, likewise.
    output_parameters: Py<PyDict>,
    /// numpy.ndarray : The distance of each constraint row, in the order of `Sim.constraints`, from a change of its state
    /// (a contact that begins to slip, a limit that lets go), where its force has no derivative; m/s² or rad/s²,
    /// infinite for rows that always act. Of a batch, a list of arrays.
    switching: Py<PyAny>,
}

#[pymethods]
impl Sim {
    /// Computes the exact derivatives of the next step, like MuJoCo's ``mjd_transitionFD`` without finite differences.
    ///
    /// Every feature of a step has derivatives: contacts that move, all cones, equalities, actuators, fluids,
    /// integrators, noslip. The derivative of a constraint that switches is that of the active side. Derivatives are
    /// computed in double precision. The state does not change.
    ///
    /// Parameters
    /// ----------
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y; see `clench.OUTPUTS`.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters to differentiate by (see `clench.PARAMETERS`): all numbers, or those at the given indices of the
    ///     flattened field. ``body_subtreemass`` follows ``body_mass``; other derived constants stay the same, as in
    ///     `set_param`.
    ///
    /// Returns
    /// -------
    /// Linearization
    ///     The matrices.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, or a parameter follows from another.
    /// IndexError
    ///     If a parameter does not have a number.
    /// SimulationError
    ///     If `step` would raise it.
    ///
    /// Examples
    /// --------
    /// >>> import clench
    /// >>> sim = clench.Sim(clench.Model.from_xml(
    /// ...     "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/>"
    /// ...     "<geom size='0.1' mass='2'/></body></worldbody>"
    /// ...     "<actuator><motor joint='x'/></actuator></mujoco>"))
    /// >>> sim.linearize().B.tolist()
    /// [[5e-05], [0.005]]
    #[pyo3(signature = (outputs = Vec::new(), parameters = None),
           text_signature = "(outputs=(), parameters=None)")]
    fn linearize(
        &self,
        py: Python<'_>,
        outputs: Vec<String>,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Linearization> {
        let chosen = Chosen::new(self.described(), &outputs, parameters)?;
        let mut linearizer = lock(self.linearizer(), "simulation")?;
        let mut guard = lock(self.inner(), "simulation")?;
        let (memory, sim, request) = (&mut *linearizer, &mut *guard, &chosen.request);
        let result = py.detach(move || {
            let double;
            let sim = match sim {
                AnySim::F64(own) => &*own.current()?,
                AnySim::F32(own) => {
                    double = own.current()?.in_double_precision()?;
                    &double
                }
            };
            let linearizer = match memory {
                Some(linearizer) => linearizer,
                empty => empty.insert(Linearizer::new(sim.model())?),
            };
            linearizer.linearize(sim, request)
        });
        chosen.export(py, from_ref(result.map_err(sim_error)?), &[])
    }
}

#[pymethods]
impl Batch {
    /// Computes the exact derivatives of the next step of every environment; see `Sim.linearize`.
    ///
    /// Parameters
    /// ----------
    /// outputs : sequence of str
    ///     Outputs that follow the sensors in y.
    /// parameters : sequence of str, or mapping of str to sequence of int
    ///     Parameters to differentiate by.
    ///
    /// Returns
    /// -------
    /// Linearization
    ///     The matrices, stacked.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a name is unknown, a parameter follows from another, or the batch has single precision: derivatives are
    ///     computed in double precision.
    /// IndexError
    ///     If a parameter does not have a number.
    /// SimulationError
    ///     If the step of an environment fails.
    #[pyo3(signature = (outputs = Vec::new(), parameters = None),
           text_signature = "(outputs=(), parameters=None)")]
    fn linearize(
        &self,
        py: Python<'_>,
        outputs: Vec<String>,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Linearization> {
        let chosen = Chosen::new(self.described(), &outputs, parameters)?;
        let mut guard = lock(self.inner(), "batch")?;
        let AnyBatch::F64(batch) = &mut *guard else {
            return Err(PyValueError::new_err(
                "derivatives of a batch need double precision: create it with precision=\"64\"",
            ));
        };
        let count = batch.count();
        let mut linearizer = BatchLinearizer::new(batch).map_err(sim_error)?;
        let results = py.detach(|| linearizer.linearize(batch, &chosen.request));
        let results = results.map_err(|(env, error)| {
            let error = sim_error(error);
            let text = format!("environment {env}: {}", error.value(py));
            PyErr::from_type(error.get_type(py), text)
        })?;
        chosen.export(py, results, &[count])
    }
}

/// The chosen outputs and parameters.
struct Chosen {
    request: Request,
    fields: Vec<(ParamField, usize)>,
}

impl Chosen {
    fn new(
        model: &clench::Model,
        outputs: &[String],
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let outputs = outputs.iter().map(|name| Output::find(name));
        let mut chosen = Chosen {
            request: Request {
                outputs: outputs.collect::<Result<_, _>>().map_err(sim_error)?,
                parameters: Vec::new(),
            },
            fields: Vec::new(),
        };
        let Some(parameters) = parameters else {
            return Ok(chosen);
        };
        if let Ok(mapping) = parameters.cast::<PyMapping>() {
            for item in mapping.items()? {
                let (name, numbers): (String, Vec<usize>) = item.extract()?;
                chosen.add(model, &name, Some(numbers))?;
            }
        } else {
            for name in parameters.extract::<Vec<String>>()? {
                chosen.add(model, &name, None)?;
            }
        }
        Ok(chosen)
    }

    /// Adds numbers of a parameter, by default all.
    fn add(
        &mut self,
        model: &clench::Model,
        name: &str,
        numbers: Option<Vec<usize>>,
    ) -> PyResult<()> {
        let field = ParamField::settable(name).map_err(sim_error)?;
        let count = field.shape(model).iter().product();
        let numbers = numbers.unwrap_or_else(|| (0..count).collect());
        if let Some(number) = numbers.iter().find(|&&number| number >= count) {
            return Err(PyIndexError::new_err(format!(
                "{name} has {count} numbers, not one at index {number}"
            )));
        }
        self.fields.push((field, numbers.len()));
        let numbers = numbers.into_iter().map(|number| (field, number));
        self.request.parameters.extend(numbers);
        Ok(())
    }

    /// Copies results to arrays, stacked in the shape `stack`.
    fn export(
        &self,
        py: Python<'_>,
        results: &[derivatives::Linearization],
        stack: &[usize],
    ) -> PyResult<Linearization> {
        let array = |of: fn(&derivatives::Linearization) -> &Matrix,
                     columns: Option<Range<usize>>| {
            let shape = results.first().map_or([0, 0], |first| of(first).shape);
            let columns = columns.unwrap_or(0..shape[1]);
            let rows = results
                .iter()
                .flat_map(|result| of(result).values.chunks_exact(shape[1].max(1)));
            let values = rows.flat_map(|row| &row[columns.clone()]).copied();
            let shape = [stack, &[shape[0], columns.len()]].concat();
            Ok::<_, PyErr>(PyArray1::from_iter(py, values).reshape(shape)?.unbind())
        };
        let (by_state, by_output) = (PyDict::new(py), PyDict::new(py));
        let mut start = 0;
        for &(field, count) in &self.fields {
            let columns = start..start + count;
            by_state.set_item(
                field.name(),
                array(|result| &result.e, Some(columns.clone()))?,
            )?;
            by_output.set_item(field.name(), array(|result| &result.f, Some(columns))?)?;
            start += count;
        }
        let switching = results.iter();
        let mut switching =
            switching.map(|result| PyArray1::from_slice(py, &result.switching).into_any());
        let switching = match stack {
            [] => switching.next().unwrap_or_else(|| py.None().into_bound(py)),
            _ => PyList::new(py, switching)?.into_any(),
        };
        Ok(Linearization {
            A: array(|result| &result.a, None)?,
            B: array(|result| &result.b, None)?,
            C: array(|result| &result.c, None)?,
            D: array(|result| &result.d, None)?,
            parameters: by_state.unbind(),
            output_parameters: by_output.unbind(),
            switching: switching.unbind(),
        })
    }
}
