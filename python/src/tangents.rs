//! Directional derivatives of a step, from Python.

use crate::arrays::{numbers, require_finite, require_shape};
use crate::changes::{Changes, Results};
use crate::derivatives::{Variable, in_env, with_linearizer};
use crate::differentiated::{Derivative, Memory, Own};
use crate::error::sim_error;
use crate::row_sim::AnySim;
use clench::Output;
use clench::derivatives::{BatchLinearizer, InputTangent, Matrix, OutputTangent, Request};
use clench::rigid::batch::Precision;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use std::slice::from_ref;

/// The changes of the input: a tangent for each environment.
pub(crate) struct Tangents {
    request: Request,
    each: Vec<InputTangent>,
    /// The shape of the results before and after the dimension of their numbers.
    lead: Vec<usize>,
    trail: Vec<usize>,
}

impl Tangents {
    /// Converts changes of the shape (`lead`, numbers) or (`lead`, numbers, k).
    pub(crate) fn new(
        model: &clench::Model,
        outputs: &[String],
        [x, u, parameters]: Changes<'_, '_>,
        lead: &[usize],
    ) -> PyResult<Self> {
        let outputs = outputs.iter().map(|name| Output::find(name));
        let mut request = Request {
            outputs: outputs.collect::<Result<_, _>>().map_err(sim_error)?,
            ..Request::default()
        };
        let (nx, nu) = (2 * model.nv + model.na, model.nu());
        let mut shape = Shape { lead, trail: None };
        let x = x.map(|x| shape.read("x", x, nx)).transpose()?;
        let u = u.map(|u| shape.read("u", u, nu)).transpose()?;
        let mut fields = Vec::new();
        if let Some(parameters) = parameters {
            for item in parameters.cast::<PyMapping>()?.items()? {
                let (name, values): (String, Bound<'_, PyAny>) = item.extract()?;
                let field = Variable::find(&name)?;
                let count = field.count(model);
                fields.push((field, count, shape.read(&name, &values, count)?));
            }
        }
        // Inputs follow the parameters.
        fields.sort_by_key(|(field, ..)| matches!(field, Variable::Input(_)));
        let trail = shape.trail.unwrap_or_default();
        let columns = trail.iter().product();
        let envs = lead.iter().product();
        let part = |given: &Option<Vec<f64>>, rows: usize, env: usize| Matrix {
            shape: [rows, columns],
            values: match given {
                Some(given) => given[env * rows * columns..][..rows * columns].to_vec(),
                None => vec![0.0; rows * columns],
            },
        };
        let tangent = |env| InputTangent {
            x: part(&x, nx, env),
            u: part(&u, nu, env),
            p: Matrix::default(),
        };
        let mut each = Vec::from_iter((0..envs).map(tangent));
        for (field, count, given) in &fields {
            let row =
                |env: usize, number: usize| &given[(env * count + number) * columns..][..columns];
            for number in 0..*count {
                // A number that stays the same needs no derivatives.
                if (0..envs).all(|env| row(env, number).iter().all(|&x| x == 0.0)) {
                    continue;
                }
                field.request(number, &mut request);
                for (env, tangent) in each.iter_mut().enumerate() {
                    tangent.p.values.extend_from_slice(row(env, number));
                }
            }
        }
        for tangent in &mut each {
            tangent.p.shape = [request.parameters.len() + request.inputs.len(), columns];
        }
        Ok(Tangents {
            request,
            each,
            lead: lead.to_vec(),
            trail,
        })
    }

    /// Copies results to arrays.
    fn export(&self, py: Python<'_>, results: &[OutputTangent]) -> PyResult<Results> {
        let array = |of: fn(&OutputTangent) -> &Matrix| {
            let rows = results.first().map_or(0, |first| of(first).shape[0]);
            let values = results.iter().flat_map(|result| &of(result).values);
            let shape = [&self.lead[..], &[rows], &self.trail].concat();
            let array = PyArray1::from_iter(py, values.copied());
            Ok::<_, PyErr>(array.reshape(shape)?.unbind())
        };
        Ok((array(|result| &result.x)?, array(|result| &result.y)?))
    }
}

impl Derivative for Tangents {
    type Result = Results;

    fn of_sim(
        &self,
        py: Python<'_>,
        memory: &mut Memory,
        sim: &mut AnySim,
    ) -> PyResult<Self::Result> {
        let result = py.detach(|| {
            with_linearizer(memory, sim, |linearizer, sim| {
                linearizer.jvp(sim, &self.request, &self.each[0]).cloned()
            })
        });
        self.export(py, from_ref(&result.map_err(sim_error)?))
    }

    fn of_batch<S: Precision>(
        &self,
        py: Python<'_>,
        memory: &mut Own<S>,
        batch: &mut clench::Batch<S>,
    ) -> PyResult<Self::Result> {
        let results = py.detach(|| {
            let linearizer = memory.get_or_insert_with(|| BatchLinearizer::new(batch));
            linearizer.jvp(batch, &self.request, &self.each)
        });
        self.export(py, results.map_err(|error| in_env(py, error))?)
    }
}

/// The shape that all changes have, except for the number of their numbers.
struct Shape<'a> {
    lead: &'a [usize],
    /// Empty, or the number of columns; none before the first change.
    trail: Option<Vec<usize>>,
}

impl Shape<'_> {
    /// Reads the change of `count` numbers.
    fn read(&mut self, name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
        let array = numbers::<f64>(name, value)?;
        let array = array.as_array();
        let found = array.shape();
        let before = self.lead.len() + 1;
        let trail = (self.trail).get_or_insert_with(|| match found {
            [.., columns] if found.len() == before + 1 => vec![*columns],
            _ => Vec::new(),
        });
        require_shape(name, found, &[self.lead, &[count], trail].concat())?;
        let values = Vec::from_iter(array.iter().copied());
        require_finite(name, &values)?;
        Ok(values)
    }
}
