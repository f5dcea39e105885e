//! Queries of `Batch` that cover all environments at once.

use crate::batch::{AnyBatch, Batch, each};
use crate::busy::lock;
use crate::error::sim_error;
use crate::inertia_queries::acceleration_kind;
use crate::kind::Kind;
use crate::motion_queries::axes;
use crate::queries::ray_filter;
use crate::scan::{RayHits, rays};
use crate::table::Table;
use crate::target::{Choice, Choices};
use clench::Anchors;
use clench::rigid::batch::Rows;
use clench::rigid::model::FrameObject;
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns the rows of a table as an array of this shape.
fn rows_array<'py, S: Element + Copy>(
    py: Python<'py>,
    rows: &Rows<S>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let array = PyArray1::from_slice(py, rows.as_slice());
    Ok(array.reshape(shape)?.into_any())
}

impl Batch {
    /// Computes Jacobians, or their time derivatives.
    fn jacobians<'py>(
        &self,
        py: Python<'py>,
        choices: &Choices<'_, 'py>,
        point: Choice<'_, 'py>,
        rate: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let object = choices.one(model)?;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let places = point.map(|point| Table::row_of("point", point, 3, Some(self.count())));
            let places = places.transpose()?;
            let anchors = match (object, &places) {
                (object, None) => Anchors::Object(object),
                (FrameObject::Body(body), Some(places)) => {
                    Anchors::Points { body, places: places.input() }
                }
                (_, Some(_)) => return Err(PyValueError::new_err("point needs body")),
            };
            let found = py.detach(|| match rate {
                true => batch.jacobian_rate(anchors),
                false => batch.jacobian(anchors),
            });
            rows_array(py, &found.map_err(sim_error)?, &[self.count(), 2, 3, model.nv])
        })
    }
}

#[pymethods]
impl Batch {
    /// Computes the Jacobian of an object in every environment, in the current states; see `Sim.jacobian`. The
    /// Jacobians of all sites can be recorded: outputs ``site_jacp`` and ``site_jacr``.
    ///
    /// Parameters
    /// ----------
    /// body, body_com, geom, site, camera : str or int
    ///     The object: the frame of a body, its centre of mass, a geom, a site or a camera.
    /// point : array_like, optional
    ///     With `body`: the point of the body that is currently at this position in the world, m: (3,) for all
    ///     environments, or (n, 3) with one row for each.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (n, 2, 3, nv): translation, then rotation, in world axes; NaN where a state is not finite or the
    ///     environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, the model does not have its name, or `point` has another shape.
    /// IndexError
    ///     If an index is negative or too large.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, point = None))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        body: Choice<'_, 'py>,
        body_com: Choice<'_, 'py>,
        geom: Choice<'_, 'py>,
        site: Choice<'_, 'py>,
        camera: Choice<'_, 'py>,
        point: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let choices = Choices([body, body_com, geom, site, camera]);
        self.jacobians(py, &choices, point, false)
    }

    /// Computes the time derivative of the Jacobian of an object in every environment; see `Sim.jacobian_rate`.
    ///
    /// Parameters
    /// ----------
    /// body, body_com, geom, site, camera : str or int
    ///     The object, see `jacobian`.
    /// point : array_like, optional
    ///     With `body`: a point of the body, see `jacobian`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (n, 2, 3, nv): of the translational part, then of the rotational part; NaN where a state is not finite or
    ///     the environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError, IndexError
    ///     As for `jacobian`.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, point = None))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn jacobian_rate<'py>(
        &self,
        py: Python<'py>,
        body: Choice<'_, 'py>,
        body_com: Choice<'_, 'py>,
        geom: Choice<'_, 'py>,
        site: Choice<'_, 'py>,
        camera: Choice<'_, 'py>,
        point: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let choices = Choices([body, body_com, geom, site, camera]);
        self.jacobians(py, &choices, point, true)
    }

    /// Computes the Jacobian of the centre of mass of a body's subtree in every environment, in the current states.
    ///
    /// Parameters
    /// ----------
    /// body : str or int
    ///     The body; 0, the world, for the centre of mass of everything.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (n, 3, nv), in world axes; NaN where a state is not finite.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have the name.
    /// IndexError
    ///     If the index is negative or too large.
    fn subtree_jacobian<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let body = Kind::Body.find(model, body)?;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let found = py.detach(|| batch.subtree_jacobian(body)).map_err(sim_error)?;
            rows_array(py, &found, &[self.count(), 3, model.nv])
        })
    }

    /// Computes the velocity of an object in every environment, in the current states; see `Sim.velocity`.
    ///
    /// Parameters
    /// ----------
    /// body, body_com, geom, site, camera : str or int
    ///     The object, see `jacobian`.
    /// local : bool
    ///     True for the axes of the object, false for those of the world.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (n, 2, 3): linear, m/s, of its position, then angular, rad/s; NaN where a state is not finite or the
    ///     environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, or the model does not have its name.
    /// IndexError
    ///     If an index is negative or too large.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, local = false))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn velocity<'py>(
        &self,
        py: Python<'py>,
        body: Choice<'_, 'py>,
        body_com: Choice<'_, 'py>,
        geom: Choice<'_, 'py>,
        site: Choice<'_, 'py>,
        camera: Choice<'_, 'py>,
        local: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let object = Choices([body, body_com, geom, site, camera]).one(self.described())?;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let found = py.detach(|| batch.velocity(object, axes(local))).map_err(sim_error)?;
            rows_array(py, &found, &[self.count(), 2, 3])
        })
    }

    /// Computes the acceleration of an object in every environment, in the current states; see `Sim.acceleration`. It
    /// includes the upward reaction to gravity. It runs all of forward dynamics.
    ///
    /// Parameters
    /// ----------
    /// body, body_com, geom, site, camera : str or int
    ///     The object, see `jacobian`.
    /// local : bool
    ///     True for the axes of the object, false for those of the world.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (n, 2, 3): linear, m/s², of its position, then angular, rad/s²; NaN where a single `Sim` would raise
    ///     SimulationError or the environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, or the model does not have its name.
    /// IndexError
    ///     If an index is negative or too large.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, local = false))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn acceleration<'py>(
        &self,
        py: Python<'py>,
        body: Choice<'_, 'py>,
        body_com: Choice<'_, 'py>,
        geom: Choice<'_, 'py>,
        site: Choice<'_, 'py>,
        camera: Choice<'_, 'py>,
        local: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let object = Choices([body, body_com, geom, site, camera]).one(self.described())?;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let found = py.detach(|| batch.acceleration(object, axes(local))).map_err(sim_error)?;
            rows_array(py, &found, &[self.count(), 2, 3])
        })
    }

    /// Computes M x in every environment, in the current states; see `Sim.mul_mass`.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Accelerations, (nv,) for all environments, or (n, nv) with one row for each.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The forces along dofs that cause them (n, nv), N and N m; NaN where a state is not finite.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape or is not finite.
    fn mul_mass<'py>(&self, py: Python<'py>, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let x = Table::row_of("x", x, nv, Some(self.count()))?;
            let found = py.detach(|| batch.mul_mass(x.input())).map_err(sim_error)?;
            rows_array(py, &found, &[self.count(), nv])
        })
    }

    /// Computes M⁻¹ x in every environment, in the current states; see `Sim.solve_mass`.
    ///
    /// Parameters
    /// ----------
    /// x : array_like
    ///     Forces along dofs, (nv,) for all environments, or (n, nv) with one row for each.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     The accelerations that they cause (n, nv); NaN where a state is not finite or a mass matrix is singular.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape or is not finite.
    fn solve_mass<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let x = Table::row_of("x", x, nv, Some(self.count()))?;
            let found = py.detach(|| batch.solve_mass(x.input())).map_err(sim_error)?;
            rows_array(py, &found, &[self.count(), nv])
        })
    }

    /// Casts many rays, as a lidar does, in every environment, in the current states.
    ///
    /// Parameters
    /// ----------
    /// origins, directions : array_like
    ///     As in `Sim.rays`: (k, 3) for all environments, or (n, k, 3) with different ones for each.
    /// body, body_com, geom, site, camera : str or int, optional
    ///     An object in whose frame the rays are given, so that they move with it; by default they are in the world
    ///     frame.
    /// groups : array_like of int, optional
    ///     The groups of geoms, 0 to 5, that can be hit; by default all.
    /// fixed : bool
    ///     True if rays can hit geoms that are fixed to the world.
    /// exclude_body : str or int, optional
    ///     A body, by name or index, whose geoms are not hit.
    ///
    /// Returns
    /// -------
    /// RayHits
    ///     One hit for each ray, with the environments as first axis. Distances are NaN where a state is not finite
    ///     or the environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have a name, a direction is zero, or an array has another shape or is not finite.
    /// IndexError
    ///     If an index or a group is out of range.
    #[pyo3(signature = (origins, directions, *, body = None, body_com = None, geom = None, site = None, camera = None,
                        groups = None, fixed = true, exclude_body = None))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn rays<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        body: Choice<'_, 'py>,
        body_com: Choice<'_, 'py>,
        geom: Choice<'_, 'py>,
        site: Choice<'_, 'py>,
        camera: Choice<'_, 'py>,
        groups: Choice<'_, 'py>,
        fixed: bool,
        exclude_body: Choice<'_, 'py>,
    ) -> PyResult<RayHits> {
        let model = self.described();
        let frame = Choices([body, body_com, geom, site, camera]).optional(model)?;
        let filter = ray_filter(model, groups, fixed, exclude_body)?;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let rays = rays(origins, directions, Some(self.count()))?;
            let found = py.detach(|| batch.rays(rays.input(), frame, &filter));
            let shape = [self.count(), rays.rows];
            RayHits::new(py, found.map_err(sim_error)?.as_slice(), &shape)
        })
    }

    /// Computes heights of terrain in every environment, in the current states; see `Sim.heights`.
    ///
    /// Parameters
    /// ----------
    /// hfield : str or int
    ///     The geom that is the height field. Exact where its z axis points upwards.
    /// places : array_like
    ///     x and y, m: (k, 2) for all environments, or (n, k, 2) with different ones for each.
    /// body, body_com, geom, site, camera : str or int, optional
    ///     An object whose position is the origin of the places, with their x axis along its own as seen from above; by
    ///     default they are in the world frame.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Heights in the world (n, k), m; NaN where a state is not finite or the environment's model lacks a geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the geom is no height field, the model does not have a name, or `places` has another shape or is not
    ///     finite.
    /// IndexError
    ///     If an index is negative or too large.
    #[pyo3(signature = (hfield, places, *, body = None, body_com = None, geom = None, site = None, camera = None))]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn heights<'py>(
        &self,
        py: Python<'py>,
        hfield: &Bound<'py, PyAny>,
        places: &Bound<'py, PyAny>,
        body: Choice<'_, 'py>,
        body_com: Choice<'_, 'py>,
        geom: Choice<'_, 'py>,
        site: Choice<'_, 'py>,
        camera: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let frame = Choices([body, body_com, geom, site, camera]).optional(model)?;
        let hfield = Kind::Geom.find(model, hfield)?;
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let places = Table::rows_of("places", places, 2, Some(self.count()))?;
            let found = py.detach(|| batch.heights(hfield, places.input(), frame));
            rows_array(py, &found.map_err(sim_error)?, &[self.count(), places.rows])
        })
    }

    /// Computes inverse dynamics in every environment, in the current states; see `Sim.inverse`.
    ///
    /// Parameters
    /// ----------
    /// qacc : array_like
    ///     Accelerations, (nv,) for all environments, or (n, nv) with one row for each.
    /// discrete : bool, optional
    ///     True if a step changes the velocity by them, ``(v1 - v0) / timestep``; false if they are those that
    ///     `forward` finds. The default is the model's flag ``invdiscrete``.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Forces along dofs (n, nv), N and N m; NaN where a single `Sim` would raise SimulationError.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape is wrong, a number is not finite, or `discrete` is used with the Runge-Kutta integrator.
    #[pyo3(signature = (qacc, *, discrete = None))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        qacc: &Bound<'py, PyAny>,
        discrete: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let kind = acceleration_kind(model, discrete);
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let qacc = Table::row_of("qacc", qacc, model.nv, Some(self.count()))?;
            let found = py.detach(|| batch.inverse(qacc.input(), kind)).map_err(sim_error)?;
            rows_array(py, &found, &[self.count(), model.nv])
        })
    }
}
