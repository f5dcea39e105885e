//! Sensors, each with its attachment.

use super::actuator::write_history;
use super::names::{SaveError, body_name, label, named};
use super::xml::{Tag, Xml};
use clench_collide::ShapeKind;
use clench_dynamics::Model;
use clench_dynamics::model::{
    Attachment, Body, ContactQuery, ContactReduction, ContactSide, FrameObject, RaySource, Sensor,
    SensorData, SensorTarget,
};
use std::ops::Range;

pub(super) fn write(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for (index, sensor) in model.sensors.iter().enumerate() {
        let Sensor {
            name,
            kind,
            target: _,
            data: _,
            cutoff,
            noise,
            numbers: _,
            history,
            phase,
            user,
            origin: _,
        } = sensor;
        let mut tag = xml
            .tag(kind.name())
            .name(name)
            .numbers_unless("user", user, &[]);
        tag = write_target(model, sensor, index, tag)?;
        if let Some(history) = history {
            let delay = model.params.sensor_delay[index];
            tag = write_history(history, delay, tag);
            let period = model.params.sensor_interval[index];
            if period > 0.0 {
                tag = tag.numbers("interval", &[period, *phase]);
            }
        }
        tag.number_unless("cutoff", *cutoff, 0.0)
            .number_unless("noise", *noise, 0.0)
            .end();
    }
    Ok(())
}

/// Writes the elements that a sensor measures.
fn write_target<'a>(
    model: &Model,
    sensor: &Sensor,
    index: usize,
    tag: Tag<'a>,
) -> Result<Tag<'a>, SaveError> {
    Ok(match (&sensor.target, sensor.kind.attachment()) {
        (SensorTarget::Nothing, Attachment::User) => tag
            .integer("dim", sensor.numbers.len() as i64)
            .text("datatype", data_type(sensor.data)),
        (SensorTarget::Nothing, _) => tag,
        (SensorTarget::Element(element), attachment) => {
            let (attribute, name) =
                element_name(model, attachment, *element).ok_or_else(|| no_name(sensor, index))?;
            tag.text(attribute, name)
        }
        (SensorTarget::Frame { object, reference }, _) => {
            let tag = write_frame(model, *object, ["objtype", "objname"], tag)?;
            match reference {
                Some(frame) => write_frame(model, *frame, ["reftype", "refname"], tag)?,
                None => tag,
            }
        }
        (
            SensorTarget::Inside {
                site,
                object,
                enclosed,
            },
            _,
        ) => {
            let tag = tag.text("site", named("site", &model.sites[*site].name, *site)?);
            let tag = write_frame(model, *object, ["objtype", "objname"], tag)?;
            match enclosed {
                true => tag.boolean("enclosed", true),
                false => tag,
            }
        }
        (SensorTarget::Projection { site, camera }, _) => tag
            .text("site", named("site", &model.sites[*site].name, *site)?)
            .text(
                "camera",
                named("camera", &model.cameras[*camera].name, *camera)?,
            ),
        (SensorTarget::Rays { source, fields }, _) => {
            let tag = match *source {
                RaySource::Site(s) => tag.text("site", named("site", &model.sites[s].name, s)?),
                RaySource::Camera(c) => {
                    tag.text("camera", named("camera", &model.cameras[c].name, c)?)
                }
            };
            tag.words("data", fields.iter().map(|field| field.name()))
        }
        (SensorTarget::Contacts(query), _) => write_contacts(model, query, tag)?,
        (SensorTarget::Taxels { mesh, geom }, _) => tag
            .text("mesh", &model.meshes[*mesh].name)
            .text("geom", named("geom", &model.geoms[*geom].name, *geom)?),
        (SensorTarget::Geoms([first, second]), _) => {
            let set = |geoms, is_second| {
                geoms_name(model, geoms, is_second).ok_or_else(|| no_name(sensor, index))
            };
            let ([of1, name1], [of2, name2]) = (set(first, false)?, set(second, true)?);
            let attribute = |of| match of {
                "geom" => ["geom1", "geom2"],
                _ => ["body1", "body2"],
            };
            tag.text(attribute(of1)[0], name1)
                .text(attribute(of2)[1], name2)
        }
    })
}

fn no_name(sensor: &Sensor, index: usize) -> SaveError {
    let reason = "the element that it measures has no name";
    SaveError::new(label("sensor", &sensor.name, index), reason)
}

fn data_type(data: SensorData) -> &'static str {
    match data {
        SensorData::Real => "real",
        SensorData::Positive => "positive",
        SensorData::Axis => "axis",
        SensorData::Quaternion => "quaternion",
    }
}

/// Returns the attribute of an attachment, and the name of the element.
fn element_name(model: &Model, attachment: Attachment, index: usize) -> Option<(&str, &str)> {
    let found = match attachment {
        Attachment::Site => ("site", &model.sites[index].name),
        Attachment::ScalarJoint | Attachment::Ball | Attachment::Joint => {
            ("joint", &model.joints[index].name)
        }
        Attachment::Tendon => ("tendon", &model.tendons[index].name),
        Attachment::Actuator => ("actuator", &model.actuators[index].name),
        Attachment::Body => return Some(("body", body_name(model, index).ok()?)),
        Attachment::Nothing
        | Attachment::Frame
        | Attachment::WorldFrame
        | Attachment::Inside
        | Attachment::Projection
        | Attachment::Rays
        | Attachment::Contacts
        | Attachment::Taxels
        | Attachment::Geoms
        | Attachment::User => return None,
    };
    (!found.1.is_empty()).then_some((found.0, found.1.as_str()))
}

fn write_frame<'a>(
    model: &Model,
    frame: FrameObject,
    [kind, name]: [&str; 2],
    tag: Tag<'a>,
) -> Result<Tag<'a>, SaveError> {
    let (of, found) = match frame {
        FrameObject::Inertial(b) => ("body", body_name(model, b)?),
        FrameObject::Body(b) => ("xbody", body_name(model, b)?),
        FrameObject::Geom(g) => ("geom", named("geom", &model.geoms[g].name, g)?),
        FrameObject::Camera(c) => ("camera", named("camera", &model.cameras[c].name, c)?),
        FrameObject::Site(s) => ("site", named("site", &model.sites[s].name, s)?),
    };
    Ok(tag.text(kind, of).text(name, found))
}

/// Returns a geom with a name, or a body with exactly these geoms. MuJoCo accepts a height field only as the geom of a
/// body. Among bodies without geoms, the second set is named by the last, because the two names must differ.
fn geoms_name<'a>(model: &'a Model, geoms: &Range<usize>, is_second: bool) -> Option<[&'a str; 2]> {
    let has_these = |body: &Body| body.geoms == *geoms;
    let body = match is_second {
        true => model.bodies.iter().rposition(has_these),
        false => model.bodies.iter().position(has_these),
    };
    let body = body.and_then(|body| Some(["body", body_name(model, body).ok()?]));
    let [geom] = &model.geoms[geoms.clone()] else {
        return body;
    };
    let geom_name = (!geom.name.is_empty()).then_some(["geom", &geom.name[..]]);
    match geom.kind {
        ShapeKind::HeightField => body.or(geom_name),
        ShapeKind::Plane
        | ShapeKind::Sphere
        | ShapeKind::Capsule
        | ShapeKind::Ellipsoid
        | ShapeKind::Cylinder
        | ShapeKind::Box
        | ShapeKind::Mesh => geom_name.or(body),
    }
}

/// Writes the contacts that a sensor selects, and the fields of each.
fn write_contacts<'a>(
    model: &Model,
    query: &ContactQuery,
    mut tag: Tag<'a>,
) -> Result<Tag<'a>, SaveError> {
    let ContactQuery {
        sides,
        site,
        fields,
        reduction,
        count,
    } = query;
    for (side, number) in sides.iter().zip(["1", "2"]) {
        let (of, name) = match side {
            ContactSide::Any => continue,
            ContactSide::Geom(g) => ("geom", named("geom", &model.geoms[*g].name, *g)?),
            ContactSide::Body(b) => ("body", body_name(model, *b)?),
            ContactSide::Subtree(bodies) => ("subtree", body_name(model, bodies.start)?),
        };
        tag = tag.text(&format!("{of}{number}"), name);
    }
    if let Some(site) = *site {
        tag = tag.text("site", named("site", &model.sites[site].name, site)?);
    }
    let reduction = match reduction {
        ContactReduction::None => "none",
        ContactReduction::MinDist => "mindist",
        ContactReduction::MaxForce => "maxforce",
        ContactReduction::NetForce => "netforce",
    };
    Ok(tag
        .words("data", fields.iter().map(|field| field.name()))
        .text("reduce", reduction)
        .integer("num", *count as i64))
}
