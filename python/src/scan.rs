//! Many rays at once, and heights of terrain.

use crate::answer::answer;
use crate::arrays::shape_text;
use crate::busy::lock;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::ray_filter;
use crate::row_sim::{AnySim, each_sim};
use crate::sim::Sim;
use crate::table::Table;
use crate::target::{Choice, Choices};
use clench::{Precision, RayHit};
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// What many rays hit. In a batch the environments are the first axis.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct RayHits {
    /// numpy.ndarray : The geom that each ray hits first (k,), int64; -1 where there is none.
    geom: Py<PyAny>,
    /// numpy.ndarray : From the ray's origin, in lengths of its direction (k,); infinite where it hits nothing.
    distance: Py<PyAny>,
    /// numpy.ndarray : Unit vector out of the geom there, world axes (k, 3); zero where the ray hits nothing.
    normal: Py<PyAny>,
}

#[pymethods]
impl RayHits {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape: Vec<usize> = self.geom.getattr(py, "shape")?.extract(py)?;
        Ok(format!("<clench.RayHits of shape {}>", shape_text(&shape)))
    }
}

impl RayHits {
    /// From five numbers a ray.
    pub(crate) fn new<S: Precision + Element>(
        py: Python<'_>,
        hits: &[S],
        shape: &[usize],
    ) -> PyResult<Self> {
        let rows = || hits.chunks_exact(5);
        let geom = rows().map(|hit| hit[0].to_f64() as i64).collect();
        let distance = rows().map(|hit| hit[1]).collect();
        let normal = rows().flat_map(|hit| hit[2..].iter().copied()).collect();
        Ok(RayHits {
            geom: answer::<i64>(py, geom, shape, None)?.unbind(),
            distance: answer::<S>(py, distance, shape, None)?.unbind(),
            normal: answer::<S>(py, normal, &[shape, &[3]].concat(), None)?.unbind(),
        })
    }
}

/// Origins and directions (k, 3), of which either may be each environment's own, as rays of six numbers.
pub(crate) fn rays<S: Precision + Element>(
    origins: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
    n: Option<usize>,
) -> PyResult<Table<S>> {
    let origins = Table::<S>::rows_of("origins", origins, 3, n)?;
    let directions = Table::<S>::rows_of("directions", directions, 3, n)?;
    let count = origins.rows.max(directions.rows);
    // A single origin serves all directions, as that of a lidar does.
    for (name, rows) in [("origins", origins.rows), ("directions", directions.rows)] {
        if rows != count && rows != 1 {
            return Err(PyValueError::new_err(format!(
                "there are {rows} {name} for {count} rays"
            )));
        }
    }
    let each = origins.each || directions.each;
    let mut values = Vec::new();
    for env in 0..n.filter(|_| each).unwrap_or(1) {
        for k in 0..count {
            for part in [&origins, &directions] {
                let row = part.row(env, 3 * part.rows);
                let k = if part.rows == 1 { 0 } else { k };
                values.extend_from_slice(&row[3 * k..3 * k + 3]);
            }
        }
    }
    Ok(Table {
        values,
        each,
        rows: count,
    })
}

/// What rays hit as a batch tells it: five numbers a ray.
fn in_numbers<S: Precision>(hits: &[Option<RayHit<S>>]) -> Vec<S> {
    let nothing = [-1.0, f64::INFINITY, 0.0, 0.0, 0.0].map(S::new);
    let numbers = |hit: &RayHit<S>| {
        let [x, y, z] = hit.normal.to_array();
        [S::new(hit.geom as f64), hit.distance, x, y, z]
    };
    let hits = hits
        .iter()
        .flat_map(|hit| hit.as_ref().map_or(nothing, numbers));
    hits.collect()
}

#[pymethods]
impl Sim {
    /// What many rays hit, see `ray`.
    ///
    /// Parameters
    /// ----------
    /// origins : array_like
    ///     Where the rays begin (k, 3), m; one (1, 3) may serve all.
    /// directions : array_like
    ///     Where they lead (k, 3); their lengths are the units of distances. One (1, 3) may serve all.
    /// body, body_com, geom, site, camera : str or int, optional
    ///     An object in whose frame rays are told, so that they move with it; else they are in the world.
    /// groups : array_like of int, optional
    ///     The groups of geoms, 0 to 5, that can be hit; all of them if not given.
    /// fixed : bool
    ///     Whether geoms can be hit that are fixed to the world.
    /// exclude_body : str or int, optional
    ///     A body, by name or index, whose geoms are not hit.
    ///
    /// Returns
    /// -------
    /// RayHits
    ///     One a ray.
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
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let rays = rays(origins, directions, None)?;
            let found = own.current().and_then(|sim| sim.rays(&rays.values, frame, &filter));
            let found = found.map_err(sim_error)?;
            RayHits::new(py, &in_numbers(&found), &[rays.rows])
        })
    }

    /// Heights of terrain: of the surface of a height field over places, where queries see it (see `Sim`).
    ///
    /// Parameters
    /// ----------
    /// hfield : str or int
    ///     The geom that is the height field. Exact where its z axis points upwards.
    /// places : array_like
    ///     x and y (k, 2), m. Beyond the field's edges its height there goes on.
    /// body, body_com, geom, site, camera : str or int, optional
    ///     An object from whose position, along whose x axis as seen from above, places are told; else they are in the world.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Heights in the world (k,), m.
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
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let places = Table::rows_of("places", places, 2, None)?;
            let found = own.current().and_then(|sim| sim.heights(hfield, &places.values, frame));
            answer(py, found.map_err(sim_error)?, &[places.rows], None)
        })
    }
}
