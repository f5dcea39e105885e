//! `clench.Block`.

use crate::arrays::{numbers, require_finite, require_shape, shape_text};
use crate::names::unknown;
use clench::solver::{Cost, PlainBlock};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// One constraint of a bare convex problem: the cost of a value of ``y = jacobian @ qacc - aref``.
///
/// Parameters
/// ----------
/// cost : {"quadratic", "one_sided", "huber", "pyramid", "elliptic"}
///     With ``D = 1 / R``: "quadratic" is ``D y**2 / 2`` always (an equality); "one_sided" is the same where ``y < 0``
///     (a limit, a contact without friction); "huber" is the same as long as the force is below `shape`, and linear
///     beyond (dry friction); "pyramid" is one-sided on each edge ``y[0] +- shape[j] y[j]`` (a contact with friction);
///     "elliptic" is the exact friction cone as MuJoCo defines it.
/// jacobian : array_like, (dim, nv), or (nv,) for one row
///     The derivatives of the rows' velocities by those of the dofs; 1 to 6 rows. The first row of a contact is its
///     normal.
/// aref : array_like, (dim,), or a number for all rows
///     The acceleration along each row that the constraint demands.
/// R : array_like, (dim,), or a number for all rows
///     The softness of each row, positive. All rows of a pyramid have the same R; those of an elliptic cone have ``R[j]
///     = R[0] (shape[0] / shape[j])**2``.
/// shape : array_like, (dim,), or a number for all rows, optional
///     For "huber" the greatest force of each row. For "pyramid" the friction coefficient of each row; the first is
///     unused. For "elliptic" the same, but the first is the regularized coefficient ``shape[1] * sqrt(R[1] / R[0])``.
///     The other costs have no shape.
///
/// Raises
/// ------
/// ValueError
///     If a shape does not fit, a number is not finite, or an R is not positive.
///
/// Examples
/// --------
/// >>> clench.Block("one_sided", [1.0, 0.0], aref=0.0, R=1e-3)
/// Block(cost='one_sided', dim=1, nv=2)
#[pyclass(frozen, module = "clench")]
pub(crate) struct Block {
    name: &'static str,
    plain: PlainBlock<f64>,
    nv: usize,
}

impl Block {
    /// Returns its numbers.
    pub(crate) fn plain(&self) -> &PlainBlock<f64> {
        &self.plain
    }

    /// Returns the number of degrees of freedom of its problem.
    pub(crate) fn nv(&self) -> usize {
        self.nv
    }
}

#[pymethods]
impl Block {
    #[new]
    #[pyo3(signature = (cost, jacobian, aref, R, shape=None))]
    #[allow(non_snake_case)] // R, as in the formulas.
    fn new(
        cost: &str,
        jacobian: &Bound<'_, PyAny>,
        aref: &Bound<'_, PyAny>,
        R: &Bound<'_, PyAny>,
        shape: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let named = |&kind: &Cost| name(kind).map(|name| (name, kind));
        let (names, kinds): (Vec<&str>, Vec<Cost>) = Cost::ALL.iter().filter_map(named).unzip();
        let Some(found) = names.iter().position(|&name| name == cost) else {
            return Err(unknown("cost", cost, &names));
        };
        let (name, kind) = (names[found], kinds[found]);
        let (jacobian, dim, nv) = matrix(jacobian)?;
        let r = rows("R", R, dim)?;
        if let Some(&refused) = r.iter().find(|&&r| !(r > 0.0 && (1.0 / r).is_finite())) {
            let text = format!("R has {refused:e}, but must be positive, its inverse finite");
            return Err(PyValueError::new_err(text));
        }
        let shape = match shape {
            Some(shape) if kind.has_shape() => rows("shape", shape, dim)?,
            None if !kind.has_shape() => Vec::new(),
            Some(_) => return Err(PyValueError::new_err(format!("a {cost} cost has no shape"))),
            None => {
                return Err(PyValueError::new_err(format!(
                    "a cost of kind \"{cost}\" needs a shape"
                )));
            }
        };
        let plain = PlainBlock {
            cost: kind,
            jacobian,
            aref: rows("aref", aref, dim)?,
            r,
            shape,
        };
        Ok(Block { name, plain, nv })
    }

    /// str : The kind of cost.
    #[getter]
    fn cost(&self) -> &'static str {
        self.name
    }

    /// int : Number of rows.
    #[getter]
    fn dim(&self) -> usize {
        self.plain.aref.len()
    }

    /// numpy.ndarray : The Jacobian of the rows (dim, nv). A copy.
    #[getter]
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_slice(py, &self.plain.jacobian).reshape([self.dim(), self.nv])
    }

    /// numpy.ndarray : The acceleration along each row that the constraint demands (dim). A copy.
    #[getter]
    fn aref<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.plain.aref)
    }

    /// numpy.ndarray : Softness of each row (dim). A copy.
    #[getter(R)]
    fn r<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.plain.r)
    }

    /// numpy.ndarray or None : Greatest forces or friction coefficients (dim); None if the cost has none. A copy.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let shape = &self.plain.shape;
        (!shape.is_empty()).then(|| PyArray1::from_slice(py, shape))
    }

    fn __repr__(&self) -> String {
        format!(
            "Block(cost='{}', dim={}, nv={})",
            self.cost(),
            self.dim(),
            self.nv
        )
    }
}

/// Returns the name of a cost; `None` for Coulomb's law, whose problem is not convex.
fn name(cost: Cost) -> Option<&'static str> {
    match cost {
        Cost::Quadratic => Some("quadratic"),
        Cost::OneSided => Some("one_sided"),
        Cost::Huber => Some("huber"),
        Cost::Pyramid => Some("pyramid"),
        Cost::Elliptic => Some("elliptic"),
        Cost::Coulomb => None,
    }
}

/// Returns the rows of a Jacobian in sequence, their number and their length.
fn matrix(value: &Bound<'_, PyAny>) -> PyResult<(Vec<f64>, usize, usize)> {
    let array = numbers::<f64>("jacobian", value)?;
    let (dim, nv) = match *array.shape() {
        [nv] => (1, nv),
        [dim, nv] => (dim, nv),
        ref other => {
            return Err(PyValueError::new_err(format!(
                "jacobian has shape {}, but must have (dim, nv), or (nv,) for one row",
                shape_text(other)
            )));
        }
    };
    let values = array.as_slice()?;
    require_finite("jacobian", values)?;
    Ok((values.to_vec(), dim, nv))
}

/// Converts a value to one number for each of `dim` rows.
fn rows(name: &str, value: &Bound<'_, PyAny>, dim: usize) -> PyResult<Vec<f64>> {
    let array = numbers::<f64>(name, value)?;
    let values = array.as_slice()?;
    require_finite(name, values)?;
    if array.ndim() == 0 {
        return Ok(vec![values[0]; dim]);
    }
    require_shape(name, array.shape(), &[dim])?;
    Ok(values.to_vec())
}
