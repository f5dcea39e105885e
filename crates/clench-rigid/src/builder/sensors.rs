//! Sensors: what an author says of them, and which elements they are attached to.

use super::element::Element;
use super::resolve::AllNames;
use super::{BuildError, ModelBuilder, Origin};
use crate::model::{
    Attachment, FrameObject, JointKind, Model, Sensor, SensorData, SensorKind, SensorTarget,
};
use std::ops::Range;

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

/// What a sensor is attached to, by name; it must be what its kind's [`Attachment`] says.
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
    },
    /// Two geoms, or all geoms of a body.
    Geoms([GeomsName; 2]),
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

/// A user's sensor has at most this many numbers.
const MAX_USER_DIM: usize = 1 << 20;

/// Adds all sensors.
///
/// # Errors
/// A subject that is not there or not of the kind that the sensor measures; a cutoff where there can be none, negative numbers.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.sensors {
        spec.require_not_negative("cutoff", &[spec.cutoff])?;
        spec.require_not_negative("noise", &[spec.noise])?;
        let target = target(spec, names, model)?;
        let (dim, data) = match spec.subject {
            SensorSubject::User(dim, _) if dim > MAX_USER_DIM => {
                return Err(spec.error(format!("has more than {MAX_USER_DIM} numbers")));
            }
            SensorSubject::User(dim, data) => (dim, data),
            _ => (spec.kind.dim(), spec.kind.data()),
        };
        // Of a distance the cutoff is how far it is searched for.
        let searched = spec.kind.attachment() == Attachment::Geoms;
        let turns = matches!(data, SensorData::Axis | SensorData::Quaternion);
        if spec.cutoff > 0.0 && turns && !searched {
            return Err(spec.error("a direction or an orientation has no cutoff"));
        }
        let start = model.nsensordata();
        model.sensors.push(Sensor {
            name: spec.name.clone(),
            kind: spec.kind,
            target,
            data,
            cutoff: spec.cutoff,
            noise: spec.noise,
            numbers: start..start + dim,
            origin: spec.origin.clone(),
        });
    }
    Ok(())
}

fn target(spec: &SensorSpec, names: &AllNames, model: &Model) -> Result<SensorTarget, BuildError> {
    use SensorSubject as Of;
    let attachment = spec.kind.attachment();
    let element = |name: &String| match attachment {
        Attachment::Site => names.sites.find(name, spec),
        Attachment::Tendon => names.tendons.find(name, spec),
        Attachment::Actuator => names.actuators.find(name, spec),
        Attachment::Body => names.bodies.find(name, spec),
        _ => {
            let joint = names.joints.find(name, spec)?;
            check_joint(spec, name, model.joints[joint].kind)?;
            Ok(joint)
        }
    };
    match (attachment, &spec.subject) {
        (Attachment::Nothing, Of::Nothing) | (Attachment::User, Of::User(..)) => {
            Ok(SensorTarget::Nothing)
        }
        (
            Attachment::Site
            | Attachment::ScalarJoint
            | Attachment::Ball
            | Attachment::Joint
            | Attachment::Tendon
            | Attachment::Actuator
            | Attachment::Body,
            Of::Element(name),
        ) => Ok(SensorTarget::Element(element(name)?)),
        (Attachment::Frame | Attachment::WorldFrame, Of::Frame { object, reference }) => {
            if attachment == Attachment::WorldFrame && reference.is_some() {
                return Err(spec.error("is measured in the world: it has no reference frame"));
            }
            let find = |name: &FrameName| frame(spec, names, name);
            Ok(SensorTarget::Frame {
                object: find(object)?,
                reference: reference.as_ref().map(find).transpose()?,
            })
        }
        (Attachment::Inside, Of::Inside { site, object }) => Ok(SensorTarget::Inside {
            site: names.sites.find(site, spec)?,
            object: frame(spec, names, object)?,
        }),
        (Attachment::Geoms, Of::Geoms([first, second])) => {
            let sets = [
                geoms(spec, names, model, first)?,
                geoms(spec, names, model, second)?,
            ];
            if sets[0] == sets[1] {
                return Err(spec.error("the two geoms or bodies must be different"));
            }
            Ok(SensorTarget::Geoms(sets))
        }
        _ => Err(spec.error(format!("must be attached to {attachment}"))),
    }
}

fn check_joint(spec: &SensorSpec, name: &str, kind: JointKind) -> Result<(), BuildError> {
    let (fits, wanted) = match spec.kind.attachment() {
        Attachment::ScalarJoint => (
            matches!(kind, JointKind::Slide | JointKind::Hinge),
            "a slide or a hinge",
        ),
        Attachment::Ball => (kind == JointKind::Ball, "a ball joint"),
        _ => (true, ""),
    };
    if fits {
        return Ok(());
    }
    Err(spec.error(format!("the joint \"{name}\" must be {wanted}")))
}

fn frame(
    spec: &SensorSpec,
    names: &AllNames,
    frame: &FrameName,
) -> Result<FrameObject, BuildError> {
    let name = &frame.name;
    Ok(match frame.kind {
        FrameKind::Inertial => FrameObject::Inertial(names.bodies.find(name, spec)?),
        FrameKind::Body => FrameObject::Body(names.bodies.find(name, spec)?),
        FrameKind::Geom => FrameObject::Geom(names.geoms.find(name, spec)?),
        FrameKind::Site => FrameObject::Site(names.sites.find(name, spec)?),
    })
}

fn geoms(
    spec: &SensorSpec,
    names: &AllNames,
    model: &Model,
    set: &GeomsName,
) -> Result<Range<usize>, BuildError> {
    match set {
        GeomsName::Geom(name) => {
            let geom = names.geoms.find(name, spec)?;
            Ok(geom..geom + 1)
        }
        GeomsName::Body(name) => {
            let geoms = model.bodies[names.bodies.find(name, spec)?].geoms.clone();
            if geoms.is_empty() {
                return Err(spec.error(format!("the body \"{name}\" has no geom")));
            }
            Ok(geoms)
        }
    }
}
