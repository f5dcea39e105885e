//! One contact of a simulation.

use pyo3::prelude::*;

/// A contact between two geoms. Its numbers are copies, in float64.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct Contact {
    /// tuple of int : The geoms; the normal points from the first to the second.
    pub(crate) geom: (usize, usize),
    /// tuple of str : Their names; an unnamed geom is called by its body and its index there, as in ``torso[1]``.
    pub(crate) geom_names: (String, String),
    /// tuple of int : The bodies that carry them.
    pub(crate) body: (usize, usize),
    /// int : Dimensions: 1 without friction, 3 with sliding, 4 with spin, 6 with rolling friction.
    pub(crate) dim: i64,
    /// float : Signed distance, m; negative in penetration.
    pub(crate) dist: f64,
    /// numpy.ndarray : Midpoint between the surfaces (3), m.
    pub(crate) pos: Py<PyAny>,
    /// numpy.ndarray : Rows are normal, first tangent, second tangent (3, 3).
    pub(crate) frame: Py<PyAny>,
    /// float : The contact acts where `dist` is less than this, m.
    pub(crate) includemargin: f64,
    /// numpy.ndarray : Friction coefficients (5): two slides, spin, two rolls.
    pub(crate) friction: Py<PyAny>,
    /// float : Adhesive force, N.
    pub(crate) adhesion: f64,
    /// numpy.ndarray : Velocity of the second surface relative to the first (3): along both tangents, m/s, about the
    /// normal, rad/s.
    pub(crate) surfacevel: Py<PyAny>,
    /// numpy.ndarray : Force on the second geom in the contact frame (6): along normal and tangents, N, then torques
    /// about them, N m.
    pub(crate) force: Py<PyAny>,
    /// numpy.ndarray : The same in world axes (6): force, N, then torque about `pos`, N m.
    pub(crate) wrench: Py<PyAny>,
}

#[pymethods]
impl Contact {
    fn __repr__(&self) -> String {
        let (first, second) = &self.geom_names;
        format!("<clench.Contact: {first} and {second}, {} m>", self.dist)
    }
}
