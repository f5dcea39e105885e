//! The elements of a model, by name or index.

use super::Model;
use crate::element::Element;
use crate::kind::Kind;
use pyo3::prelude::*;

/// The docstring of a method that finds an element.
macro_rules! named {
    ($kind:literal) => {
        concat!(
            "The ",
            $kind,
            " of that name or index.\n\n",
            "Parameters\n----------\n",
            "which : str or int\n    Its name or index.\n\n",
            "Returns\n-------\nElement\n\n",
            "Raises\n------\n",
            "ValueError\n    A name that no ",
            $kind,
            " has.\n",
            "IndexError\n    An index that is negative or too large.",
        )
    };
}

#[pymethods]
impl Model {
    /// Returns the names of all elements of a kind.
    ///
    /// Parameters
    /// ----------
    /// kind : {"body", "joint", "geom", "site", "camera", "tendon", "actuator", "sensor", "equality", "keyframe", "pair", "mesh", "hfield"}
    ///     The kind of elements.
    ///
    /// Returns
    /// -------
    /// list of str
    ///     The names in the order of the indices; empty if an element has no name.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the kind does not exist.
    fn names(&self, kind: &str) -> PyResult<Vec<&str>> {
        Ok(Kind::of_name(kind)?.names(&self.0))
    }

    #[doc = named!("body")]
    fn body(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Body, which)
    }
    #[doc = named!("joint")]
    fn joint(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Joint, which)
    }
    #[doc = named!("geom")]
    fn geom(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Geom, which)
    }
    #[doc = named!("site")]
    fn site(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Site, which)
    }
    #[doc = named!("camera")]
    fn camera(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Camera, which)
    }
    #[doc = named!("tendon")]
    fn tendon(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Tendon, which)
    }
    #[doc = named!("actuator")]
    fn actuator(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Actuator, which)
    }
    #[doc = named!("equality constraint")]
    fn equality(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Equality, which)
    }
    #[doc = named!("sensor")]
    fn sensor(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Sensor, which)
    }
    #[doc = named!("keyframe")]
    fn keyframe(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Keyframe, which)
    }
    #[doc = named!("explicit geom pair")]
    fn pair(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Pair, which)
    }
    #[doc = named!("mesh")]
    fn mesh(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::Mesh, which)
    }
    #[doc = named!("height field")]
    fn hfield(&self, which: &Bound<'_, PyAny>) -> PyResult<Element> {
        Element::find(&self.0, Kind::HeightField, which)
    }
}
