//! Targets of inverse kinematics as Python objects. Their numbers are read when a problem is solved.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A target position, orientation or both of a frame, for inverse kinematics.
///
/// Exactly one object is chosen, by name or index. The position and the orientation are separate goals.
///
/// Parameters
/// ----------
/// body, body_com, geom, site, camera : str or int
///     The object: the frame of a body, its centre of mass, a geom, a site or a camera.
/// position : array_like, optional
///     Desired position in the world (3,), m; in a batch also (n, 3).
/// quat : array_like, optional
///     Desired orientation, a quaternion (4,); in a batch also (n, 4).
/// position_cost : float or array_like
///     Weight of the position error, 1/m; one number, or one for each world axis (3,), 0 to ignore it.
/// orientation_cost : float
///     Weight of the angle error, 1/rad.
///
/// Raises
/// ------
/// ValueError
///     If there is neither a position nor an orientation.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct FrameTarget {
    /// str, int or None : The body, for its frame.
    pub(crate) body: Option<Py<PyAny>>,
    /// str, int or None : The body, for its inertial frame.
    pub(crate) body_com: Option<Py<PyAny>>,
    /// str, int or None : The geom.
    pub(crate) geom: Option<Py<PyAny>>,
    /// str, int or None : The site.
    pub(crate) site: Option<Py<PyAny>>,
    /// str, int or None : The camera.
    pub(crate) camera: Option<Py<PyAny>>,
    /// array_like or None : Desired position.
    pub(crate) position: Option<Py<PyAny>>,
    /// array_like or None : Desired orientation.
    pub(crate) quat: Option<Py<PyAny>>,
    /// float or array_like : Weight of the position error.
    pub(crate) position_cost: Py<PyAny>,
    /// float : Weight of the angle error.
    pub(crate) orientation_cost: f64,
}

#[pymethods]
impl FrameTarget {
    #[new]
    #[pyo3(signature = (*, body = None, body_com = None, geom = None, site = None, camera = None, position = None, quat = None,
                        position_cost = None, orientation_cost = 1.0),
           text_signature = "(*, body=None, body_com=None, geom=None, site=None, camera=None, position=None, quat=None, position_cost=1.0, orientation_cost=1.0)")]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn new(
        py: Python<'_>,
        body: Option<Py<PyAny>>,
        body_com: Option<Py<PyAny>>,
        geom: Option<Py<PyAny>>,
        site: Option<Py<PyAny>>,
        camera: Option<Py<PyAny>>,
        position: Option<Py<PyAny>>,
        quat: Option<Py<PyAny>>,
        position_cost: Option<Py<PyAny>>,
        orientation_cost: f64,
    ) -> PyResult<Self> {
        if position.is_none() && quat.is_none() {
            return Err(PyValueError::new_err("give a position, a quat or both"));
        }
        let one = || Ok::<_, PyErr>(1.0_f64.into_pyobject(py)?.into_any().unbind());
        Ok(FrameTarget {
            body,
            body_com,
            geom,
            site,
            camera,
            position,
            quat,
            position_cost: position_cost.map_or_else(one, Ok)?,
            orientation_cost,
        })
    }
}

/// A target position of a centre of mass, for inverse kinematics.
///
/// Parameters
/// ----------
/// position : array_like
///     Desired position in the world (3,), m; in a batch also (n, 3).
/// body : str or int
///     The root of the subtree whose centre of mass it is; by default the world, for everything.
/// cost : float or array_like
///     Weight of the error, 1/m; one number, or one for each world axis (3,), 0 to ignore it.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct ComTarget {
    /// array_like : Desired position.
    pub(crate) position: Py<PyAny>,
    /// str or int : The root of the subtree.
    pub(crate) body: Py<PyAny>,
    /// float or array_like : Weight of the error.
    pub(crate) cost: Py<PyAny>,
}

#[pymethods]
impl ComTarget {
    #[new]
    #[pyo3(signature = (position, body = None, *, cost = None), text_signature = "(position, body=0, *, cost=1.0)")]
    fn new(
        py: Python<'_>,
        position: Py<PyAny>,
        body: Option<Py<PyAny>>,
        cost: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let world = || Ok::<_, PyErr>(0_i64.into_pyobject(py)?.into_any().unbind());
        let one = || Ok::<_, PyErr>(1.0_f64.into_pyobject(py)?.into_any().unbind());
        Ok(ComTarget {
            position,
            body: body.map_or_else(world, Ok)?,
            cost: cost.map_or_else(one, Ok)?,
        })
    }
}

/// A target posture for inverse kinematics, usually with a small cost in addition to other targets.
///
/// Parameters
/// ----------
/// qpos : array_like
///     The positions of all joints (nq,); in a batch also (n, nq).
/// cost : float or array_like
///     Weight of the errors, 1/m and 1/rad; one number, or one for each dof (nv,), 0 to ignore it.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct PostureTarget {
    /// array_like : The positions.
    pub(crate) qpos: Py<PyAny>,
    /// float or array_like : Weight of the errors.
    pub(crate) cost: Py<PyAny>,
}

#[pymethods]
impl PostureTarget {
    #[new]
    #[pyo3(signature = (qpos, *, cost = None), text_signature = "(qpos, *, cost=1.0)")]
    fn new(py: Python<'_>, qpos: Py<PyAny>, cost: Option<Py<PyAny>>) -> PyResult<Self> {
        let one = || Ok::<_, PyErr>(1.0_f64.into_pyobject(py)?.into_any().unbind());
        let cost = cost.map_or_else(one, Ok)?;
        Ok(PostureTarget { qpos, cost })
    }
}
