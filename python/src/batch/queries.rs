//! Queries of a batch: contacts and constraints of one environment, geoms and inertia of all.

use super::{AnyBatch, Batch};
use crate::arrays::{numbers, require_finite, require_shape};
use crate::busy::lock;
use crate::constraints::Constraints;
use crate::contacts::Contacts;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries;
use clench::math::{Real, Scalar, Vec3};
use clench::{Precision, SimError};
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PySlice;

/// Queries one simulation about every environment in turn.
fn query_all<S: Precision, R>(
    batch: &clench::Batch<S>,
    mut query: impl FnMut(usize, &mut clench::Sim<S>) -> Result<R, SimError>,
) -> Result<Vec<R>, SimError> {
    let Some(last) = batch.count().checked_sub(1) else {
        return Ok(Vec::new());
    };
    let mut sim = batch.sim(last)?;
    let each = |env| {
        batch.copy_to_sim(env, &mut sim)?;
        query(env, &mut sim)
    };
    (0..=last).map(each).collect()
}

/// Reads vectors of finite numbers for every environment: one for all (3) or one row each (n, 3).
fn vectors(name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<[f64; 3]>> {
    let array = numbers::<f64>(name, value)?;
    if array.ndim() != 1 {
        require_shape(name, array.shape(), &[count, 3])?;
    } else {
        require_shape(name, array.shape(), &[3])?;
    }
    let values = array.as_slice()?;
    require_finite(name, values)?;
    let rows = values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]);
    Ok(rows.cycle().take(count).collect())
}

#[pymethods]
impl Batch {
    /// Computes the contacts of an environment in its current state.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     The index of the environment.
    ///
    /// Returns
    /// -------
    /// Contacts
    ///     With the geoms of the environment's own model.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     If no step can start from the state.
    fn contacts<'py>(
        &self,
        py: Python<'py>,
        env: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, Contacts>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        each!(&*guard, batch => {
            let mut sim = batch.sim(env).map_err(sim_error)?;
            sim.refresh().map_err(sim_error)?;
            Contacts::of(py, &sim)
        })
    }

    /// Computes the constraint rows of an environment in its current state, with their forces.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     The index of the environment.
    ///
    /// Returns
    /// -------
    /// Constraints
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     If no step can start from the state.
    fn constraints<'py>(
        &self,
        py: Python<'py>,
        env: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, Constraints>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        each!(&*guard, batch => {
            let mut sim = batch.sim(env).map_err(sim_error)?;
            sim.refresh().map_err(sim_error)?;
            Constraints::of(py, &sim)
        })
    }

    /// Computes the joint-space mass matrix of every environment at its current positions.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Dense (n, nv, nv), float64.
    fn mass_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let all = py.detach(|| each!(any, batch => query_all(batch, |_, sim| sim.mass_matrix())));
        let all = all.map_err(sim_error)?.concat();
        let nv = self.model.get().inner().nv;
        let shape = [self.n_envs, nv, nv];
        Ok(PyArray1::from_vec(py, all).reshape(shape)?.into_any())
    }

    /// Finds the first hit of a ray in every environment, at its current positions.
    ///
    /// The geoms that can be hit are those of `Sim.ray`.
    ///
    /// Parameters
    /// ----------
    /// origin : array_like
    ///     Origin of the ray, for all (3) or each (n, 3) environment, m.
    /// direction : array_like
    ///     Direction of the ray, (3) or (n, 3). Its length is the unit of distances.
    /// groups : array_like of int, optional
    ///     The groups of geoms, 0 to 5, that can be hit; by default all.
    /// fixed : bool
    ///     True if rays can hit geoms that are fixed to the world.
    /// exclude_body : str or int, optional
    ///     A body, by name or index, whose geoms are not hit.
    ///
    /// Returns
    /// -------
    /// distance : numpy.ndarray
    ///     From the origin, in lengths of the direction (n), float64; infinite if nothing is hit.
    /// geom : numpy.ndarray
    ///     The geoms (n), int64; -1 if nothing is hit.
    ///
    /// Raises
    /// ------
    /// ValueError, IndexError
    ///     As for `Sim.ray`.
    #[pyo3(signature = (origin, direction, *, groups = None, fixed = true, exclude_body = None))]
    #[allow(clippy::type_complexity)] // Two arrays.
    fn ray<'py>(
        &self,
        py: Python<'py>,
        origin: &Bound<'py, PyAny>,
        direction: &Bound<'py, PyAny>,
        groups: Option<&Bound<'py, PyAny>>,
        fixed: bool,
        exclude_body: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>)> {
        let model = self.model.get().inner();
        let filter = queries::ray_filter(model, groups, fixed, exclude_body)?;
        let origins = vectors("origin", origin, self.n_envs)?;
        let directions = vectors("direction", direction, self.n_envs)?;
        if directions.contains(&[0.0; 3]) {
            return Err(PyValueError::new_err("direction has no length"));
        }
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let hits = py.detach(|| {
            each!(any, batch => {
                let geoms = (0..batch.models().len()).map(|model| batch.geoms_of(model));
                let geoms = geoms.collect::<Result<Vec<_>, _>>()?;
                query_all(batch, |env, sim| {
                let (origin, direction) = (Vec3::from_f64(origins[env]), Vec3::from_f64(directions[env]));
                let hit = sim.ray(origin, direction, &filter)?;
                let geom = |own: usize| geoms[batch.env_model(env)][own] as i64;
                Ok(hit.map(|hit| (hit.distance.to_f64(), geom(hit.geom))))
                })
            })
        });
        let hits = hits.map_err(sim_error)?;
        let hits = || hits.iter().map(|hit| hit.unwrap_or((f64::INFINITY, -1)));
        Ok((
            PyArray1::from_iter(py, hits().map(|hit| hit.0)),
            PyArray1::from_iter(py, hits().map(|hit| hit.1)),
        ))
    }

    /// Computes the distance of two geoms in every environment, at its current positions, regardless of collision
    /// filters.
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
    /// numpy.ndarray
    ///     Signed distances (n), m, float64; infinite beyond the limit, if the distance is not defined, as for two
    ///     planes, and in environments whose model has not both geoms.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have a name.
    /// IndexError
    ///     If an index is negative or too large.
    #[pyo3(signature = (geom1, geom2, limit = None))]
    fn distance<'py>(
        &self,
        py: Python<'py>,
        geom1: &Bound<'py, PyAny>,
        geom2: &Bound<'py, PyAny>,
        limit: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let model = self.model.get().inner();
        let geom1 = Kind::Geom.find(model, geom1)?;
        let geom2 = Kind::Geom.find(model, geom2)?;
        let limit = limit.unwrap_or(f64::INFINITY);
        if limit.is_nan() {
            return Err(PyValueError::new_err("limit is not a number"));
        }
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let found = py.detach(|| {
            each!(any, batch => query_all(batch, |env, sim| {
                let own = |geom| batch.own_geom(env, geom);
                let Some((geom1, geom2)) = own(geom1).zip(own(geom2)) else {
                    return Ok(f64::INFINITY);
                };
                let found = sim.distance(geom1, geom2, Real::new(limit))?;
                Ok(found.map_or(f64::INFINITY, |found| found.distance.to_f64()))
            }))
        });
        Ok(PyArray1::from_vec(py, found.map_err(sim_error)?))
    }

    /// Switches an equality constraint on or off.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The equality, by name or index.
    /// active : bool or array_like of bool
    ///     True to make it active, for all or each (n) environment. `eq_active` shows all switches.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have the name, or `active` has another shape.
    /// IndexError
    ///     If the index is negative or too large.
    fn set_equality(
        this: &Bound<'_, Self>,
        which: &Bound<'_, PyAny>,
        active: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let py = this.py();
        let index = Kind::Equality.find(this.get().model.get().inner(), which)?;
        let switches = this.getattr("eq_active")?;
        switches.set_item((PySlice::full(py), index), active)
    }
}
