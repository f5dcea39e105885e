//! Queries of `Sim` and `Batch` about the motion of objects.

use crate::batch::Batch;
use crate::kind::Kind;
use crate::one_or_many::{Form, Input, one_or_many};
use crate::sim::Sim;
use crate::target::{Choice, Choices};
use clench::rigid::model::FrameObject;
use clench::{Axes, Model, Place, Query};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns the place of a query, an object or a point of a body, and its input.
fn place<'a, 'py>(
    model: &Model,
    choices: &Choices<'a, 'py>,
    point: Choice<'a, 'py>,
) -> PyResult<(Place, Input<'a, 'py>)> {
    match (choices.one(model)?, point) {
        (object, None) => Ok((Place::Object(object), Input::None)),
        (FrameObject::Body(body), Some(point)) => {
            Ok((Place::PointOf(body), Input::Row("point", point, 3)))
        }
        (_, Some(_)) => Err(PyValueError::new_err("point needs body")),
    }
}

/// Writes the Jacobians of a class. Those of `Sim` have an argument `out`.
macro_rules! jacobians {
    ($class:ident $(, $(#[doc = $doc:literal])* $out:ident)?) => {
        #[pymethods]
        #[allow(clippy::too_many_arguments)] // They are keywords.
        impl $class {
            /// Computes the Jacobian of an object: the derivative of its velocity, and of its body's angular velocity,
            /// by the dof velocities.
            ///
            /// Exactly one object is chosen, by name or index. A `Sim` uses the body poses that queries use (see
            /// `Sim`), a `Batch` the current states. It is like MuJoCo's ``mj_jac``, ``mj_jacBody``, ``mj_jacBodyCom``,
            /// ``mj_jacGeom`` and ``mj_jacSite``. The Jacobians of all sites are outputs too, ``site_jacp`` and
            /// ``site_jacr``.
            ///
            /// Parameters
            /// ----------
            /// body, body_com, geom, site, camera : str or int
            ///     The object: the frame of a body, its centre of mass, a geom, a site or a camera.
            /// point : array_like, optional
            ///     With `body`: the point of the body that is currently at this position in the world, m: (3,), or in a
            ///     `Batch` also (n, 3) with one row for each environment.
            $($(#[doc = $doc])*)?
            ///
            /// Returns
            /// -------
            /// numpy.ndarray
            ///     (2, 3, nv), of a `Batch` (n, 2, 3, nv), in world axes: translation, m/s per unit of each dof's
            ///     velocity, then rotation, rad/s; NaN where a state of a `Batch` is not finite or the environment's
            ///     model lacks the geom. For example, ``jacp, jacr = sim.jacobian(site="hand")``.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If not exactly one object is chosen, the model does not have its name, or an array has another
            ///     shape.
            /// IndexError
            ///     If an index is negative or too large.
            /// TypeError
            ///     If an array has another dtype.
            /// SimulationError
            ///     If the state of a `Sim` is not finite.
            #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, point = None
                                $(, $out = None)?))]
            fn jacobian<'py>(
                &self,
                py: Python<'py>,
                body: Choice<'_, 'py>,
                body_com: Choice<'_, 'py>,
                geom: Choice<'_, 'py>,
                site: Choice<'_, 'py>,
                camera: Choice<'_, 'py>,
                point: Choice<'_, 'py>,
                $($out: Choice<'_, 'py>)?
            ) -> PyResult<Bound<'py, PyAny>> {
                let choices = Choices([body, body_com, geom, site, camera]);
                let (place, input) = place(self.described(), &choices, point)?;
                let shape = [2, 3, self.described().nv];
                let form = Form::Array(&shape, None$(.or($out))?);
                self.answer(py, Query::Jacobian(place), &input, form)
            }

            /// Computes the time derivative of the Jacobian of an object, like MuJoCo's ``mj_jacDot``.
            ///
            /// Parameters
            /// ----------
            /// body, body_com, geom, site, camera : str or int
            ///     The object, see `jacobian`.
            /// point : array_like, optional
            ///     With `body`: a point of the body, see `jacobian`.
            $($(#[doc = $doc])*)?
            ///
            /// Returns
            /// -------
            /// numpy.ndarray
            ///     (2, 3, nv), of a `Batch` (n, 2, 3, nv): of the translational part, then of the rotational part, in
            ///     1/s times the units of `jacobian`; NaN likewise.
            ///
            /// Raises
            /// ------
            /// ValueError, IndexError, TypeError, SimulationError
            ///     As for `jacobian`.
            #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, point = None
                                $(, $out = None)?))]
            fn jacobian_rate<'py>(
                &self,
                py: Python<'py>,
                body: Choice<'_, 'py>,
                body_com: Choice<'_, 'py>,
                geom: Choice<'_, 'py>,
                site: Choice<'_, 'py>,
                camera: Choice<'_, 'py>,
                point: Choice<'_, 'py>,
                $($out: Choice<'_, 'py>)?
            ) -> PyResult<Bound<'py, PyAny>> {
                let choices = Choices([body, body_com, geom, site, camera]);
                let (place, input) = place(self.described(), &choices, point)?;
                let shape = [2, 3, self.described().nv];
                let form = Form::Array(&shape, None$(.or($out))?);
                self.answer(py, Query::JacobianRate(place), &input, form)
            }

            /// Computes the Jacobian of the centre of mass of a body's subtree, like MuJoCo's ``mj_jacSubtreeCom``.
            ///
            /// Parameters
            /// ----------
            /// body : str or int
            ///     The body; 0, the world, for the centre of mass of everything.
            $($(#[doc = $doc])*)?
            ///
            /// Returns
            /// -------
            /// numpy.ndarray
            ///     (3, nv), of a `Batch` (n, 3, nv), in world axes; NaN where a state of a `Batch` is not finite.
            ///
            /// Raises
            /// ------
            /// ValueError
            ///     If the model does not have the name, or an array has another shape.
            /// IndexError
            ///     If an index is negative or too large.
            /// SimulationError
            ///     If the state of a `Sim` is not finite.
            #[pyo3(signature = (body $(, *, $out = None)?))]
            fn subtree_jacobian<'py>(
                &self,
                py: Python<'py>,
                body: &Bound<'py, PyAny>,
                $($out: Choice<'_, 'py>)?
            ) -> PyResult<Bound<'py, PyAny>> {
                let query = Query::SubtreeJacobian(Kind::Body.find(self.described(), body)?);
                let shape = [3, self.described().nv];
                self.answer(py, query, &Input::None, Form::Array(&shape, None$(.or($out))?))
            }
        }
    };
}

jacobians!(
    Sim,
    /// out : numpy.ndarray or tensor, optional
    ///     An array to write to, or a tensor that shares its memory by DLPack, in the shape of the result and the
    ///     precision of the simulation.
    out
);
jacobians!(Batch);

one_or_many! {
    /// Computes the velocity of an object, like MuJoCo's ``mj_objectVelocity`` (which has the angular part first). A
    /// `Sim` uses the state that queries use (see `Sim`), a `Batch` the current states.
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
    ///     (2, 3), of a `Batch` (n, 2, 3): linear, m/s, of its position, then angular, rad/s; NaN where a state of a
    ///     `Batch` is not finite or the environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, or the model does not have its name.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state of a `Sim` is not finite.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, local = false))]
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
        let query = Query::Velocity(object, axes(local));
        self.answer(py, query, &Input::None, Form::Array(&[2, 3], None))
    }

    /// Computes the acceleration of an object, like MuJoCo's ``mj_objectAcceleration`` (which has the angular part
    /// first). An accelerometer there would measure it: it includes the upward reaction to gravity. A `Batch` runs all
    /// of forward dynamics in the current states.
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
    ///     (2, 3), of a `Batch` (n, 2, 3): linear, m/s², of its position, then angular, rad/s²; NaN where a single
    ///     `Sim` would raise SimulationError or the environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one object is chosen, or the model does not have its name.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     As for `step` of a `Sim`.
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, local = false))]
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
        let query = Query::Acceleration(object, axes(local));
        self.answer(py, query, &Input::None, Form::Array(&[2, 3], None))
    }
}

fn axes(local: bool) -> Axes {
    match local {
        true => Axes::Local,
        false => Axes::World,
    }
}
