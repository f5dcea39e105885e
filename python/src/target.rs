//! The object of a query: exactly one of several keyword arguments.

use crate::kind::Kind;
use clench::Model;
use clench::rigid::model::FrameObject;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The optional name or index of an object.
pub(crate) type Choice<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// The choices of a caller, in the order of the keywords: body, body_com, geom, site, camera.
#[derive(Clone, Copy)]
pub(crate) struct Choices<'a, 'py>(pub(crate) [Choice<'a, 'py>; 5]);

impl Choices<'_, '_> {
    /// Returns the object, if one was chosen.
    ///
    /// # Errors
    /// Returns a ValueError if several were chosen, and the errors of [`Kind::find`].
    pub(crate) fn optional(&self, model: &Model) -> PyResult<Option<FrameObject>> {
        type Make = fn(usize) -> FrameObject;
        const OBJECTS: [(Kind, Make); 5] = [
            (Kind::Body, FrameObject::Body),
            (Kind::Body, FrameObject::Inertial),
            (Kind::Geom, FrameObject::Geom),
            (Kind::Site, FrameObject::Site),
            (Kind::Camera, FrameObject::Camera),
        ];
        let mut chosen = (self.0.iter().zip(OBJECTS))
            .filter_map(|(which, (kind, make))| Some(((*which)?, kind, make)));
        match (chosen.next(), chosen.next()) {
            (None, _) => Ok(None),
            (Some((which, kind, make)), None) => Ok(Some(make(kind.find(model, which)?))),
            (Some(_), Some(_)) => Err(PyValueError::new_err(
                "give one of body, body_com, geom, site and camera, not several",
            )),
        }
    }

    /// Returns the object.
    ///
    /// # Errors
    /// Returns a ValueError if none was chosen, and the errors of [`optional`](Self::optional).
    pub(crate) fn one(&self, model: &Model) -> PyResult<FrameObject> {
        let none = "give one of body, body_com, geom, site and camera, by keyword";
        self.optional(model)?
            .ok_or_else(|| PyValueError::new_err(none))
    }
}
