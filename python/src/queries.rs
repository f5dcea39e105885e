//! Arguments and results of rays and distances.

use crate::arrays::{column, indices, require_finite, shaped};
use crate::kind::Kind;
use clench::RayHit as Hit;
use clench::collide::Separation as Found;
use clench::math::Vec3;
use clench::{Model, Precision, RayFilter};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The first hit of a ray.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct RayHit {
    /// int : The geom.
    geom: usize,
    /// str : Its name; an unnamed geom is called by its body and its index there, as in ``torso[1]``.
    geom_name: String,
    /// float : From the ray's origin, in lengths of its direction.
    distance: f64,
    /// numpy.ndarray : The point of the hit (3,), m.
    position: Py<PyAny>,
    /// numpy.ndarray : Outward unit normal of the geom there (3,).
    normal: Py<PyAny>,
}

impl RayHit {
    /// Creates the hit of a ray from `origin`.
    pub(crate) fn new<S: Precision>(
        py: Python<'_>,
        hit: &Hit<S>,
        geom_name: String,
        origin: Vec3<S>,
        direction: Vec3<S>,
    ) -> PyResult<Self> {
        Ok(RayHit {
            geom: hit.geom,
            geom_name,
            distance: hit.distance.to_f64(),
            position: array(py, origin + direction * hit.distance)?,
            normal: array(py, hit.normal)?,
        })
    }
}

#[pymethods]
impl RayHit {
    fn __repr__(&self) -> String {
        let (geom, name) = (self.geom, &self.geom_name);
        format!("<clench.RayHit: geom {geom} '{name}' at {}>", self.distance)
    }
}

/// The shortest distance between two geoms.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct Separation {
    /// float : Signed, m; a negative value is the penetration depth.
    distance: f64,
    /// numpy.ndarray : Unit vector from the first to the second (3,).
    normal: Py<PyAny>,
    /// numpy.ndarray : The nearest point of each, or the deepest if they overlap (2, 3), m.
    points: Py<PyAny>,
}

impl Separation {
    pub(crate) fn new<S: Precision>(py: Python<'_>, found: &Found<S>) -> PyResult<Self> {
        Ok(Separation {
            distance: found.distance.to_f64(),
            normal: array(py, found.normal)?,
            points: column(py, &found.points, [3], |v| v.to_array().map(S::to_f64))?,
        })
    }
}

#[pymethods]
impl Separation {
    fn __repr__(&self) -> String {
        format!("<clench.Separation: {} m>", self.distance)
    }
}

/// Creates the filter of geoms that rays can hit.
pub(crate) fn ray_filter(
    model: &Model,
    groups: Option<&Bound<'_, PyAny>>,
    fixed: bool,
    exclude_body: Option<&Bound<'_, PyAny>>,
) -> PyResult<RayFilter> {
    let excluded = exclude_body.map(|which| Kind::Body.find(model, which));
    let mut filter = RayFilter {
        fixed,
        excluded_body: excluded.transpose()?,
        ..RayFilter::default()
    };
    if let Some(groups) = groups {
        let chosen = indices("groups", groups, filter.groups.len())?;
        filter.groups = std::array::from_fn(|group| chosen.contains(&group));
    }
    Ok(filter)
}

/// Converts a value to a vector (3,) of finite numbers.
pub(crate) fn vector<S: Precision>(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec3<S>> {
    let values = shaped::<f64>(name, value, &[3])?;
    let values = values.as_slice()?;
    require_finite(name, values)?;
    Ok(Vec3::from_f64([values[0], values[1], values[2]]))
}

/// Converts a value to a nonzero vector.
pub(crate) fn direction<S: Precision>(value: &Bound<'_, PyAny>) -> PyResult<Vec3<S>> {
    let found = vector::<S>("direction", value)?;
    if found.to_array().iter().all(|x| x.abs() < S::MIN_POSITIVE) {
        return Err(PyValueError::new_err("direction has no length"));
    }
    Ok(found)
}

fn array<S: Precision>(py: Python<'_>, v: Vec3<S>) -> PyResult<Py<PyAny>> {
    column(py, &v.to_array(), [], |x| [x.to_f64()])
}
