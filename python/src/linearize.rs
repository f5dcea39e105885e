//! Exact derivatives of a step.

use crate::busy::lock;
use crate::error::sim_error;
use crate::row_sim::AnySim;
use crate::sim::Sim;
use clench::Output;
use clench::derivatives::{Linearizer, Matrix, Request};
use clench::rigid::model::ParamField;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

/// The linear model of a step about a state: x⁺ changes by A dx + B du, y by C dx + D du.
///
/// x holds the motion of the positions along the dofs (nv; rotations about the axes of the child, rad), then the
/// velocities (nv) and the activations (na). u holds the controls (nu). y holds the sensors (nsensordata), then the
/// outputs that were asked for, row after row, of the state before the step.
#[pyclass(frozen, get_all, module = "clench")]
#[allow(non_snake_case)] // Named as in control theory.
pub(crate) struct Linearization {
    /// numpy.ndarray : ∂x⁺/∂x.
    A: Py<PyArray2<f64>>,
    /// numpy.ndarray : ∂x⁺/∂u.
    B: Py<PyArray2<f64>>,
    /// numpy.ndarray : ∂y/∂x.
    C: Py<PyArray2<f64>>,
    /// numpy.ndarray : ∂y/∂u.
    D: Py<PyArray2<f64>>,
    /// dict[str, numpy.ndarray] : ∂x⁺/∂p by parameter, with a column for each of its numbers that was asked for.
    parameters: Py<PyDict>,
    /// dict[str, numpy.ndarray] : ∂y/∂p, likewise.
    output_parameters: Py<PyDict>,
}

#[pymethods]
impl Sim {
    /// Computes the exact derivatives of the next step, like MuJoCo's ``mjd_transitionFD`` without finite differences.
    ///
    /// Every feature of a step has derivatives: contacts that move, all cones, equalities, actuators, fluids,
    /// integrators, noslip. Where a constraint switches, the derivative is that of the active side. The state does not
    /// change.
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
    ///     If a name is unknown, a parameter follows from another, or the simulation has single precision.
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
    #[pyo3(signature = (outputs = Vec::new(), parameters = None))]
    fn linearize(
        &self,
        py: Python<'_>,
        outputs: Vec<String>,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Linearization> {
        let outputs = outputs.iter().map(|name| Output::find(name));
        let outputs = outputs.collect::<Result<_, _>>().map_err(sim_error)?;
        let fields = self.chosen_numbers(parameters)?;
        let parameters = fields.iter().flat_map(|(field, numbers)| {
            let field = *field;
            numbers.iter().map(move |&number| (field, number))
        });
        let request = Request {
            outputs,
            parameters: parameters.collect(),
        };
        let mut linearizer = lock(self.linearizer(), "simulation")?;
        let mut guard = lock(self.inner(), "simulation")?;
        let AnySim::F64(own) = &mut *guard else {
            return Err(PyValueError::new_err(
                "derivatives need a simulation in double precision: create it with precision=\"64\"",
            ));
        };
        let sim = own.current().map_err(sim_error)?;
        let linearizer = match &mut *linearizer {
            Some(linearizer) => linearizer,
            empty => empty.insert(Linearizer::new(sim.model()).map_err(sim_error)?),
        };
        let result = py.detach(|| linearizer.linearize(sim, &request));
        let result = result.map_err(sim_error)?;
        let matrix = |matrix: &Matrix| array(py, matrix, 0..matrix.shape[1]);
        let (by_state, by_output) = (PyDict::new(py), PyDict::new(py));
        let mut start = 0;
        for (field, numbers) in &fields {
            let columns = start..start + numbers.len();
            by_state.set_item(field.name(), array(py, &result.e, columns.clone())?)?;
            by_output.set_item(field.name(), array(py, &result.f, columns.clone())?)?;
            start = columns.end;
        }
        Ok(Linearization {
            A: matrix(&result.a)?,
            B: matrix(&result.b)?,
            C: matrix(&result.c)?,
            D: matrix(&result.d)?,
            parameters: by_state.unbind(),
            output_parameters: by_output.unbind(),
        })
    }
}

impl Sim {
    /// Returns the parameters to differentiate by, and their numbers.
    fn chosen_numbers(
        &self,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<(ParamField, Vec<usize>)>> {
        let Some(parameters) = parameters else {
            return Ok(Vec::new());
        };
        let find = |name: &str| -> PyResult<(ParamField, usize)> {
            let field = ParamField::settable(name).map_err(sim_error)?;
            Ok((field, field.shape(self.described()).iter().product()))
        };
        let mut fields = Vec::new();
        if let Ok(mapping) = parameters.cast::<PyMapping>() {
            for item in mapping.items()? {
                let (name, numbers): (String, Vec<usize>) = item.extract()?;
                let (field, count) = find(&name)?;
                if let Some(number) = numbers.iter().find(|&&number| number >= count) {
                    return Err(PyIndexError::new_err(format!(
                        "{name} has {count} numbers, not one at index {number}"
                    )));
                }
                fields.push((field, numbers));
            }
        } else {
            for name in parameters.extract::<Vec<String>>()? {
                let (field, count) = find(&name)?;
                fields.push((field, (0..count).collect()));
            }
        }
        Ok(fields)
    }
}

/// Copies columns of a matrix.
fn array(
    py: Python<'_>,
    matrix: &Matrix,
    columns: std::ops::Range<usize>,
) -> PyResult<Py<PyArray2<f64>>> {
    let rows = matrix.values.chunks_exact(matrix.shape[1].max(1));
    let values = rows.flat_map(|row| &row[columns.clone()]).copied();
    let array = PyArray1::from_iter(py, values);
    Ok(array.reshape([matrix.shape[0], columns.len()])?.unbind())
}
