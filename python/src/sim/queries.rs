//! Queries of a simulation about contacts, constraints and geoms.

use super::Sim;
use crate::busy::lock;
use crate::constraints::Constraints;
use crate::contacts::Contacts;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::{self, RayHit, Separation};
use crate::row_sim::{AnySim, each_sim};
use clench::math::Real;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

#[pymethods]
impl Sim {
    /// Contacts : The contacts, at the positions that queries use (see `Sim`).
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, Contacts>> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => Contacts::of(py, own.refreshed().map_err(sim_error)?))
    }

    /// Constraints : The constraint rows, with their forces, in the state that queries use (see `Sim`).
    #[getter]
    fn constraints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, Constraints>> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => Constraints::of(py, own.refreshed().map_err(sim_error)?))
    }

    /// Computes the joint-space mass matrix at the positions that queries use (see `Sim`).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Dense (nv, nv), float64.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     If the state is not finite.
    fn mass_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = lock(&self.inner, "simulation")?;
        let values = each_sim!(&mut *guard, own => own.current().and_then(|sim| sim.mass_matrix()));
        let values = values.map_err(sim_error)?;
        let nv = self.model.get().inner().nv;
        Ok(PyArray1::from_vec(py, values).reshape([nv, nv])?.into_any())
    }

    /// Finds the first hit of a ray, in the poses that queries use (see `Sim`).
    ///
    /// It works like MuJoCo's ``mj_ray``: planes are hit from above and within their size (if it is positive), meshes
    /// on their own triangles, from either side; a ray that starts inside another shape hits it where it exits, and
    /// rays pass through invisible geoms (colours of opacity 0).
    ///
    /// Parameters
    /// ----------
    /// origin : array_like
    ///     Origin of the ray (3,), m.
    /// direction : array_like
    ///     Direction of the ray (3,). Its length is the unit of `RayHit.distance`.
    /// groups : array_like of int, optional
    ///     The groups of geoms, 0 to 5, that can be hit; by default all.
    /// fixed : bool
    ///     True if rays can hit geoms that are fixed to the world.
    /// exclude_body : str or int, optional
    ///     A body, by name or index, whose geoms are not hit.
    ///
    /// Returns
    /// -------
    /// RayHit or None
    ///     None if the ray hits nothing.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a vector has another shape or is not finite, the direction is zero, or the model does not have the body.
    /// IndexError
    ///     If an index or a group is out of range.
    /// SimulationError
    ///     If the state is not finite.
    #[pyo3(signature = (origin, direction, *, groups = None, fixed = true, exclude_body = None))]
    fn ray(
        &self,
        py: Python<'_>,
        origin: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        groups: Option<&Bound<'_, PyAny>>,
        fixed: bool,
        exclude_body: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<RayHit>> {
        let model = self.model.get().inner();
        let filter = queries::ray_filter(model, groups, fixed, exclude_body)?;
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let (origin, direction) = (queries::vector("origin", origin)?, queries::direction(direction)?);
            let hit = own.current().and_then(|sim| sim.ray(origin, direction, &filter)).map_err(sim_error)?;
            let name = |geom: usize| model.geom_label(geom);
            hit.map(|hit| RayHit::new(py, &hit, name(hit.geom), origin, direction)).transpose()
        })
    }

    /// Computes the distance of two geoms, in the poses that queries use (see `Sim`), regardless of collision filters.
    ///
    /// It is like MuJoCo's ``mj_geomDistance``. A mesh is replaced by its convex hull.
    ///
    /// Parameters
    /// ----------
    /// geom1, geom2 : str or int
    ///     The geoms, by name or index.
    /// limit : float, optional
    ///     Geoms further apart than this, m, are not measured, which saves time.
    ///
    /// Returns
    /// -------
    /// Separation or None
    ///     None if they are further apart than the limit, or their distance is not defined: two planes or height
    ///     fields, or a flat mesh.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have a name.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state is not finite.
    #[pyo3(signature = (geom1, geom2, limit = None))]
    fn distance(
        &self,
        py: Python<'_>,
        geom1: &Bound<'_, PyAny>,
        geom2: &Bound<'_, PyAny>,
        limit: Option<f64>,
    ) -> PyResult<Option<Separation>> {
        let limit = limit.unwrap_or(f64::INFINITY);
        let model = self.model.get().inner();
        let (geom1, geom2) = (
            Kind::Geom.find(model, geom1)?,
            Kind::Geom.find(model, geom2)?,
        );
        if limit.is_nan() {
            return Err(PyValueError::new_err("limit is not a number"));
        }
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let found = own.current().and_then(|sim| sim.distance(geom1, geom2, Real::new(limit)));
            let found = found.map_err(sim_error)?;
            found.map(|found| Separation::new(py, &found)).transpose()
        })
    }
}
