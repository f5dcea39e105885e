//! The uses of geoms by other elements: geoms that collide, and visual geoms that no other element names.

use super::model_builder::ModelBuilder;
use super::sensor_specs::{ContactSideName, FrameKind, FrameName, GeomsName, SensorSubject};
use super::{GeomSpec, WrapSpec};
use std::collections::HashSet;

/// The uses of geoms by other elements.
pub(super) struct GeomUses<'a> {
    /// Geoms of explicit pairs.
    paired: HashSet<&'a str>,
    /// Geoms that tendons, sensors and tuples name.
    named: HashSet<&'a str>,
    discardvisual: bool,
}

impl<'a> GeomUses<'a> {
    pub(super) fn of(builder: &'a ModelBuilder) -> Self {
        let pairs = builder.pairs.iter();
        let paths = builder.tendons.iter().flat_map(|tendon| &tendon.path);
        let tuples = builder
            .custom
            .tuples
            .iter()
            .flat_map(|(_, entries)| entries);
        let mut named: HashSet<&str> = paths
            .filter_map(|wrap| match wrap {
                WrapSpec::Geom { geom, .. } => Some(geom.as_str()),
                WrapSpec::Joint { .. } | WrapSpec::Site(_) | WrapSpec::Pulley(_) => None,
            })
            .collect();
        named
            .extend((tuples.filter(|entry| entry.kind == "geom")).map(|entry| entry.name.as_str()));
        for sensor in &builder.sensors {
            named.extend(geoms_of(&sensor.subject));
        }
        GeomUses {
            paired: pairs
                .flat_map(|pair| [&*pair.geom1, &*pair.geom2])
                .collect(),
            named,
            discardvisual: builder.compiler.discardvisual,
        }
    }

    /// Returns true if it can collide, by its masks or by explicit pairs.
    pub(super) fn collides(&self, geom: &GeomSpec) -> bool {
        geom.contype != 0 || geom.conaffinity != 0 || has(&self.paired, geom)
    }

    /// Returns true if it is omitted from the model: it does not collide, is not named, and no fluid force acts on it.
    pub(super) fn is_discarded(&self, geom: &GeomSpec) -> bool {
        let acts = self.collides(geom) || geom.fluid_ellipsoid;
        self.discardvisual && !acts && !has(&self.named, geom)
    }
}

fn has(names: &HashSet<&str>, geom: &GeomSpec) -> bool {
    !geom.name.is_empty() && names.contains(geom.name.as_str())
}

/// Returns the geoms that a sensor names.
fn geoms_of(subject: &SensorSubject) -> Vec<&str> {
    let of_frame = |frame: &FrameName| frame.kind == FrameKind::Geom;
    match subject {
        SensorSubject::Frame { object, reference } => (std::iter::once(object).chain(reference))
            .filter(|frame| of_frame(frame))
            .map(|frame| frame.name.as_str())
            .collect(),
        SensorSubject::Inside { object, .. } if of_frame(object) => vec![&object.name],
        SensorSubject::Geoms(sides) => (sides.iter())
            .filter_map(|side| match side {
                GeomsName::Geom(name) => Some(name.as_str()),
                GeomsName::Body(_) => None,
            })
            .collect(),
        SensorSubject::Contacts(query) => (query.sides.iter())
            .filter_map(|side| match side {
                ContactSideName::Geom(name) => Some(name.as_str()),
                ContactSideName::Any | ContactSideName::Body(_) | ContactSideName::Subtree(_) => {
                    None
                }
            })
            .collect(),
        SensorSubject::Taxels { geom, .. } => vec![geom],
        SensorSubject::Nothing
        | SensorSubject::Element(_)
        | SensorSubject::Inside { .. }
        | SensorSubject::Projection { .. }
        | SensorSubject::Rays { .. }
        | SensorSubject::User(..) => Vec::new(),
    }
}
