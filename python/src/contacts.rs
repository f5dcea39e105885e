//! The contacts of a simulation, as arrays.

use crate::arrays::column;
use clench::Precision;
use clench::rigid::readout::{self, ContactRow};
use pyo3::prelude::*;

/// Contacts between geoms, an array a quantity: entry i of each belongs to contact i. All are copies, in float64.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Contacts {
    /// numpy.ndarray : The geoms (ncon, 2), int64; the normal points from the first to the second.
    #[pyo3(get)]
    geom: Py<PyAny>,
    /// list of tuple of str : Their names, empty where a geom has none.
    #[pyo3(get)]
    geom_names: Vec<(String, String)>,
    /// numpy.ndarray : Dimensions (ncon), int64: 1 without friction, 3 with sliding, 4 with spin, 6 with rolling friction.
    #[pyo3(get)]
    dim: Py<PyAny>,
    /// numpy.ndarray : Signed distance (ncon), m; negative in penetration.
    #[pyo3(get)]
    dist: Py<PyAny>,
    /// numpy.ndarray : Midpoint between the surfaces (ncon, 3), m.
    #[pyo3(get)]
    pos: Py<PyAny>,
    /// numpy.ndarray : Rows are normal, first tangent, second tangent (ncon, 3, 3).
    #[pyo3(get)]
    frame: Py<PyAny>,
    /// numpy.ndarray : A contact acts where `dist` is less than this (ncon), m.
    #[pyo3(get)]
    includemargin: Py<PyAny>,
    /// numpy.ndarray : Friction coefficients (ncon, 5): two slides, spin, two rolls.
    #[pyo3(get)]
    friction: Py<PyAny>,
    /// numpy.ndarray : Force with which a contact holds on (ncon), N: it acts beyond `includemargin` too, and can pull.
    #[pyo3(get)]
    adhesion: Py<PyAny>,
    /// numpy.ndarray : Velocity of the second surface less that of the first (ncon, 3): along both tangents, m/s, about the normal, rad/s.
    #[pyo3(get)]
    surfacevel: Py<PyAny>,
    /// numpy.ndarray : Force in the contact frame (ncon, 6): along normal and tangents, N, then torques about them, N m. It acts
    /// on the second geom, its negative on the first.
    #[pyo3(get)]
    force: Py<PyAny>,
    /// numpy.ndarray : The same in world axes (ncon, 6): force, N, then torque about `pos`, N m.
    #[pyo3(get)]
    wrench: Py<PyAny>,
    count: usize,
}

impl Contacts {
    /// Those of the last step or forward.
    pub(crate) fn of<'py, S: Precision>(
        py: Python<'py>,
        sim: &clench::Sim<S>,
    ) -> PyResult<Bound<'py, Self>> {
        let rows = readout::contact_rows(sim.workspace(), 0);
        let names = |row: &ContactRow| {
            let [first, second] = row.geoms.map(|geom| sim.model().geoms[geom].name.clone());
            (first, second)
        };
        let contacts = Contacts {
            count: rows.len(),
            geom_names: rows.iter().map(names).collect(),
            geom: column(py, &rows, [2], |row| row.geoms.map(|geom| geom as i64))?,
            dim: column(py, &rows, [], |row| [row.dim as i64])?,
            dist: column(py, &rows, [], |row| [row.dist])?,
            pos: column(py, &rows, [3], |row| row.pos)?,
            frame: column(py, &rows, [3, 3], |row| row.frame.concat())?,
            includemargin: column(py, &rows, [], |row| [row.includemargin])?,
            friction: column(py, &rows, [5], |row| row.friction)?,
            adhesion: column(py, &rows, [], |row| [row.adhesion])?,
            surfacevel: column(py, &rows, [3], |row| row.surfacevel)?,
            force: column(py, &rows, [6], |row| row.force)?,
            wrench: column(py, &rows, [6], |row| row.wrench)?,
        };
        Bound::new(py, contacts)
    }
}

#[pymethods]
impl Contacts {
    fn __len__(&self) -> usize {
        self.count
    }

    fn __repr__(&self) -> String {
        format!("<clench.Contacts: {}>", self.count)
    }
}
