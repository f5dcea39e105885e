//! `<sensor>`: the attributes of a kind of sensor follow from its attachment.

use super::actuator::read_history;
use crate::document::Element;
use crate::error::LoadError;
use crate::mjcf::rules::{NONE, Rule};
use clench_builder::{
    ContactQuerySpec, ContactSideName, FrameKind, FrameName, GeomsName, HistorySpec, SensorSpec,
    SensorSubject,
};
use clench_dynamics::model::{
    Attachment, ContactField, ContactReduction, RayField, SensorData, SensorKind,
};
use std::sync::Arc;

/// Creates a rule with common attributes and those of an attachment.
macro_rules! rule {
    ($attributes:literal) => {
        Rule {
            element: "sensor",
            read: concat!(
                "name cutoff noise nsample interp delay interval user ",
                $attributes
            ),
            ..NONE
        }
    };
}

const NO_ATTRIBUTES: Rule = rule!("");
const SITE: Rule = rule!("site");
const JOINT: Rule = rule!("joint");
const TENDON: Rule = rule!("tendon");
const ACTUATOR: Rule = rule!("actuator");
const BODY: Rule = rule!("body");
const FRAME: Rule = rule!("objtype objname reftype refname");
const WORLD_FRAME: Rule = rule!("objtype objname");
const INSIDE: Rule = rule!("site objtype objname enclosed");
const GEOMS: Rule = rule!("geom1 geom2 body1 body2");
/// The objects and stage of a user sensor only concern the user's program.
const USER: Rule = Rule {
    element: "sensor",
    read: "name cutoff noise dim datatype user",
    ignored: "objtype objname needstage",
    ..NONE
};
const PROJECTION: Rule = rule!("site camera");
const CONTACTS: Rule = rule!("geom1 geom2 body1 body2 subtree1 subtree2 site num data reduce");
/// Tactile sensors have no noise.
const TAXELS: Rule = Rule {
    element: "sensor",
    read: "name cutoff nsample interp delay interval user mesh geom",
    ..NONE
};
const RAYS: Rule = rule!("site camera data");

/// Returns the rule of a sensor's element.
pub(crate) fn rule(tag: &str) -> Option<&'static Rule> {
    let kind = SensorKind::find(tag)?;
    Some(match kind.attachment() {
        Attachment::Nothing => &NO_ATTRIBUTES,
        Attachment::Site => &SITE,
        Attachment::ScalarJoint | Attachment::Ball | Attachment::Joint => &JOINT,
        Attachment::Tendon => &TENDON,
        Attachment::Actuator => &ACTUATOR,
        Attachment::Body => &BODY,
        Attachment::Frame => &FRAME,
        Attachment::WorldFrame => &WORLD_FRAME,
        Attachment::Inside => &INSIDE,
        Attachment::Projection => &PROJECTION,
        Attachment::Rays => &RAYS,
        Attachment::Contacts => &CONTACTS,
        Attachment::Taxels => &TAXELS,
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
        Attachment::Inside => {
            let mut enclosed = false;
            element.set_boolean("enclosed", &mut enclosed)?;
            SensorSubject::Inside {
                site: element.required_text("site")?.to_owned(),
                object: read_object(element)?,
                enclosed,
            }
        }
        Attachment::Projection => SensorSubject::Projection {
            site: element.required_text("site")?.to_owned(),
            camera: element.required_text("camera")?.to_owned(),
        },
        Attachment::Rays => read_rays(element)?,
        Attachment::Contacts => read_contacts(element)?,
        Attachment::Taxels => SensorSubject::Taxels {
            mesh: element.required_text("mesh")?.to_owned(),
            geom: element.required_text("geom")?.to_owned(),
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
        history: HistorySpec::default(),
        interval: [0.0; 2],
        user: Arc::default(),
        origin: Some(element.origin.clone()),
    };
    element.refuse_negative(&["cutoff", "noise"])?;
    element.set_number("cutoff", &mut spec.cutoff)?;
    element.set_number("noise", &mut spec.noise)?;
    element.set_user(&mut spec.user)?;
    read_history(element, &mut spec.history)?;
    element.overlay("interval", &mut spec.interval)?;
    Ok(spec)
}

/// Reads the measured object.
fn read_object(element: &Element) -> Result<FrameName, LoadError> {
    read_frame(element, "objtype", "objname")?.ok_or_else(|| element.missing("objtype"))
}

/// Reads a frame by its object's type and name, which must be given together.
fn read_frame(element: &Element, kind: &str, name: &str) -> Result<Option<FrameName>, LoadError> {
    let kinds = [
        ("body", FrameKind::Inertial),
        ("xbody", FrameKind::Body),
        ("geom", FrameKind::Geom),
        ("site", FrameKind::Site),
        ("camera", FrameKind::Camera),
    ];
    match (element.keyword(kind, &kinds)?, element.text(name)) {
        (None, None) => Ok(None),
        (Some(kind), Some(name)) => Ok(Some(FrameName {
            kind,
            name: name.to_owned(),
        })),
        (None, Some(_)) => Err(element.missing(kind)),
        (Some(_), None) => Err(element.missing(name)),
    }
}

/// Reads the origin of rays, and the fields of each.
fn read_rays(element: &Element) -> Result<SensorSubject, LoadError> {
    element.at_most_one(&["site", "camera"])?;
    let (kind, name) = match (element.text("site"), element.text("camera")) {
        (Some(site), _) => (FrameKind::Site, site),
        (None, Some(camera)) => (FrameKind::Camera, camera),
        (None, None) => return Err(element.incomplete("either site or camera must be given")),
    };
    let allowed = RayField::ALL.iter().map(|&field| (field.name(), field));
    Ok(SensorSubject::Rays {
        source: FrameName {
            kind,
            name: name.to_owned(),
        },
        fields: read_fields(element, &allowed.collect::<Vec<_>>())?,
    })
}

/// Reads the contacts that a sensor selects, and the fields of each.
fn read_contacts(element: &Element) -> Result<SensorSubject, LoadError> {
    element.at_most_one(&["geom1", "body1", "subtree1", "site"])?;
    element.at_most_one(&["geom2", "body2", "subtree2"])?;
    let side = |geom: &str, body: &str, subtree: &str| {
        let text = |name: &str| element.text(name).map(str::to_owned);
        text(geom)
            .map(ContactSideName::Geom)
            .or_else(|| text(body).map(ContactSideName::Body))
            .or_else(|| text(subtree).map(ContactSideName::Subtree))
            .unwrap_or_default()
    };
    let reductions = [
        ("none", ContactReduction::None),
        ("mindist", ContactReduction::MinDist),
        ("maxforce", ContactReduction::MaxForce),
        ("netforce", ContactReduction::NetForce),
    ];
    let count = element.count("num")?.unwrap_or(1);
    if count == 0 {
        return Err(element.error("num must be positive"));
    }
    let allowed = ContactField::ALL.iter().map(|&field| (field.name(), field));
    Ok(SensorSubject::Contacts(ContactQuerySpec {
        sides: [
            side("geom1", "body1", "subtree1"),
            side("geom2", "body2", "subtree2"),
        ],
        site: element.string("site"),
        fields: read_fields(element, &allowed.collect::<Vec<_>>())?,
        reduction: element
            .keyword("reduce", &reductions)?
            .unwrap_or(ContactReduction::None),
        count,
    }))
}

/// Reads the words of `data`, which must be in the order of `allowed`.
fn read_fields<F: Copy + PartialOrd>(
    element: &Element,
    allowed: &[(&str, F)],
) -> Result<Vec<F>, LoadError> {
    let mut fields: Vec<F> = Vec::new();
    for word in element
        .text("data")
        .unwrap_or_default()
        .split_ascii_whitespace()
    {
        let names = || allowed.iter().map(|(name, _)| *name);
        let list = || names().collect::<Vec<_>>().join(", ");
        let Some(&(_, field)) = allowed.iter().find(|(name, _)| *name == word) else {
            let message = format!("data has \"{word}\", not one of {}", list());
            return Err(element.error(message));
        };
        if fields.last().is_some_and(|&last| last >= field) {
            let message = format!(
                "the keywords of data must appear once each and in this order: {}",
                list()
            );
            return Err(element.error(message));
        }
        fields.push(field);
    }
    Ok(fields)
}

/// Reads a geom, or all geoms of a body.
fn read_geoms(element: &Element, geom: &str, body: &str) -> Result<GeomsName, LoadError> {
    element.at_most_one(&[geom, body])?;
    match (element.text(geom), element.text(body)) {
        (Some(name), _) => Ok(GeomsName::Geom(name.to_owned())),
        (None, Some(name)) => Ok(GeomsName::Body(name.to_owned())),
        (None, None) => Err(element.incomplete(format!("either {geom} or {body} must be given"))),
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
