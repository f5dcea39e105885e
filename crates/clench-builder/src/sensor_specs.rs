//! The author's description of sensors.

use super::{HistorySpec, Origin};
use clench_dynamics::model::{ContactField, ContactReduction, RayField, SensorData, SensorKind};
use std::sync::Arc;

/// A kind of object with a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// The inertial frame of a body.
    Inertial,
    /// The frame of a body.
    Body,
    /// The frame of a geom.
    Geom,
    /// A site.
    Site,
    /// A camera.
    Camera,
}

/// A frame by the name of its object.
#[derive(Clone, Debug)]
pub struct FrameName {
    /// The kind of object.
    pub kind: FrameKind,
    /// Its name.
    pub name: String,
}

/// A geom, or all geoms of a body, by name.
#[derive(Clone, Debug)]
pub enum GeomsName {
    /// One geom.
    Geom(String),
    /// All geoms of a body.
    Body(String),
}

/// One side of a contact, by name.
#[derive(Clone, Debug, Default)]
pub enum ContactSideName {
    /// Any geom.
    #[default]
    Any,
    /// A geom.
    Geom(String),
    /// Any geom of a body.
    Body(String),
    /// Any geom of a body and its descendants.
    Subtree(String),
}

/// The contacts that a sensor selects, and the quantities that it reports.
#[derive(Clone, Debug)]
pub struct ContactQuerySpec {
    /// The two sides; the normal points from the first to the second.
    pub sides: [ContactSideName; 2],
    /// A site whose volume the contact's position must be in; empty: anywhere.
    pub site: String,
    /// The quantities reported for each contact, without duplicates; empty: the number of contacts.
    pub fields: Vec<ContactField>,
    /// The selection among the contacts.
    pub reduction: ContactReduction,
    /// The number of reported contacts.
    pub count: usize,
}

/// Reports if there is any contact.
impl Default for ContactQuerySpec {
    fn default() -> Self {
        ContactQuerySpec {
            sides: Default::default(),
            site: String::new(),
            fields: Vec::new(),
            reduction: ContactReduction::None,
            count: 1,
        }
    }
}

/// The object that a sensor is attached to, by name; it must match its kind's
/// [`Attachment`](clench_dynamics::model::Attachment).
#[derive(Clone, Debug, Default)]
pub enum SensorSubject {
    /// Nothing.
    #[default]
    Nothing,
    /// A site, joint, tendon, actuator or body.
    Element(String),
    /// A frame, and an optional reference frame.
    Frame {
        /// The measured frame.
        object: FrameName,
        /// The reference frame; the world if `None`.
        reference: Option<FrameName>,
    },
    /// An object that may be inside a site.
    Inside {
        /// The site.
        site: String,
        /// The object.
        object: FrameName,
        /// False if the sensor tests if the object's position is inside, true if it measures how far the object
        /// protrudes, m. The object is then a site, a geom, the geoms of a body (`Inertial`), or those of a body and
        /// its descendants (`Body`), all of them bounded.
        enclosed: bool,
    },
    /// The image of a site in a camera.
    Projection {
        /// The site.
        site: String,
        /// The camera.
        camera: String,
    },
    /// Rays from a site or a camera.
    Rays {
        /// The source of the rays.
        source: FrameName,
        /// The quantities reported for each ray, without duplicates; empty: the distance.
        fields: Vec<RayField>,
    },
    /// Two geoms, or all geoms of a body.
    Geoms([GeomsName; 2]),
    /// Contacts.
    Contacts(ContactQuerySpec),
    /// The vertices of a mesh in the frame of a geom.
    Taxels {
        /// The mesh.
        mesh: String,
        /// The geom.
        geom: String,
    },
    /// The given number of a user's own numbers, in this range.
    User(usize, SensorData),
}

/// A sensor.
#[derive(Clone, Debug)]
pub struct SensorSpec {
    /// Name, possibly empty.
    pub name: String,
    /// The kind.
    pub kind: SensorKind,
    /// The measured object.
    pub subject: SensorSubject,
    /// Limit of its numbers, if positive.
    pub cutoff: f64,
    /// Standard deviation of the noise that the author expects; none is added.
    pub noise: f64,
    /// The storage and the delay of values.
    pub history: HistorySpec,
    /// Measurement interval, s, and time of the last measurement before time zero; zero: every step, and one period
    /// before. MuJoCo's `interval`, which only applies if past values are stored.
    pub interval: [f64; 2],
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

impl SensorSpec {
    /// Creates a sensor without a name that measures an element.
    pub fn new(kind: SensorKind, element: impl Into<String>) -> Self {
        SensorSpec {
            name: String::new(),
            kind,
            subject: SensorSubject::Element(element.into()),
            cutoff: 0.0,
            noise: 0.0,
            history: HistorySpec::default(),
            interval: [0.0; 2],
            user: Arc::default(),
            origin: None,
        }
    }
    /// Sets the name.
    pub fn named(self, name: impl Into<String>) -> Self {
        SensorSpec {
            name: name.into(),
            ..self
        }
    }
}
