//! Scaling of pairs, tendons and sensors; `equality.rs` scales equalities.

use super::{Along, Coordinate, FrameId, Frames, Scale, located};
use crate::error::LoadError;
use crate::mjcf::linear_map::LinearMap;
use clench_builder::{
    FrameKind, FrameName, GeomsName, ModelBuilder, SensorSpec, SensorSubject, TENDON_NUMBERS,
    TendonSpec, WrapSpec,
};
use clench_dynamics::model::{Attachment, JointKind, SensorDimension};
use std::collections::BTreeMap;

impl Frames {
    fn of(&self, names: &BTreeMap<String, FrameId>, name: &str) -> Scale {
        self.scale(names.get(name).copied().unwrap_or(0))
    }

    pub(in crate::mjcf) fn of_body(&self, name: &str) -> Scale {
        self.scale(self.bodies.get(name).map_or(0, |&(frame, _)| frame))
    }

    /// Returns the map of positions in body axes.
    pub(in crate::mjcf) fn in_body(&self, name: &str) -> LinearMap {
        let found = self.bodies.get(name);
        found.map_or(LinearMap::NONE, |&(_, linear_map)| linear_map)
    }

    pub(in crate::mjcf) fn of_site(&self, name: &str) -> Scale {
        self.of(&self.sites, name)
    }

    /// Returns the factors of a joint's coordinate, and of forces along it.
    pub(in crate::mjcf) fn of_joint(&self, name: &str) -> Along {
        let Some(joint) = self.joints.get(name) else {
            return Scale::ONE.along(Coordinate::Angle);
        };
        let coordinate = Coordinate::of_joint(joint.kind).unwrap_or(Coordinate::Angle);
        let scale = self.scale(joint.frame);
        scale.along_direction(coordinate, joint.length)
    }

    /// Returns the scale of a joint's frame if it is a free joint.
    pub(super) fn of_free_joint(&self, name: &str) -> Option<Scale> {
        let joint = self.joints.get(name)?;
        (joint.kind == JointKind::Free).then(|| self.scale(joint.frame))
    }

    /// Returns the factors of a tendon's length, and of forces along it.
    pub(in crate::mjcf) fn of_tendon(&self, name: &str) -> Along {
        let found = self.tendons.get(name).copied();
        let (frame, coordinate) = found.unwrap_or((0, Coordinate::Length));
        self.scale(frame).along(coordinate)
    }

    pub(super) fn scale_pairs(&self, builder: &mut ModelBuilder) {
        for pair in &mut builder.pairs {
            let [first, second] = [&pair.geom1, &pair.geom2].map(|name| self.of(&self.geoms, name));
            let scale = first.mean(second);
            if let Some([_, _, rest @ ..]) = &mut pair.friction {
                rest.iter_mut().for_each(|length| *length *= scale.length);
            }
            if let Some([_, _, width, ..]) = &mut pair.solimp {
                *width *= scale.length;
            }
            for length in [&mut pair.margin, &mut pair.gap].into_iter().flatten() {
                *length *= scale.length;
            }
            if let Some(adhesion) = &mut pair.adhesion {
                *adhesion *= scale.force(1);
            }
        }
    }

    /// Scales tendons by the frames that enclose their entire path. The coordinate of a tendon is an angle if
    /// its path has only joints that rotate.
    pub(super) fn scale_tendons(&mut self, builder: &mut ModelBuilder) {
        for tendon in &mut builder.tendons {
            let frames = tendon.path.iter().filter_map(|wrap| match wrap {
                WrapSpec::Joint { joint, .. } => {
                    Some(self.joints.get(joint).map_or(0, |placed| placed.frame))
                }
                WrapSpec::Site(site) => Some(self.sites.get(site).copied().unwrap_or(0)),
                WrapSpec::Geom { geom, .. } => Some(self.geoms.get(geom).copied().unwrap_or(0)),
                WrapSpec::Pulley(_) => None,
            });
            let frame = frames.reduce(|a, b| self.common(a, b)).unwrap_or(0);
            let turns = |wrap: &WrapSpec| match wrap {
                WrapSpec::Joint { joint, .. } => (self.joints.get(joint)).is_some_and(|placed| {
                    Coordinate::of_joint(placed.kind) != Some(Coordinate::Length)
                }),
                _ => false,
            };
            let coordinate = match tendon.path.iter().all(turns) {
                true => Coordinate::Angle,
                false => Coordinate::Length,
            };
            let scale = self.scale(frame);
            let along = scale.along(coordinate);
            for wrap in &mut tendon.path {
                if let WrapSpec::Joint { joint, coef } = wrap {
                    *coef *= along.coordinate / self.of_joint(joint).coordinate;
                }
            }
            scale_tendon(tendon, along);
            tendon.width *= scale.length;
            self.all_tendons.push((frame, coordinate));
            self.tendons
                .insert(tendon.name.clone(), (frame, coordinate));
        }
    }

    /// Scales the cutoff and the noise of each sensor.
    ///
    /// # Errors
    /// Returns an error for a tactile sensor, whose mesh points would have to be scaled.
    pub(super) fn scale_sensors(&self, builder: &mut ModelBuilder) -> Result<(), LoadError> {
        for sensor in &mut builder.sensors {
            if let SensorSubject::Taxels { geom, .. } = &sensor.subject
                && self.of(&self.geoms, geom) != Scale::ONE
            {
                let message = "a tactile sensor cannot be scaled";
                return Err(located(&sensor.origin, "sensor", &sensor.name, message));
            }
            let factor = self.of_sensor(sensor);
            sensor.cutoff *= factor;
            sensor.noise *= factor;
        }
        Ok(())
    }
}

impl Along {
    /// Returns the factor of a quantity of this dimension along the coordinate.
    pub(super) fn of_dimension(self, dimension: SensorDimension) -> f64 {
        match dimension {
            SensorDimension::Coordinate => self.coordinate,
            SensorDimension::CoordinateForce => self.force,
            _ => 1.0,
        }
    }
}

impl Frames {
    /// Returns the factor of a sensor's values; those of actuator sensors are scaled with the actuator.
    fn of_sensor(&self, sensor: &SensorSpec) -> f64 {
        let dimension = sensor.kind.dimension();
        let scale = match &sensor.subject {
            SensorSubject::Element(name) => match sensor.kind.attachment() {
                Attachment::Site => self.of_site(name),
                Attachment::Body => self.of_body(name),
                Attachment::ScalarJoint | Attachment::Ball | Attachment::Joint => {
                    return self.of_joint(name).of_dimension(dimension);
                }
                Attachment::Tendon => return self.of_tendon(name).of_dimension(dimension),
                _ => Scale::ONE,
            },
            SensorSubject::Frame { object, .. } => self.of_object(object),
            SensorSubject::Rays { source, .. } => self.of_object(source),
            SensorSubject::Geoms(sides) => {
                let [first, second] = sides.each_ref().map(|side| match side {
                    GeomsName::Geom(name) => self.of(&self.geoms, name),
                    GeomsName::Body(name) => self.of_body(name),
                });
                first.mean(second)
            }
            _ => Scale::ONE,
        };
        match dimension {
            SensorDimension::Length => scale.length,
            SensorDimension::Force => scale.force(1),
            SensorDimension::Torque => scale.force(2),
            _ => 1.0,
        }
    }

    fn of_object(&self, object: &FrameName) -> Scale {
        match object.kind {
            FrameKind::Inertial | FrameKind::Body => self.of_body(&object.name),
            FrameKind::Geom => self.of(&self.geoms, &object.name),
            FrameKind::Site => self.of_site(&object.name),
            FrameKind::Camera => self.of(&self.cameras, &object.name),
        }
    }
}

fn scale_tendon(tendon: &mut TendonSpec, along: Along) {
    tendon.range = tendon.range.map(|end| end * along.coordinate);
    tendon.springlength = tendon
        .springlength
        .map(|rest| rest.map(|end| end * along.coordinate));
    tendon.solimp_limit[2] *= along.coordinate;
    tendon.solimp_friction[2] *= along.coordinate;
    tendon.actuatorfrcrange = tendon.actuatorfrcrange.map(|end| end * along.force);
    along.element_numbers(&TENDON_NUMBERS, &mut tendon.numbers_mut());
    along.polynomial(&mut tendon.stiffness);
    along.polynomial(&mut tendon.damping);
}
