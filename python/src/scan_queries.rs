//! Scans of `Sim` and `Batch` with many rays, and heights of terrain.

use crate::kind::Kind;
use crate::one_or_many::{Form, Input, one_or_many};
use crate::queries::ray_filter;
use crate::target::{Choice, Choices};
use clench::Query;
use pyo3::prelude::*;

one_or_many! {
    /// Casts many rays, as a lidar does; see `ray`. A `Sim` uses the poses that queries use (see `Sim`), a `Batch` the
    /// current states.
    ///
    /// Parameters
    /// ----------
    /// origins : array_like
    ///     Origins (k, 3), m; a single one (1, 3) is used for all rays. In a `Batch` also (n, k, 3), with different
    ///     ones for each environment.
    /// directions : array_like
    ///     Directions (k, 3) or (n, k, 3) likewise; their lengths are the units of distances.
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
    ///     One hit for each ray, of a `Batch` with the environments as first axis. Its distances are NaN where a state
    ///     is not finite or the environment's model lacks the geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have a name, a direction is zero, or an array has another shape or is not finite.
    /// IndexError
    ///     If an index or a group is out of range.
    /// SimulationError
    ///     If the state of a `Sim` is not finite.
    #[pyo3(signature = (origins, directions, *, body = None, body_com = None, geom = None, site = None, camera = None,
                        groups = None, fixed = true, exclude_body = None))]
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
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.described();
        let frame = Choices([body, body_com, geom, site, camera]).optional(model)?;
        let filter = &ray_filter(model, groups, fixed, exclude_body)?;
        let rays = Input::Rays(origins, directions);
        self.answer(py, Query::Rays { frame, filter }, &rays, Form::Hits)
    }

    /// Computes heights of a height field's surface at given places. A `Sim` uses the poses that queries use (see
    /// `Sim`), a `Batch` the current states.
    ///
    /// Parameters
    /// ----------
    /// hfield : str or int
    ///     The geom that is the height field. Exact where its z axis points upwards.
    /// places : array_like
    ///     x and y (k, 2), m, in a `Batch` also (n, k, 2), with different ones for each environment. Beyond the field's
    ///     edges, the height at the edge continues.
    /// body, body_com, geom, site, camera : str or int, optional
    ///     An object whose position is the origin of the places, with their x axis along its own as seen from above; by
    ///     default they are in the world frame.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Heights in the world (k,), m; of a `Batch` (n, k), NaN where a state is not finite or the environment's
    ///     model lacks a geom.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the geom is no height field, the model does not have a name, or `places` has another shape or is not
    ///     finite.
    /// IndexError
    ///     If an index is negative or too large.
    /// SimulationError
    ///     If the state of a `Sim` is not finite.
    #[pyo3(signature = (hfield, places, *, body = None, body_com = None, geom = None, site = None, camera = None))]
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
        let geom = Kind::Geom.find(model, hfield)?;
        let places = Input::Rows("places", places, 2);
        self.answer(py, Query::Heights { geom, frame }, &places, Form::Array(&[], None))
    }
}
