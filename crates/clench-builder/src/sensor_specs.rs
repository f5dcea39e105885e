//! What an author says of sensors.

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
    /// What kind of object.
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
    /// Any geom of a body and all below it.
    Subtree(String),
}

/// Which contacts a sensor looks for, and what it tells of them.
#[derive(Clone, Debug)]
pub struct ContactQuerySpec {
    /// What touches; the normal points from the first to the second.
    pub sides: [ContactSideName; 2],
    /// A site whose volume the contact's position must be in; empty: anywhere.
    pub site: String,
    /// What is told of each contact, each thing once; nothing: how many there are.
    pub fields: Vec<ContactField>,
    /// Which contacts are told of.
    pub reduction: ContactReduction,
    /// How many.
    pub count: usize,
}

/// Whether there is any contact.
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

/// The object that a sensor is attached to, by name; it must be what its kind's [`Attachment`](clench_dynamics::model::Attachment) says.
#[derive(Clone, Debug, Default)]
pub enum SensorSubject {
    /// Nothing.
    #[default]
    Nothing,
    /// A site, joint, tendon, actuator or body.
    Element(String),
    /// A frame, and perhaps one relative to which it is measured.
    Frame {
        /// What is measured.
        object: FrameName,
        /// Where from; the world where nothing is said.
        reference: Option<FrameName>,
    },
    /// Whether an object is inside a site.
    Inside {
        /// The site.
        site: String,
        /// The object.
        object: FrameName,
        /// Whether its whole extent counts: how far it juts out is measured, m, rather than whether its position is inside. Then it
        /// is a site, a geom, the geoms of a body (`Inertial`), or those of a body and all below it (`Body`), and all of them are bounded.
        enclosed: bool,
    },
    /// A site as a camera sees it.
    Projection {
        /// The site.
        site: String,
        /// The camera.
        camera: String,
    },
    /// Rays from a site or a camera.
    Rays {
        /// Where they go out.
        source: FrameName,
        /// What is told of each, each thing once; nothing: the distance.
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
    /// So many numbers of a user's own, of this kind.
    User(usize, SensorData),
}

/// A sensor.
#[derive(Clone, Debug)]
pub struct SensorSpec {
    /// Name, possibly empty.
    pub name: String,
    /// What it measures.
    pub kind: SensorKind,
    /// Of what.
    pub subject: SensorSubject,
    /// Bound of its numbers, where positive.
    pub cutoff: f64,
    /// Standard deviation of the noise that the author expects; none is added.
    pub noise: f64,
    /// Which past values are kept, and how late they are told.
    pub history: HistorySpec,
    /// How often it measures, s, and when it did so last before time zero; zero: every step, and one period before. MuJoCo's
    /// `interval`, which only counts where past values are kept.
    pub interval: [f64; 2],
    /// The user's own numbers, which move nothing.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

impl SensorSpec {
    /// A sensor without a name that measures an element.
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
    /// With a name.
    pub fn named(self, name: impl Into<String>) -> Self {
        SensorSpec {
            name: name.into(),
            ..self
        }
    }
}
