//! The contacts of a simulation, as arrays.

use crate::arrays::{column, indices};
use crate::contact::Contact;
use crate::kind::Kind;
use clench::rigid::readout::{self, ContactRow};
use clench::{Model, Precision};
use numpy::PyArray1;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::sync::Arc;

/// Contacts between geoms, one array per quantity: entry i belongs to contact i. All arrays are copies, in float64.
///
/// An index or an iteration gives a `Contact`; a slice, indices or a mask (ncon) give a selection. `of_geom`, `of_body`
/// and `between` find the contacts of a geom, a body or a pair.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Contacts {
    /// numpy.ndarray : The geoms (ncon, 2), int64; the normal points from the first to the second.
    #[pyo3(get)]
    geom: Py<PyAny>,
    /// list of tuple of str : Their names; an unnamed geom is called by its body and its index there, as in
    /// ``torso[1]``.
    #[pyo3(get)]
    geom_names: Vec<(String, String)>,
    /// numpy.ndarray : Dimensions (ncon), int64: 1 without friction, 3 with sliding, 4 with spin, 6 with rolling
    /// friction.
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
    /// numpy.ndarray : Adhesive force (ncon), N: it acts beyond `includemargin` too, and can pull.
    #[pyo3(get)]
    adhesion: Py<PyAny>,
    /// numpy.ndarray : Velocity of the second surface relative to the first (ncon, 3): along both tangents, m/s, about
    /// the normal, rad/s.
    #[pyo3(get)]
    surfacevel: Py<PyAny>,
    /// numpy.ndarray : Force in the contact frame (ncon, 6): along normal and tangents, N, then torques about them, N
    /// m. It acts on the second geom; the first gets the opposite force.
    #[pyo3(get)]
    force: Py<PyAny>,
    /// numpy.ndarray : The same in world axes (ncon, 6): force, N, then torque about `pos`, N m.
    #[pyo3(get)]
    wrench: Py<PyAny>,
    geoms: Vec<[usize; 2]>,
    model: Arc<Model>,
}

impl Contacts {
    /// Reads the contacts of the last step or forward.
    pub(crate) fn of<'py, S: Precision>(
        py: Python<'py>,
        sim: &clench::Sim<S>,
    ) -> PyResult<Bound<'py, Self>> {
        let rows = readout::contact_rows(sim.workspace(), 0);
        let model = Arc::clone(sim.model());
        let names = |row: &ContactRow| {
            let [first, second] = row.geoms.map(|geom| model.geom_label(geom));
            (first, second)
        };
        let contacts = Contacts {
            geoms: rows.iter().map(|row| row.geoms).collect(),
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
            model,
        };
        Bound::new(py, contacts)
    }

    /// Returns the chosen contacts, in this order.
    fn take(&self, py: Python<'_>, chosen: &[usize]) -> PyResult<Contacts> {
        let index = PyArray1::from_iter(py, chosen.iter().map(|&i| i as i64));
        let rows = |array: &Py<PyAny>| array.call_method1(py, "take", (&index, 0));
        Ok(Contacts {
            geoms: chosen.iter().map(|&i| self.geoms[i]).collect(),
            geom_names: (chosen.iter().map(|&i| self.geom_names[i].clone())).collect(),
            geom: rows(&self.geom)?,
            dim: rows(&self.dim)?,
            dist: rows(&self.dist)?,
            pos: rows(&self.pos)?,
            frame: rows(&self.frame)?,
            includemargin: rows(&self.includemargin)?,
            friction: rows(&self.friction)?,
            adhesion: rows(&self.adhesion)?,
            surfacevel: rows(&self.surfacevel)?,
            force: rows(&self.force)?,
            wrench: rows(&self.wrench)?,
            model: Arc::clone(&self.model),
        })
    }

    /// Returns the contacts whose geoms are wanted.
    fn filter(&self, py: Python<'_>, wanted: impl Fn([usize; 2]) -> bool) -> PyResult<Contacts> {
        let all = self.geoms.iter().enumerate();
        let chosen: Vec<usize> = all
            .filter(|(_, geoms)| wanted(**geoms))
            .map(|(i, _)| i)
            .collect();
        self.take(py, &chosen)
    }

    /// Returns contact `i`.
    fn single(&self, py: Python<'_>, i: usize) -> PyResult<Contact> {
        let row = |array: &Py<PyAny>| {
            let row = array.bind(py).get_item(i)?;
            // A view would keep the whole array alive.
            Ok::<_, PyErr>(row.call_method0("copy")?.unbind())
        };
        let number = |array: &Py<PyAny>| array.bind(py).get_item(i)?.extract::<f64>();
        let [first, second] = self.geoms[i];
        Ok(Contact {
            geom: (first, second),
            geom_names: self.geom_names[i].clone(),
            body: (self.model.geoms[first].body, self.model.geoms[second].body),
            dim: self.dim.bind(py).get_item(i)?.extract()?,
            dist: number(&self.dist)?,
            pos: row(&self.pos)?,
            frame: row(&self.frame)?,
            includemargin: number(&self.includemargin)?,
            friction: row(&self.friction)?,
            adhesion: number(&self.adhesion)?,
            surfacevel: row(&self.surfacevel)?,
            force: row(&self.force)?,
            wrench: row(&self.wrench)?,
        })
    }

    fn find_geom(&self, which: &Bound<'_, PyAny>) -> PyResult<usize> {
        Kind::Geom.find(&self.model, which)
    }
}

#[pymethods]
impl Contacts {
    /// Selects the contacts of a geom.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The name or index of the geom.
    ///
    /// Returns
    /// -------
    /// Contacts
    fn of_geom(&self, which: &Bound<'_, PyAny>) -> PyResult<Contacts> {
        let geom = self.find_geom(which)?;
        self.filter(which.py(), |geoms| geoms.contains(&geom))
    }

    /// Selects the contacts of all geoms of a body.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The name or index of the body.
    ///
    /// Returns
    /// -------
    /// Contacts
    fn of_body(&self, which: &Bound<'_, PyAny>) -> PyResult<Contacts> {
        let body = Kind::Body.find(&self.model, which)?;
        self.filter(which.py(), |geoms| {
            geoms
                .iter()
                .any(|&geom| self.model.geoms[geom].body == body)
        })
    }

    /// Selects the contacts between two geoms, in either order.
    ///
    /// Parameters
    /// ----------
    /// geom1, geom2 : str or int
    ///     The geoms, by name or index.
    ///
    /// Returns
    /// -------
    /// Contacts
    fn between(&self, geom1: &Bound<'_, PyAny>, geom2: &Bound<'_, PyAny>) -> PyResult<Contacts> {
        let (one, other) = (self.find_geom(geom1)?, self.find_geom(geom2)?);
        self.filter(geom1.py(), |geoms| {
            geoms == [one, other] || geoms == [other, one]
        })
    }

    fn __getitem__<'py>(&self, which: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let (py, count) = (which.py(), self.geoms.len());
        if let Ok(index) = which.extract::<isize>() {
            let from_end = if index < 0 {
                index + count as isize
            } else {
                index
            };
            let Some(found) = usize::try_from(from_end).ok().filter(|&i| i < count) else {
                let text = format!("there is no contact {index}: there are {count}");
                return Err(PyIndexError::new_err(text));
            };
            return Ok(self.single(py, found)?.into_pyobject(py)?.into_any());
        }
        let numbers = PyArray1::from_iter(py, 0..count as i64);
        let chosen = numbers.as_any().get_item(which)?;
        let chosen = indices("contacts", &chosen, count)?;
        Ok(self.take(py, &chosen)?.into_pyobject(py)?.into_any())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let all: Vec<Contact> = (0..self.geoms.len())
            .map(|i| self.single(py, i))
            .collect::<PyResult<_>>()?;
        PyList::new(py, all)?
            .as_any()
            .try_iter()
            .map(|iterator| iterator.into_any())
    }

    fn __len__(&self) -> usize {
        self.geoms.len()
    }

    fn __repr__(&self) -> String {
        format!("<clench.Contacts: {}>", self.geoms.len())
    }
}
