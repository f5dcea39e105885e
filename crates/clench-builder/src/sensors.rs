//! Sensors: the elements that they are attached to, and the ranges of their numbers.

use super::element::Element;
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use super::sensor_specs::{
    ContactQuerySpec, ContactSideName, FrameKind, FrameName, GeomsName, SensorSpec, SensorSubject,
};
use super::{BuildError, histories};
use clench_collide::ShapeKind;
use clench_dynamics::model::{
    Attachment, ContactField, ContactQuery, ContactReduction, ContactSide, FrameObject, Geom,
    JointKind, Model, RayField, RaySource, Sensor, SensorData, SensorKind, SensorTarget,
};
use std::ops::Range;
use std::sync::Arc;

/// The maximum number of values of a sensor.
const MAX_DIM: usize = 1 << 20;

/// Adds all sensors.
///
/// # Errors
/// Returns an error if a subject does not exist or has the wrong kind, a cutoff is not allowed, or a number is
/// negative.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.sensors {
        spec.require_not_negative("cutoff", &[spec.cutoff])?;
        spec.require_not_negative("noise", &[spec.noise])?;
        let target = target(spec, names, model)?;
        require_limit(spec, &target, model)?;
        require_dim_of_data(spec)?;
        if let (SensorKind::Touch, &SensorTarget::Element(site)) = (spec.kind, &target)
            && model.sites[site].kind == ShapeKind::Mesh
        {
            return Err(spec.error("a touch sensor cannot use the volume of a mesh"));
        }
        let data = match spec.subject {
            SensorSubject::User(_, data) => data,
            SensorSubject::Inside { enclosed: true, .. } => SensorData::Real,
            SensorSubject::Inside {
                enclosed: false, ..
            }
            | SensorSubject::Nothing
            | SensorSubject::Element(_)
            | SensorSubject::Frame { .. }
            | SensorSubject::Projection { .. }
            | SensorSubject::Rays { .. }
            | SensorSubject::Geoms(_)
            | SensorSubject::Contacts(_)
            | SensorSubject::Taxels { .. } => spec.kind.data(),
        };
        let dim = dim(spec, &target, model)
            .filter(|&dim| dim <= MAX_DIM)
            .ok_or_else(|| spec.error(format!("has more than {MAX_DIM} numbers")))?;
        // The cutoff of a distance sensor is its search radius.
        let searched = spec.kind.attachment() == Attachment::Geoms;
        let is_rotational = matches!(data, SensorData::Axis | SensorData::Quaternion);
        if spec.cutoff > 0.0 && is_rotational && !searched {
            return Err(
                spec.error("a sensor of a direction or an orientation cannot have a cutoff")
            );
        }
        let history = histories::add(builder, spec, spec.history, dim, model)?;
        let [period, phase] = spec.interval;
        spec.require_not_negative("interval", &[period])?;
        if phase > 0.0 || (period > 0.0 && phase <= -period) {
            return Err(
                spec.error("the phase of an interval must be within one period before zero")
            );
        }
        model.params.sensor_delay.push(spec.history.delay);
        model.params.sensor_interval.push(period);
        let start = model.nsensordata();
        model.sensors.push(Sensor {
            name: spec.name.clone(),
            kind: spec.kind,
            target,
            data,
            cutoff: spec.cutoff,
            noise: spec.noise,
            numbers: start..start + dim,
            history,
            phase,
            user: Arc::clone(&spec.user),
            origin: spec.origin.clone(),
        });
    }
    Ok(())
}

/// Refuses a sensor of the limit of a joint or a tendon that has none, as in MuJoCo.
fn require_limit(
    spec: &SensorSpec,
    target: &SensorTarget,
    model: &Model,
) -> Result<(), BuildError> {
    let &SensorTarget::Element(element) = target else {
        return Ok(());
    };
    use SensorKind as Kind;
    let of_joint = matches!(
        spec.kind,
        Kind::JointLimitPos | Kind::JointLimitVel | Kind::JointLimitFrc
    );
    let of_tendon = matches!(
        spec.kind,
        Kind::TendonLimitPos | Kind::TendonLimitVel | Kind::TendonLimitFrc
    );
    let (kind, name, limited) = if of_joint {
        let joint = &model.joints[element];
        ("joint", &joint.name, joint.limited)
    } else if of_tendon {
        let tendon = &model.tendons[element];
        ("tendon", &tendon.name, tendon.limited)
    } else {
        return Ok(());
    };
    match limited {
        true => Ok(()),
        false => Err(spec.error(format!("the {kind} \"{name}\" has no limit to be measured"))),
    }
}

/// Refuses a user sensor of directions or orientations whose number of values is another one.
fn require_dim_of_data(spec: &SensorSpec) -> Result<(), BuildError> {
    let SensorSubject::User(dim, data) = spec.subject else {
        return Ok(());
    };
    let (what, wanted) = match data {
        SensorData::Axis => ("a direction", 3),
        SensorData::Quaternion => ("an orientation", 4),
        SensorData::Real | SensorData::Positive => return Ok(()),
    };
    match dim == wanted {
        true => Ok(()),
        false => Err(spec.error(format!("{what} has {wanted} numbers, but its dim is {dim}"))),
    }
}

/// Returns the number of values of a sensor; `None` if it overflows.
fn dim(spec: &SensorSpec, target: &SensorTarget, model: &Model) -> Option<usize> {
    match (&spec.subject, target) {
        (SensorSubject::User(dim, _), _) => Some(*dim),
        (_, SensorTarget::Rays { source, fields }) => {
            let rays = match source {
                RaySource::Site(_) => 1,
                RaySource::Camera(camera) => {
                    let [width, height] = model.cameras[*camera].resolution;
                    width.checked_mul(height)?
                }
            };
            rays.checked_mul(fields.iter().map(|field| field.size()).sum())
        }
        (_, &SensorTarget::Element(u)) if spec.kind.attachment() == Attachment::Actuator => {
            Some(model.actuators[u].outputs.len())
        }
        (_, SensorTarget::Contacts(query)) => query.count.checked_mul(query.size()),
        (_, &SensorTarget::Taxels { mesh, .. }) => model.meshes[mesh]
            .vertices
            .len()
            .checked_mul(clench_dynamics::model::TAXEL_CHANNELS),
        _ => Some(spec.kind.dim()),
    }
}

fn target(spec: &SensorSpec, names: &AllNames, model: &Model) -> Result<SensorTarget, BuildError> {
    use SensorSubject as Of;
    let attachment = spec.kind.attachment();
    let element = |found: Result<usize, BuildError>| found.map(SensorTarget::Element);
    match (attachment, &spec.subject) {
        (Attachment::Nothing, Of::Nothing) | (Attachment::User, Of::User(..)) => {
            Ok(SensorTarget::Nothing)
        }
        (Attachment::Site, Of::Element(name)) => element(names.sites.find(name, spec)),
        (Attachment::Tendon, Of::Element(name)) => element(names.tendons.find(name, spec)),
        (Attachment::Actuator, Of::Element(name)) => element(names.actuators.find(name, spec)),
        (Attachment::Body, Of::Element(name)) => element(names.bodies.find(name, spec)),
        (Attachment::Joint, Of::Element(name)) => element(names.joints.find(name, spec)),
        (Attachment::ScalarJoint, Of::Element(name)) => {
            let fits = |kind| matches!(kind, JointKind::Slide | JointKind::Hinge);
            joint(spec, (names, model), name, fits, "a slide or a hinge")
        }
        (Attachment::Ball, Of::Element(name)) => {
            let fits = |kind| kind == JointKind::Ball;
            joint(spec, (names, model), name, fits, "a ball joint")
        }
        (Attachment::Frame | Attachment::WorldFrame, Of::Frame { object, reference }) => {
            if attachment == Attachment::WorldFrame && reference.is_some() {
                return Err(
                    spec.error("is measured in the world frame: it cannot have a reference frame")
                );
            }
            let find = |name: &FrameName| frame(spec, names, name);
            Ok(SensorTarget::Frame {
                object: find(object)?,
                reference: reference.as_ref().map(find).transpose()?,
            })
        }
        (Attachment::Inside, Of::Inside { .. }) => inside(spec, names, model),
        (Attachment::Projection, Of::Projection { site, camera }) => {
            let camera = names.cameras.find(camera, spec)?;
            require_pixels(spec, model, camera)?;
            Ok(SensorTarget::Projection {
                site: names.sites.find(site, spec)?,
                camera,
            })
        }
        (Attachment::Rays, Of::Element(site)) => Ok(SensorTarget::Rays {
            source: RaySource::Site(names.sites.find(site, spec)?),
            fields: vec![RayField::Dist],
        }),
        (Attachment::Rays, Of::Rays { source, fields }) => Ok(SensorTarget::Rays {
            source: ray_source(spec, names, model, source)?,
            fields: match fields.is_empty() {
                true => vec![RayField::Dist],
                false => fields.clone(),
            },
        }),
        (Attachment::Contacts, Of::Contacts(query)) => {
            contact_query(spec, names, model, query).map(SensorTarget::Contacts)
        }
        (Attachment::Taxels, Of::Taxels { mesh, geom }) => {
            let geom = names.geoms.find(geom, spec)?;
            require_collider(spec, model, geom)?;
            Ok(SensorTarget::Taxels {
                mesh: find_mesh(spec, model, mesh)?,
                geom,
            })
        }
        (Attachment::Geoms, Of::Geoms([first, second])) => {
            let sets = [
                geoms(spec, names, model, first)?,
                geoms(spec, names, model, second)?,
            ];
            if sets[0] == sets[1] && !sets[0].is_empty() {
                return Err(spec.error("the two geoms or bodies must be different"));
            }
            Ok(SensorTarget::Geoms(sets))
        }
        _ => Err(spec.error(format!("must be attached to {attachment}"))),
    }
}

/// Resolves a site, and the object inside or enclosed by it. If enclosed, both must be bounded and convex.
fn inside(spec: &SensorSpec, names: &AllNames, model: &Model) -> Result<SensorTarget, BuildError> {
    let SensorSubject::Inside {
        site,
        object,
        enclosed,
    } = &spec.subject
    else {
        return Err(spec.error(format!("must be attached to {}", Attachment::Inside)));
    };
    let name = &object.name;
    let site = names.sites.find(site, spec)?;
    let object = frame(spec, names, object)?;
    if *enclosed {
        if let FrameObject::Camera(_) = object {
            return Err(spec.error("a camera has no volume that could be enclosed"));
        }
        let is_body = matches!(object, FrameObject::Inertial(_) | FrameObject::Body(_));
        if is_body && object.enclosed_geoms(model).next().is_none() {
            return Err(spec.error(format!("the body \"{name}\" has no geom to be enclosed")));
        }
        for geom in object.enclosed_geoms(model) {
            let geom = &model.geoms[geom];
            require_bounded(spec, "geom", &geom.name, geom.kind)?;
        }
        let inner = match object {
            FrameObject::Site(inner) => Some(inner),
            FrameObject::Inertial(_)
            | FrameObject::Body(_)
            | FrameObject::Geom(_)
            | FrameObject::Camera(_) => None,
        };
        for site in inner.into_iter().chain([site]) {
            let site = &model.sites[site];
            require_bounded(spec, "site", &site.name, site.kind)?;
        }
    }
    Ok(SensorTarget::Inside {
        site,
        object,
        enclosed: *enclosed,
    })
}

/// Refuses planes and height fields, which cannot enclose or be enclosed.
fn require_bounded(
    spec: &SensorSpec,
    element: &str,
    name: &str,
    kind: ShapeKind,
) -> Result<(), BuildError> {
    match kind {
        ShapeKind::Plane | ShapeKind::HeightField => Err(spec.error(format!(
            "the {element} \"{name}\" is not a bounded convex shape; only such shapes can be tested for enclosure"
        ))),
        ShapeKind::Sphere | ShapeKind::Capsule | ShapeKind::Ellipsoid | ShapeKind::Cylinder | ShapeKind::Box | ShapeKind::Mesh => Ok(()),
    }
}

fn ray_source(
    spec: &SensorSpec,
    names: &AllNames,
    model: &Model,
    source: &FrameName,
) -> Result<RaySource, BuildError> {
    match frame(spec, names, source)? {
        FrameObject::Site(site) => Ok(RaySource::Site(site)),
        FrameObject::Camera(camera) => {
            require_pixels(spec, model, camera)?;
            Ok(RaySource::Camera(camera))
        }
        FrameObject::Inertial(_) | FrameObject::Body(_) | FrameObject::Geom(_) => {
            Err(spec.error("its rays must start at a site or a camera"))
        }
    }
}

fn require_pixels(spec: &SensorSpec, model: &Model, camera: usize) -> Result<(), BuildError> {
    let camera = &model.cameras[camera];
    match camera.resolution.contains(&0) {
        true => Err(spec.error(format!("the camera \"{}\" has no pixels", camera.name))),
        false => Ok(()),
    }
}

fn find_mesh(spec: &SensorSpec, model: &Model, name: &str) -> Result<usize, BuildError> {
    let found = model.meshes.iter().position(|mesh| mesh.name == name);
    found.ok_or_else(|| spec.error(format!("there is no mesh \"{name}\"")))
}

/// Checks that the geom's body can collide.
fn require_collider(spec: &SensorSpec, model: &Model, geom: usize) -> Result<(), BuildError> {
    let body = &model.bodies[model.geoms[geom].body];
    let collides = |geom: &Geom| geom.contype != 0 || geom.conaffinity != 0;
    match model.geoms[body.geoms.clone()].iter().any(collides) {
        true => Ok(()),
        false => Err(spec.error("the geom's body needs a geom that can collide")),
    }
}

fn contact_query(
    spec: &SensorSpec,
    names: &AllNames,
    model: &Model,
    query: &ContactQuerySpec,
) -> Result<ContactQuery, BuildError> {
    let side = |name: &ContactSideName| {
        Ok::<_, BuildError>(match name {
            ContactSideName::Any => ContactSide::Any,
            ContactSideName::Geom(name) => ContactSide::Geom(names.geoms.find(name, spec)?),
            ContactSideName::Body(name) => ContactSide::Body(names.bodies.find(name, spec)?),
            ContactSideName::Subtree(name) => {
                let root = names.bodies.find(name, spec)?;
                ContactSide::Subtree(model.subtree(root))
            }
        })
    };
    let site = match &query.site[..] {
        "" => None,
        name => Some(names.sites.find(name, spec)?),
    };
    let [first, second] = &query.sides;
    let mut fields = query.fields.clone();
    if fields.is_empty() {
        fields.push(ContactField::Found);
    }
    let of_velocity =
        |field: &ContactField| matches!(field, ContactField::LinVel | ContactField::AngVel);
    if query.reduction == ContactReduction::NetForce && fields.iter().any(of_velocity) {
        return Err(spec.error("a net force has no linvel and no angvel"));
    }
    if query.count == 0 {
        return Err(spec.error("num must be positive"));
    }
    Ok(ContactQuery {
        sides: [side(first)?, side(second)?],
        site,
        fields,
        reduction: query.reduction,
        count: query.count,
    })
}

/// Resolves a joint of the required kinds.
fn joint(
    spec: &SensorSpec,
    (names, model): (&AllNames, &Model),
    name: &String,
    fits: impl Fn(JointKind) -> bool,
    wanted: &str,
) -> Result<SensorTarget, BuildError> {
    let joint = names.joints.find(name, spec)?;
    if !fits(model.joints[joint].kind) {
        return Err(spec.error(format!("the joint \"{name}\" must be {wanted}")));
    }
    Ok(SensorTarget::Element(joint))
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
        FrameKind::Camera => FrameObject::Camera(names.cameras.find(name, spec)?),
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
        GeomsName::Body(name) => Ok(model.bodies[names.bodies.find(name, spec)?].geoms.clone()),
    }
}
