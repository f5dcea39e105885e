//! The rays of a scan, and their hits.

use crate::answer::answer;
use crate::arrays::shape_text;
use crate::table::Table;
use clench::Precision;
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
