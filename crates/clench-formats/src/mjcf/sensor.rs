//! `<sensor>`: which attributes a kind of sensor has follows from what it is attached to.

use super::document::Element;
use super::rules::{NONE, Rule};
use crate::LoadError;
use clench_rigid::builder::{FrameKind, FrameName, GeomsName, SensorSpec, SensorSubject};
use clench_rigid::model::{Attachment, SensorData, SensorKind};

/// What all sensors have, before what they are attached to.
macro_rules! rule {
    ($attributes:literal) => {
        rule!($attributes, "")
    };
    ($attributes:literal, $ignored:literal) => {
        Rule {
            element: "sensor",
            read: concat!("name cutoff noise ", $attributes),
            ignored: concat!("user ", $ignored),
            later: "nsample=0 interp delay=0 interval=0",
            ..NONE
        }
    };
}

const NOTHING: Rule = rule!("");
const SITE: Rule = rule!("site");
const JOINT: Rule = rule!("joint");
const TENDON: Rule = rule!("tendon");
const ACTUATOR: Rule = rule!("actuator");
const BODY: Rule = rule!("body");
const FRAME: Rule = rule!("objtype objname reftype refname");
const WORLD_FRAME: Rule = rule!("objtype objname");
const INSIDE: Rule = rule!("site objtype objname");
const GEOMS: Rule = rule!("geom1 geom2 body1 body2");
/// What the user's numbers belong to and when they are computed matters to the user's program alone.
const USER: Rule = rule!("dim datatype", "objtype objname needstage");
/// A rangefinder may give more than a distance.
const RANGEFINDER: Rule = Rule {
    later: "camera data=dist nsample=0 interp delay=0 interval=0",
    ..SITE
};

/// The rule of a sensor's element.
pub(crate) fn rule(tag: &str) -> Option<&'static Rule> {
    let kind = SensorKind::find(tag)?;
    Some(match kind.attachment() {
        _ if kind == SensorKind::Rangefinder => &RANGEFINDER,
        Attachment::Nothing => &NOTHING,
        Attachment::Site => &SITE,
        Attachment::ScalarJoint | Attachment::Ball | Attachment::Joint => &JOINT,
        Attachment::Tendon => &TENDON,
        Attachment::Actuator => &ACTUATOR,
        Attachment::Body => &BODY,
        Attachment::Frame => &FRAME,
        Attachment::WorldFrame => &WORLD_FRAME,
        Attachment::Inside => &INSIDE,
        Attachment::Geoms => &GEOMS,
        Attachment::User => &USER,
    })
}

/// Reads a sensor of a known kind.
pub(crate) fn read(element: &Element, kind: SensorKind) -> Result<SensorSpec, LoadError> {
    let named = |attribute: &str| {
        let name = element.required_text(attribute)?.to_owned();
        Ok::<_, LoadError>(SensorSubject::Element(name))
    };
    let subject = match kind.attachment() {
        Attachment::Nothing => SensorSubject::Nothing,
        Attachment::Site => named("site")?,
        Attachment::ScalarJoint | Attachment::Ball | Attachment::Joint => named("joint")?,
        Attachment::Tendon => named("tendon")?,
        Attachment::Actuator => named("actuator")?,
        Attachment::Body => named("body")?,
        Attachment::Frame | Attachment::WorldFrame => SensorSubject::Frame {
            object: read_object(element)?,
            reference: read_frame(element, "reftype", "refname")?,
        },
        Attachment::Inside => SensorSubject::Inside {
            site: element.required_text("site")?.to_owned(),
            object: read_object(element)?,
        },
        Attachment::Geoms => SensorSubject::Geoms([
            read_geoms(element, "geom1", "body1")?,
            read_geoms(element, "geom2", "body2")?,
        ]),
        Attachment::User => read_user(element)?,
    };
    let mut spec = SensorSpec {
        name: element.string("name"),
        kind,
        subject,
        cutoff: 0.0,
        noise: 0.0,
        origin: Some(element.origin.clone()),
    };
    element.refuse_negative(&["cutoff", "noise"])?;
    element.set_number("cutoff", &mut spec.cutoff)?;
    element.set_number("noise", &mut spec.noise)?;
    Ok(spec)
}

/// The object that is measured.
fn read_object(element: &Element) -> Result<FrameName, LoadError> {
    read_frame(element, "objtype", "objname")?.ok_or_else(|| element.missing("objtype"))
}

/// A frame by its object's type and name, which come together or not at all.
fn read_frame(element: &Element, kind: &str, name: &str) -> Result<Option<FrameName>, LoadError> {
    let kinds = [
        ("body", Some(FrameKind::Inertial)),
        ("xbody", Some(FrameKind::Body)),
        ("geom", Some(FrameKind::Geom)),
        ("site", Some(FrameKind::Site)),
        ("camera", None),
    ];
    match (element.keyword(kind, &kinds)?, element.text(name)) {
        (None, None) => Ok(None),
        (Some(None), _) => Err(element.error(format!("a camera as {kind} is not supported yet"))),
        (Some(Some(kind)), Some(name)) => Ok(Some(FrameName {
            kind,
            name: name.to_owned(),
        })),
        (None, Some(_)) => Err(element.missing(kind)),
        (Some(_), None) => Err(element.missing(name)),
    }
}

/// A geom, or all geoms of a body.
fn read_geoms(element: &Element, geom: &str, body: &str) -> Result<GeomsName, LoadError> {
    element.at_most_one(&[geom, body])?;
    match (element.text(geom), element.text(body)) {
        (Some(name), _) => Ok(GeomsName::Geom(name.to_owned())),
        (None, Some(name)) => Ok(GeomsName::Body(name.to_owned())),
        (None, None) => Err(element.error(format!("either {geom} or {body} must be given"))),
    }
}

fn read_user(element: &Element) -> Result<SensorSubject, LoadError> {
    let dim = element
        .count("dim")?
        .ok_or_else(|| element.missing("dim"))?;
    let kinds = [
        ("real", SensorData::Real),
        ("positive", SensorData::Positive),
        ("axis", SensorData::Axis),
        ("quaternion", SensorData::Quaternion),
    ];
    let data = element.keyword("datatype", &kinds)?;
    Ok(SensorSubject::User(dim, data.unwrap_or(SensorData::Real)))
}
