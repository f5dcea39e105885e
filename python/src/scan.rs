//! Scans with many rays, and heights of terrain.

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

/// The hits of many rays. In a batch the environments are the first axis.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct RayHits {
    /// numpy.ndarray : The first geom that each ray hits (k,), int64; -1 if there is none.
    geom: Py<PyAny>,
    /// numpy.ndarray : From the ray's origin, in lengths of its direction (k,); infinite if it hits nothing.
    distance: Py<PyAny>,
    /// numpy.ndarray : Outward unit normal of the geom there, in world axes (k, 3); zero if the ray hits nothing.
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
    /// Creates the hits from five numbers per ray.
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

/// Combines origins and directions (k, 3) into rays of six numbers. Either may be different for each environment.
pub(crate) fn rays<S: Precision + Element>(
    origins: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
    n: Option<usize>,
) -> PyResult<Table<S>> {
    let origins = Table::<S>::rows_of("origins", origins, 3, n)?;
    let directions = Table::<S>::rows_of("directions", directions, 3, n)?;
    require_lengths(&directions)?;
    let count = origins.rows.max(directions.rows);
    // A single origin can be shared by all directions, as for a lidar.
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

/// Returns an error if a direction is zero; it names the first one.
fn require_lengths<S: Precision>(directions: &Table<S>) -> PyResult<()> {
    let none = |row: &[S]| row.iter().all(|x| x.abs() < S::MIN_POSITIVE);
    let Some(k) = directions.values.chunks_exact(3).position(none) else {
        return Ok(());
    };
    let (env, row) = (k / directions.rows, k % directions.rows);
    let place = match directions.each {
        true => format!("{env}, {row}"),
        false => row.to_string(),
    };
    Err(PyValueError::new_err(format!(
        "directions[{place}] has no length"
    )))
}

/// Converts hits to the format of a batch: five numbers per ray.
fn in_numbers<S: Precision>(hits: &[Option<RayHit<S>>]) -> Vec<S> {
    let no_hit = [-1.0, f64::INFINITY, 0.0, 0.0, 0.0].map(S::new);
    let numbers = |hit: &RayHit<S>| {
        let [x, y, z] = hit.normal.to_array();
        [S::new(hit.geom as f64), hit.distance, x, y, z]
    };
    let hits = hits
        .iter()
        .flat_map(|hit| hit.as_ref().map_or(no_hit, numbers));
    hits.collect()
}

#[pymethods]
impl Sim {
    /// Casts many rays; see `ray`.
    ///
    /// Parameters
    /// ----------
    /// origins : array_like
    ///     Origins (k, 3), m; a single one (1, 3) is used for all rays.
    /// directions : array_like
    ///     Directions (k, 3); their lengths are the units of distances. A single one (1, 3) is used for all rays.
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
    ///     One hit for each ray.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have a name, a direction is zero, or an array has another shape or is not finite.
    /// IndexError
    ///     If an index or a group is out of range.
    /// SimulationError
    ///     If the state is not finite.
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

    /// Computes heights of a height field's surface at given places, in the poses that queries use (see `Sim`).
    ///
    /// Parameters
    /// ----------
    /// hfield : str or int
    ///     The geom that is the height field. Exact where its z axis points upwards.
    /// places : array_like
    ///     x and y (k, 2), m. Beyond the field's edges, the height at the edge continues.
    /// body, body_com, geom, site, camera : str or int, optional
    ///     An object whose position is the origin of the places, with their x axis along its own as seen from above; by
    ///     default they are in the world frame.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Heights in the world (k,), m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the geom is no height field, the model does not have a name, or `places` has another shape or is not
    ///     finite.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state is not finite.
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
