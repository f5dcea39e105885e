//! Queries of `Sim` about the motion of objects.

use crate::answer::answer;
use crate::busy::lock;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::vector;
use crate::row_sim::{AnySim, each_sim};
use crate::sim::Sim;
use crate::target::{Choice, Choices};
use clench::math::{Real, Vec3};
use clench::rigid::model::FrameObject;
use clench::{Anchor, Axes, Model, Precision};
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns the point of a query: an object, or a point of a body.
fn anchor<S: Precision>(model: &Model, choices: &Choices, point: Choice) -> PyResult<Anchor<S>> {
    let object = choices.one(model)?;
    match (object, point) {
        (object, None) => Ok(Anchor::Object(object)),
        (FrameObject::Body(body), Some(point)) => Ok(Anchor::Point {
            body,
            place: vector("point", point)?,
        }),
        _ => Err(PyValueError::new_err("point needs body")),
    }
}

#[pymethods]
impl Sim {
    /// Computes the Jacobian of an object: the derivative of its velocity, and of its body's angular velocity, by the
    /// dof velocities.
    ///
    /// Exactly one object is chosen, by name or index. Body poses are those that queries use (see `Sim`). It is like
    /// MuJoCo's ``mj_jac``, ``mj_jacBody``, ``mj_jacBodyCom``, ``mj_jacGeom`` and ``mj_jacSite``.
    ///
    /// Parameters
    /// ----------
    /// body, body_com, geom, site, camera : str or int
    ///     The object: the frame of a body, its centre of mass, a geom, a site or a camera.
    /// point : array_like, optional
    ///     With `body`: the point of the body that is currently at this position in the world (3,), m.
    /// out : numpy.ndarray or tensor, optional
    ///     An array to write to, or a tensor that shares its memory by DLPack: (2, 3, nv), in the precision
    ///     of the simulation.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (2, 3, nv), in world axes: translation, m/s per unit of each dof's velocity, then rotation, rad/s. For
    ///     example, ``jacp, jacr = sim.jacobian(site="hand")``.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, the model does not have its name, or an array has another shape.
    /// IndexError
    ///     If an index is negative or too large.
    /// TypeError
    ///     If `out` has another dtype.
    /// SimulationError
    ///     If the state is not finite.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, point = None, out = None))]
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
        out: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (model, choices) = (
            self.described(),
            Choices([body, body_com, geom, site, camera]),
        );
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let mut values = vec![Real::ZERO; 6 * model.nv];
            let anchor = anchor(model, &choices, point)?;
            let done = own.current().and_then(|sim| sim.jacobian(anchor, &mut values));
            done.map_err(sim_error)?;
            answer(py, values, &[2, 3, model.nv], out)
        })
    }

    /// Computes the time derivative of the Jacobian of an object, like MuJoCo's ``mj_jacDot``.
    ///
    /// Parameters
    /// ----------
    /// body, body_com, geom, site, camera : str or int
    ///     The object, see `jacobian`.
    /// point : array_like, optional
    ///     With `body`: the point of the body that is currently at this position in the world (3,), m.
    /// out : numpy.ndarray or tensor, optional
    ///     An array to write to, or a tensor that shares its memory by DLPack: (2, 3, nv), in the precision
    ///     of the simulation.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (2, 3, nv): of the translational part, then of the rotational part, in 1/s times the units of `jacobian`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, the model does not have its name, or an array has another shape.
    /// IndexError
    ///     If an index is negative or too large.
    /// TypeError
    ///     If `out` has another dtype.
    /// SimulationError
    ///     If the state is not finite.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, point = None, out = None))]
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
        out: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (model, choices) = (
            self.described(),
            Choices([body, body_com, geom, site, camera]),
        );
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let mut values = vec![Real::ZERO; 6 * model.nv];
            let anchor = anchor(model, &choices, point)?;
            let done = own.current().and_then(|sim| sim.jacobian_rate(anchor, &mut values));
            done.map_err(sim_error)?;
            answer(py, values, &[2, 3, model.nv], out)
        })
    }

    /// Computes the Jacobian of the centre of mass of a body's subtree, like MuJoCo's ``mj_jacSubtreeCom``.
    ///
    /// Parameters
    /// ----------
    /// body : str or int
    ///     The body; 0, the world, for the centre of mass of everything.
    /// out : numpy.ndarray or tensor, optional
    ///     An array to write to, or a tensor that shares its memory by DLPack: (3, nv), in the precision
    ///     of the simulation.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (3, nv), in world axes.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have the name, or `out` has another shape.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state is not finite.
    #[pyo3(signature = (body, *, out = None))]
    fn subtree_jacobian<'py>(
        &self,
        py: Python<'py>,
        body: &Bound<'py, PyAny>,
        out: Choice<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let body = Kind::Body.find(model, body)?;
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let mut values = vec![Real::ZERO; 3 * model.nv];
            let done = own.current().and_then(|sim| sim.subtree_jacobian(body, &mut values));
            done.map_err(sim_error)?;
            answer(py, values, &[3, model.nv], out)
        })
    }

    /// Computes the velocity of an object, like MuJoCo's ``mj_objectVelocity`` (which has the angular part first).
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
    ///     (2, 3): linear, m/s, of its position, then angular, rad/s.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, or the model does not have its name.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state is not finite.
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
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let found = own.current().and_then(|sim| sim.velocity(object, axes(local)));
            two_vectors(py, found.map_err(sim_error)?)
        })
    }

    /// Computes the acceleration of an object, like MuJoCo's ``mj_objectAcceleration`` (which has the angular part
    /// first). An accelerometer there would measure it: it includes the upward reaction to gravity.
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
    ///     (2, 3): linear, m/s², of its position, then angular, rad/s².
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, or the model does not have its name.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     As for `step`.
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
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let found = own.current().and_then(|sim| sim.acceleration(object, axes(local)));
            two_vectors(py, found.map_err(sim_error)?)
        })
    }
}

pub(crate) fn axes(local: bool) -> Axes {
    match local {
        true => Axes::Local,
        false => Axes::World,
    }
}

fn two_vectors<'py, S: Precision + Element>(
    py: Python<'py>,
    vectors: [Vec3<S>; 2],
) -> PyResult<Bound<'py, PyAny>> {
    let values = vectors.iter().flat_map(|v| v.to_array()).collect();
    answer(py, values, &[2, 3], None)
}
