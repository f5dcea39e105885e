//! MuJoCo's `fusestatic`: fuses bodies without joints with their parent bodies.
//!
//! The result moves as before, with fewer bodies. As in MuJoCo 4.0 a body stays if another element names it, if a force
//! or torque is measured in it, or if fusing would change the motion: fluid forces and gravity compensation depend on
//! the body.

use super::bodies::depth_first;
use super::check::describe;
use super::inertia::{MassProperties, combine, mass_properties, unbounded_mass_properties};
use super::model_builder::ModelBuilder;
use super::placed::Assets;
use super::{
    BodySpec, BuildError, CameraSpec, CameraTracking, ConnectAnchor, ContactSideName, FrameKind,
    FrameName, GeomSpec, GeomsName, InertiaFromGeom, InertiaSpec, InertialSpec, LightSpec,
    SensorSubject, SiteSpec, TransmissionSpec,
};
use clench_dynamics::model::{Attachment, SensorKind};
use clench_math::{Quat, Vec3};
use std::collections::HashSet;

/// Returns the author's bodies, with static ones fused into their parents.
///
/// # Errors
/// Returns an error if masses or inertias are impossible.
pub(super) fn fuse(builder: &ModelBuilder, assets: &Assets) -> Result<Vec<BodySpec>, BuildError> {
    let bodies = &builder.bodies;
    let order = depth_first(bodies)?;
    let masses = bodies
        .iter()
        .enumerate()
        .map(|(b, body)| Mass::of(builder, body, b, assets))
        .collect::<Result<Vec<_>, _>>()?;
    let named = Named::new(builder);
    let mut fused: Vec<BodySpec> = Vec::with_capacity(bodies.len());
    // The new body, and the pose in it, of each of the author's bodies.
    let mut locations: Vec<Location> = vec![Location::ORIGIN; bodies.len()];
    // The bodies that stayed, by the author's indices, and the masses fused into each.
    let mut stayed: Vec<(usize, Vec<MassProperties>)> = Vec::new();
    for &b in &order {
        let body = &bodies[b];
        let on = locations[body.parent];
        let here = on.then(body.pos, body.quat);
        let keeps = b == 0
            || !body.joints.is_empty()
            || body.mocap
            || body.never_fused
            || named.keeps(body)
            || affects_motion(builder, &masses, b, stayed[on.body].0);
        if keeps {
            locations[b] = Location {
                body: fused.len(),
                ..Location::ORIGIN
            };
            fused.push(BodySpec {
                parent: on.body,
                pos: here.pos,
                quat: here.quat,
                written: body.written.or(Some((body.pos, body.quat))),
                ..body.clone()
            });
            stayed.push((b, Vec::new()));
            continue;
        }
        locations[b] = here;
        let target = &mut fused[here.body];
        target.geoms.extend(body.geoms.iter().map(|g| here.geom(g)));
        target.sites.extend(body.sites.iter().map(|s| here.site(s)));
        target
            .cameras
            .extend(body.cameras.iter().map(|c| here.camera(c)));
        target
            .lights
            .extend(body.lights.iter().map(|l| here.light(l)));
        stayed[here.body].1.push(here.mass(&masses[b].properties));
    }
    for (body, (b, parts)) in fused.iter_mut().zip(&stayed).skip(1) {
        if !parts.is_empty() && builder.compiler.inertiafromgeom != InertiaFromGeom::Always {
            body.inertial = Some(total(builder, body, masses[*b].properties, parts)?);
        }
    }
    Ok(fused)
}

/// The mass of a body after the compiler's bounds, and whether these changed it.
struct Mass {
    properties: MassProperties,
    adjusted: bool,
}

impl Mass {
    fn of(
        builder: &ModelBuilder,
        body: &BodySpec,
        b: usize,
        assets: &Assets,
    ) -> Result<Self, BuildError> {
        if b == 0 {
            return Ok(Mass {
                properties: MassProperties::NONE,
                adjusted: false,
            });
        }
        let name = describe(&body.name, b);
        let properties = mass_properties(body, &name, &builder.compiler, assets)?;
        let found = unbounded_mass_properties(body, &name, &builder.compiler, assets)?;
        Ok(Mass {
            adjusted: found.mass != properties.mass || found.moments != properties.moments,
            properties,
        })
    }
}

/// Returns true if the motion would change if body `b` were part of `target`. Parts of the world do not move.
fn affects_motion(builder: &ModelBuilder, masses: &[Mass], b: usize, target: usize) -> bool {
    if target == 0 {
        return false;
    }
    let (body, parent) = (&builder.bodies[b], &builder.bodies[target]);
    let physics = &builder.physics;
    let in_fluid = physics.density > 0.0 || physics.viscosity > 0.0;
    let has_mass = masses[b].properties.mass > 0.0;
    let from_geoms = builder.compiler.inertiafromgeom == InertiaFromGeom::Always;
    let ellipsoids = body.geoms.iter().any(|geom| geom.fluid_ellipsoid);
    in_fluid && ellipsoids
        || has_mass && (in_fluid || body.gravcomp != parent.gravcomp)
        || from_geoms && (masses[b].adjusted || masses[target].adjusted)
}

/// Combines the masses of a body and of those fused into it. As in MuJoCo, parts without mass are ignored, but the
/// body's own inertia counts even if it has no mass.
fn total(
    builder: &ModelBuilder,
    body: &BodySpec,
    own: MassProperties,
    parts: &[MassProperties],
) -> Result<InertialSpec, BuildError> {
    let counts = own.mass > 0.0 || own.moments != Vec3::ZERO;
    let heavy = parts.iter().filter(|part| part.mass > 0.0);
    let summed: Vec<_> = counts
        .then_some(&own)
        .into_iter()
        .chain(heavy)
        .copied()
        .collect();
    let sum = match summed[..] {
        [] => own,
        [one] => one,
        _ => combine(body, &summed, &builder.compiler)?,
    };
    let inertial = body.inertial.as_ref();
    Ok(InertialSpec {
        pos: sum.pos,
        quat: sum.quat,
        mass: sum.mass,
        inertia: InertiaSpec::Diagonal(sum.moments.to_array()),
        origin: inertial.map_or_else(|| body.origin.clone(), |i| i.origin.clone()),
    })
}

/// The location of one of the author's bodies: the body that it became part of, and its pose in that.
#[derive(Clone, Copy)]
struct Location {
    body: usize,
    pos: Vec3<f64>,
    quat: Quat<f64>,
}

impl Location {
    const ORIGIN: Location = Location {
        body: 0,
        pos: Vec3::ZERO,
        quat: Quat::IDENTITY,
    };

    /// Composes this location with a pose in it.
    fn then(&self, pos: Vec3<f64>, quat: Quat<f64>) -> Location {
        Location {
            body: self.body,
            pos: self.pos + self.quat.rotate(pos),
            quat: (self.quat * quat.normalize()).normalize(),
        }
    }

    fn geom(&self, geom: &GeomSpec) -> GeomSpec {
        let at = self.then(geom.pos, geom.quat);
        GeomSpec {
            pos: at.pos,
            quat: at.quat,
            ..geom.clone()
        }
    }

    fn site(&self, site: &SiteSpec) -> SiteSpec {
        let at = self.then(site.pos, site.quat);
        SiteSpec {
            pos: at.pos,
            quat: at.quat,
            ..site.clone()
        }
    }

    fn camera(&self, camera: &CameraSpec) -> CameraSpec {
        let at = self.then(camera.pos, camera.quat);
        CameraSpec {
            pos: at.pos,
            quat: at.quat,
            ..camera.clone()
        }
    }

    fn light(&self, light: &LightSpec) -> LightSpec {
        let at = self.then(light.pos, Quat::IDENTITY);
        LightSpec {
            pos: at.pos,
            dir: at.quat.rotate(light.dir),
            ..light.clone()
        }
    }

    fn mass(&self, mass: &MassProperties) -> MassProperties {
        let at = self.then(mass.pos, mass.quat);
        MassProperties {
            pos: at.pos,
            quat: at.quat,
            ..*mass
        }
    }
}

/// The names of bodies, and of sites, that prevent fusing.
struct Named<'a> {
    bodies: HashSet<&'a str>,
    sites: HashSet<&'a str>,
}

impl<'a> Named<'a> {
    fn new(builder: &'a ModelBuilder) -> Self {
        let (mut bodies, mut sites) = (HashSet::new(), HashSet::new());
        for equality in &builder.equalities {
            if let Some(ConnectAnchor::Bodies { body1, body2, .. }) = equality.kind.anchor() {
                bodies.extend([&body1[..], &body2[..]]);
            }
        }
        for body in &builder.bodies {
            let cameras = body.cameras.iter().map(|camera| &camera.tracking);
            let lights = body.lights.iter().map(|light| &light.tracking);
            for tracking in cameras.chain(lights) {
                let (CameraTracking::TargetBody(name) | CameraTracking::TargetBodyCom(name)) =
                    tracking
                else {
                    continue;
                };
                bodies.insert(&name[..]);
            }
        }
        for exclude in &builder.excludes {
            bodies.extend([&exclude.body1[..], &exclude.body2[..]]);
        }
        for actuator in &builder.actuators {
            if let TransmissionSpec::Body(name) = &actuator.transmission {
                bodies.insert(&name[..]);
            }
        }
        for sensor in &builder.sensors {
            let kind = sensor.kind;
            let frame = |frame: &'a FrameName| {
                matches!(frame.kind, FrameKind::Body | FrameKind::Inertial)
                    .then_some(&frame.name[..])
            };
            match &sensor.subject {
                SensorSubject::Element(name) if kind.attachment() == Attachment::Body => {
                    bodies.insert(&name[..]);
                }
                SensorSubject::Element(name)
                    if matches!(kind, SensorKind::Force | SensorKind::Torque) =>
                {
                    sites.insert(&name[..]);
                }
                SensorSubject::Frame { object, reference } => {
                    bodies.extend(frame(object));
                    bodies.extend(reference.as_ref().and_then(frame));
                }
                SensorSubject::Inside { object, .. } => bodies.extend(frame(object)),
                SensorSubject::Contacts(query) => {
                    bodies.extend(query.sides.iter().filter_map(|side| match side {
                        ContactSideName::Body(name) | ContactSideName::Subtree(name) => {
                            Some(&name[..])
                        }
                        ContactSideName::Any | ContactSideName::Geom(_) => None,
                    }));
                }
                SensorSubject::Geoms(sets) => {
                    bodies.extend(sets.iter().filter_map(|set| match set {
                        GeomsName::Body(name) => Some(&name[..]),
                        GeomsName::Geom(_) => None,
                    }));
                }
                // The others name no body, and no site whose body's force they measure.
                SensorSubject::Nothing
                | SensorSubject::Element(_)
                | SensorSubject::Projection { .. }
                | SensorSubject::Rays { .. }
                | SensorSubject::Taxels { .. }
                | SensorSubject::User(..) => {}
            }
        }
        bodies.remove("");
        sites.remove("");
        Named { bodies, sites }
    }

    /// Returns true if an element names the body, or measures forces in it.
    fn keeps(&self, body: &BodySpec) -> bool {
        let measured = |site: &SiteSpec| self.sites.contains(&site.name[..]);
        self.bodies.contains(&body.name[..]) || body.sites.iter().any(measured)
    }
}
