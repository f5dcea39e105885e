//! What a simulation answers about its contacts, constraints and geoms.

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
    /// Contacts : The contacts, at the positions that queries see (see `Sim`).
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, Contacts>> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => Contacts::of(py, own.refreshed().map_err(sim_error)?))
    }

    /// Constraints : The constraint rows, with their forces, in the state that queries see (see `Sim`).
    #[getter]
    fn constraints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, Constraints>> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => Constraints::of(py, own.refreshed().map_err(sim_error)?))
    }

    /// The joint-space mass matrix, of the positions that queries see (see `Sim`).
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Dense (nv, nv), float64.
    fn mass_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = lock(&self.inner, "simulation")?;
        let values = each_sim!(&mut *guard, own => own.current().and_then(|sim| sim.mass_matrix()));
        let values = values.map_err(sim_error)?;
        let nv = self.model.get().inner().nv;
        Ok(PyArray1::from_vec(py, values).reshape([nv, nv])?.into_any())
    }

    /// The geom that a ray hits first, where geoms are as queries see them (see `Sim`).
    ///
    /// As MuJoCo's ``mj_ray``: planes are hit from above and within their size (where that is positive), meshes on their
    /// own triangles, from either side; a ray that begins inside another shape hits it where it leaves, and rays pass through what
    /// cannot be seen (colours of opacity 0).
    ///
    /// Parameters
    /// ----------
    /// origin : array_like
    ///     Where the ray begins (3,), m.
    /// direction : array_like
    ///     Where it leads (3,). Its length is the unit of `RayHit.distance`.
    /// groups : array_like of int, optional
    ///     The groups of geoms, 0 to 5, that can be hit; all of them if not given.
    /// fixed : bool
    ///     Whether geoms can be hit that are fixed to the world.
    /// exclude_body : str or int, optional
    ///     A body, by name or index, whose geoms are not hit.
    ///
    /// Returns
    /// -------
    /// RayHit or None
    ///     None if the ray hits nothing.
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

    /// How far apart two geoms are, where queries see them (see `Sim`), whatever they collide with.
    ///
    /// As MuJoCo's ``mj_geomDistance``. A mesh counts as its convex hull.
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
    ///     None if they are further apart than the limit, or have no distance: two planes or height fields, or a mesh that is flat.
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
