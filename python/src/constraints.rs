//! The constraint rows of a simulation, as arrays.

use crate::arrays::column;
use clench::Precision;
use clench::rigid::readout::{self, ConstraintRow};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

/// Constraint rows, like MuJoCo's ``efc`` fields: entry i of each array belongs to row i, and each edge of a pyramid is
/// a row. All arrays are copies, in float64.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Constraints {
    /// list of str : Kind of constraint: "equality", "friction_dof", "friction_tendon", "limit_joint", "limit_tendon",
    /// "contact", or "dynamic" for constraints that were added at run time.
    #[pyo3(get)]
    kind: Vec<&'static str>,
    /// numpy.ndarray : Index of the constraint among those of its kind (nefc), int64: of the equality, dof, joint,
    /// tendon, contact or slot.
    #[pyo3(get)]
    id: Py<PyAny>,
    /// list of str : Its name, for a dof that of the joint; empty for contacts, dynamic constraints and unnamed
    /// elements.
    #[pyo3(get)]
    name: Vec<String>,
    /// numpy.ndarray : Violation of an equality, signed distance of a limit or contact, zero for friction (nefc).
    #[pyo3(get)]
    pos: Py<PyAny>,
    /// numpy.ndarray : Distance at which the constraint begins to act (nefc).
    #[pyo3(get)]
    margin: Py<PyAny>,
    /// numpy.ndarray : Rate of change of the position (nefc).
    #[pyo3(get)]
    vel: Py<PyAny>,
    /// numpy.ndarray : Reference acceleration (nefc).
    #[pyo3(get)]
    aref: Py<PyAny>,
    /// numpy.ndarray : Weight of the cost (nefc), the inverse of the regularization R.
    #[pyo3(get, name = "D")]
    d: Py<PyAny>,
    /// numpy.ndarray : Impedance (nefc).
    #[pyo3(get)]
    impedance: Py<PyAny>,
    /// numpy.ndarray : Dry friction, zero for all other rows (nefc).
    #[pyo3(get)]
    frictionloss: Py<PyAny>,
    /// numpy.ndarray : Force (nefc).
    #[pyo3(get)]
    force: Py<PyAny>,
    /// numpy.ndarray : Jacobian, dense (nefc, nv).
    #[pyo3(get, name = "J")]
    jacobian: Py<PyAny>,
}

impl Constraints {
    /// Reads the rows of the last step or forward.
    pub(crate) fn of<'py, S: Precision>(
        py: Python<'py>,
        sim: &clench::Sim<S>,
    ) -> PyResult<Bound<'py, Self>> {
        let (model, ws) = (sim.model(), sim.workspace());
        let rows = readout::constraint_rows(ws, 0);
        let of = |read: fn(&ConstraintRow) -> f64| column(py, &rows, [], |row| [read(row)]);
        let jacobian = PyArray1::from_vec(py, readout::jacobian(ws, 0));
        let constraints = Constraints {
            kind: rows.iter().map(|row| row.source.kind()).collect(),
            id: column(py, &rows, [], |row| [row.source.index() as i64])?,
            name: (rows.iter().map(|row| row.source.name(model).to_owned())).collect(),
            pos: of(|row| row.pos)?,
            margin: of(|row| row.margin)?,
            vel: of(|row| row.vel)?,
            aref: of(|row| row.aref)?,
            d: of(|row| row.d)?,
            impedance: of(|row| row.impedance)?,
            frictionloss: of(|row| row.frictionloss)?,
            force: of(|row| row.force)?,
            jacobian: jacobian
                .reshape([rows.len(), model.nv])?
                .into_any()
                .unbind(),
        };
        Bound::new(py, constraints)
    }
}

#[pymethods]
impl Constraints {
    fn __len__(&self) -> usize {
        self.kind.len()
    }

    fn __repr__(&self) -> String {
        format!("<clench.Constraints: {} rows>", self.kind.len())
    }
}
