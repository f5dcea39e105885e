//! The derivatives of a step, from Python.

use crate::count::Index;
use crate::differentiated::{Derivative, Memory, Own};
use crate::error::sim_error;
use crate::linearization::Linearization;
use crate::row_sim::AnySim;
use clench::derivatives::{
    self, BatchLinearizer, EnvError, ErrorBound, Linearizer, Matrix, Request, StateField,
};
use clench::rigid::batch::Precision;
use clench::rigid::model::ParamField;
use clench::{Output, SimError};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping};
use std::ops::Range;
use std::slice::from_ref;

/// A field by whose numbers a step has derivatives.
#[derive(Clone, Copy)]
pub(crate) enum Variable {
    Parameter(ParamField),
    Input(StateField),
}

impl Variable {
    /// Returns the variable with a name.
    pub(crate) fn find(name: &str) -> PyResult<Self> {
        let mut inputs = StateField::INPUTS.into_iter();
        match inputs.find(|input| input.name() == name) {
            Some(input) => Ok(Variable::Input(input)),
            None => Ok(Variable::Parameter(
                ParamField::settable(name).map_err(sim_error)?,
            )),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Variable::Parameter(field) => field.name(),
            Variable::Input(field) => field.name(),
        }
    }

    /// Returns the number of its numbers.
    pub(crate) fn count(self, model: &clench::Model) -> usize {
        match self {
            Variable::Parameter(field) => field.shape(model).iter().product(),
            Variable::Input(field) => field.count(model),
        }
    }

    /// Adds one of its numbers to a request.
    pub(crate) fn request(self, number: usize, request: &mut Request) {
        match self {
            Variable::Parameter(field) => request.parameters.push((field, number)),
            Variable::Input(field) => request.inputs.push((field, number)),
        }
    }
}

/// The chosen outputs and variables.
pub(crate) struct Chosen {
    pub(crate) request: Request,
    /// The variables, and how many of their numbers are chosen.
    fields: Vec<(Variable, usize)>,
    nv: usize,
}

impl Chosen {
    pub(crate) fn new(
        model: &clench::Model,
        outputs: &[String],
        parameters: Option<&Bound<'_, PyAny>>,
        [memory, sensors, errors]: [bool; 3],
    ) -> PyResult<Self> {
        let outputs = outputs.iter().map(|name| Output::find(name));
        let mut chosen = Chosen {
            request: Request {
                outputs: outputs.collect::<Result<_, _>>().map_err(sim_error)?,
                memory,
                omits_sensors: !sensors,
                errors,
                ..Request::default()
            },
            fields: Vec::new(),
            nv: model.nv,
        };
        let Some(parameters) = parameters else {
            return Ok(chosen);
        };
        if let Ok(mapping) = parameters.cast::<PyMapping>() {
            for item in mapping.items()? {
                let (name, numbers): (String, Vec<Index>) = item.extract()?;
                chosen.add(model, &name, Some(numbers))?;
            }
        } else {
            for name in parameters.extract::<Vec<String>>()? {
                chosen.add(model, &name, None)?;
            }
        }
        Ok(chosen)
    }

    /// Adds numbers of a variable, by default all.
    fn add(
        &mut self,
        model: &clench::Model,
        name: &str,
        numbers: Option<Vec<Index>>,
    ) -> PyResult<()> {
        let field = Variable::find(name)?;
        let count = field.count(model);
        let numbers = numbers.unwrap_or_else(|| (0..count).map(Index).collect());
        if let Some(Index(number)) = numbers.iter().find(|number| number.0 >= count) {
            let place = match *number {
                usize::MAX => "with such an index".to_owned(),
                number => format!("at index {number}"),
            };
            return Err(PyIndexError::new_err(format!(
                "{name} has {count} numbers, not one {place}"
            )));
        }
        self.fields.push((field, numbers.len()));
        for Index(number) in numbers {
            field.request(number, &mut self.request);
        }
        Ok(())
    }

    /// Returns the names of the variables, and the columns of their numbers in p: inputs follow the parameters.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (&'static str, Range<usize>)> {
        let (mut of_parameters, mut of_inputs) = (0, self.request.parameters.len());
        self.fields.iter().map(move |&(field, count)| {
            let start = match field {
                Variable::Parameter(_) => &mut of_parameters,
                Variable::Input(_) => &mut of_inputs,
            };
            let columns = *start..*start + count;
            *start += count;
            (field.name(), columns)
        })
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
            let shape = [stack, &[shape[0], columns.len()]].concat();
            let mut values = Vec::with_capacity(shape.iter().product());
            for matrix in results.iter().map(of) {
                for row in matrix.values.chunks_exact(matrix.shape[1].max(1)) {
                    values.extend_from_slice(&row[columns.clone()]);
                }
            }
            Ok::<_, PyErr>(PyArray1::from_vec(py, values).reshape(shape)?.unbind())
        };
        let (by_state, by_output) = (PyDict::new(py), PyDict::new(py));
        for (name, columns) in self.columns() {
            by_state.set_item(name, array(|result| &result.e, Some(columns.clone()))?)?;
            by_output.set_item(name, array(|result| &result.f, Some(columns))?)?;
        }
        // Numbers of rows, of which environments have different counts.
        let rows = |of: fn(&derivatives::Linearization) -> &[f64]| {
            let rows = results.iter();
            let mut rows = rows.map(|result| PyArray1::from_slice(py, of(result)).into_any());
            Ok::<_, PyErr>(match stack {
                [] => rows.next().unwrap_or_else(|| py.None().into_bound(py)),
                _ => PyList::new(py, rows)?.into_any(),
            })
        };
        // The largest components of vectors whose norms are bounded.
        let bounds = |of: fn(&ErrorBound) -> &[f64], shape: &[usize]| {
            let components = |result: &derivatives::Linearization| {
                let bound = &result.errors;
                let component = |&dof: &f64| of(bound).iter().map(move |norm| dof * norm);
                Vec::from_iter(bound.dofs.iter().flat_map(component))
            };
            let values = results.iter().flat_map(components);
            let shape = [stack, shape].concat();
            Ok::<_, PyErr>(PyArray1::from_iter(py, values).reshape(shape)?.into_any())
        };
        let none = py.None().into_bound(py);
        let (mut qacc_error, mut error, mut reach) = (none.clone(), none.clone(), none);
        if self.request.errors {
            let columns = |result: &derivatives::Linearization| result.errors.directions.len();
            let (nv, columns) = (self.nv, results.first().map_or(0, columns));
            qacc_error = bounds(|bound| std::slice::from_ref(&bound.acceleration), &[nv])?;
            error = bounds(|bound| &bound.directions, &[nv, columns])?;
            reach = rows(|result| &result.errors.reach)?;
        }
        Ok(Linearization {
            A: array(|result| &result.a, None)?,
            B: array(|result| &result.b, None)?,
            C: array(|result| &result.c, None)?,
            D: array(|result| &result.d, None)?,
            parameters: by_state.unbind(),
            output_parameters: by_output.unbind(),
            switching: rows(|result| &result.switching)?.unbind(),
            qacc_error: qacc_error.unbind(),
            error: error.unbind(),
            reach: reach.unbind(),
        })
    }
}

impl Derivative for Chosen {
    type Result = Linearization;

    fn of_sim(
        &self,
        py: Python<'_>,
        memory: &mut Memory,
        sim: &mut AnySim,
    ) -> PyResult<Self::Result> {
        let request = &self.request;
        let result = py.detach(|| {
            with_linearizer(memory, sim, |linearizer, sim| {
                linearizer.linearize(sim, request)
            })
        });
        self.export(py, from_ref(result.map_err(sim_error)?), &[])
    }

    fn of_batch<S: Precision>(
        &self,
        py: Python<'_>,
        memory: &mut Own<S>,
        batch: &mut clench::Batch<S>,
    ) -> PyResult<Self::Result> {
        let count = batch.count();
        let results = py.detach(|| {
            let linearizer = memory.get_or_insert_with(|| BatchLinearizer::new(batch));
            linearizer.linearize(batch, &self.request)
        });
        let results = results.map_err(|error| in_env(py, error))?;
        self.export(py, results, &[count])
    }
}

/// Calls a function with the memory for the derivatives of a simulation and with the simulation in double precision.
pub(crate) fn with_linearizer<'a, R>(
    memory: &'a mut Memory,
    sim: &mut AnySim,
    call: impl FnOnce(&'a mut Linearizer, &clench::Sim<f64>) -> Result<R, SimError>,
) -> Result<R, SimError> {
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
    call(linearizer, sim)
}

/// Returns the error of an environment of a batch.
pub(crate) fn in_env(py: Python<'_>, error: EnvError) -> PyErr {
    let text = error.to_string();
    PyErr::from_type(sim_error(error.error).get_type(py), text)
}
