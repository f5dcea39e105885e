//! The kinds of elements of a model, and the search for an element.

use crate::names::unknown;
use clench::Model;
use pyo3::exceptions::{PyIndexError, PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// The kind of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Body,
    Joint,
    Geom,
    Site,
    Camera,
    Tendon,
    Actuator,
    Sensor,
    Equality,
    Keyframe,
    Pair,
    Mesh,
    HeightField,
}

impl Kind {
    const ALL: [Kind; 13] = [
        Kind::Body,
        Kind::Joint,
        Kind::Geom,
        Kind::Site,
        Kind::Camera,
        Kind::Tendon,
        Kind::Actuator,
        Kind::Sensor,
        Kind::Equality,
        Kind::Keyframe,
        Kind::Pair,
        Kind::Mesh,
        Kind::HeightField,
    ];

    /// Returns the kind with this name.
    pub(crate) fn of_name(name: &str) -> PyResult<Kind> {
        let found = Kind::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| unknown("kind of element", name, &Kind::ALL.map(Kind::name)))
    }

    /// Returns the name of the kind.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Kind::Body => "body",
            Kind::Joint => "joint",
            Kind::Geom => "geom",
            Kind::Site => "site",
            Kind::Camera => "camera",
            Kind::Tendon => "tendon",
            Kind::Actuator => "actuator",
            Kind::Sensor => "sensor",
            Kind::Equality => "equality",
            Kind::Keyframe => "keyframe",
            Kind::Pair => "pair",
            Kind::Mesh => "mesh",
            Kind::HeightField => "hfield",
        }
    }

    /// Returns the prefix of the names of its fields.
    pub(crate) fn prefix(self) -> &'static str {
        match self {
            Kind::Body => "body_",
            Kind::Joint => "jnt_",
            Kind::Geom => "geom_",
            Kind::Site => "site_",
            Kind::Camera => "cam_",
            Kind::Tendon => "tendon_",
            Kind::Actuator => "actuator_",
            Kind::Sensor => "sensor_",
            Kind::Equality => "eq_",
            Kind::Keyframe => "key_",
            Kind::Pair => "pair_",
            Kind::Mesh => "mesh_",
            Kind::HeightField => "hfield_",
        }
    }

    /// Returns the names of all elements of this kind; some may be empty.
    pub(crate) fn names(self, model: &Model) -> Vec<&str> {
        match self {
            Kind::Body => model.bodies.iter().map(|e| &*e.name).collect(),
            Kind::Joint => model.joints.iter().map(|e| &*e.name).collect(),
            Kind::Geom => model.geoms.iter().map(|e| &*e.name).collect(),
            Kind::Site => model.sites.iter().map(|e| &*e.name).collect(),
            Kind::Camera => model.cameras.iter().map(|e| &*e.name).collect(),
            Kind::Tendon => model.tendons.iter().map(|e| &*e.name).collect(),
            Kind::Actuator => model.actuators.iter().map(|e| &*e.name).collect(),
            Kind::Sensor => model.sensors.iter().map(|e| &*e.name).collect(),
            Kind::Equality => model.equalities.iter().map(|e| &*e.name).collect(),
            Kind::Keyframe => model.keyframes.iter().map(|e| &*e.name).collect(),
            Kind::Pair => model.pairs.iter().map(|e| &*e.name).collect(),
            Kind::Mesh => model.meshes.iter().map(|e| &*e.name).collect(),
            Kind::HeightField => model.height_fields.iter().map(|e| &*e.name).collect(),
        }
    }

    /// Finds an element by name or index.
    ///
    /// # Errors
    /// Returns a ValueError if no element has the name, an IndexError if the index is negative or too large, or a
    /// TypeError if the argument is neither a name nor an index.
    pub(crate) fn find(self, model: &Model, which: &Bound<'_, PyAny>) -> PyResult<usize> {
        let names = self.names(model);
        let kind = self.name();
        if let Ok(name) = which.cast::<PyString>() {
            let name = name.to_str()?;
            let found = names
                .iter()
                .position(|&known| known == name && !name.is_empty());
            let found = found.ok_or_else(|| unknown(kind, name, &names))?;
            // The common layout of several models may have several.
            if matches!(self, Kind::Geom) && names[found + 1..].contains(&name) {
                return Err(PyValueError::new_err(format!(
                    "there are several geoms \"{name}\", since it has other types in some models: choose one by index"
                )));
            }
            return Ok(found);
        }
        let count = names.len();
        let none = |which: &str| {
            PyIndexError::new_err(format!("there is no {kind} {which}: there are {count}"))
        };
        match which.extract::<i64>() {
            Ok(index) => match usize::try_from(index) {
                Ok(found) if found < count => Ok(found),
                _ => Err(none(&index.to_string())),
            },
            Err(error) if error.is_instance_of::<PyOverflowError>(which.py()) => {
                Err(none("with this index"))
            }
            Err(_) => {
                let found = which.get_type().name()?;
                let article = if kind.starts_with(['a', 'e']) {
                    "an"
                } else {
                    "a"
                };
                Err(PyTypeError::new_err(format!(
                    "{article} {kind} is chosen by a str or an int, not by {found}"
                )))
            }
        }
    }
}
