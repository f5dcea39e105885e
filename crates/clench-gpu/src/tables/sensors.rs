//! Sensors: their method, object and cutoff; and the actuators of each tendon.

use super::distances::{is_measured, pairs_of};
use super::{NONE, Tables, starts};
use clench_rigid::model::{
    ContactField, ContactQuery, ContactReduction, ContactSide, FrameObject, Model, Sensor,
    SensorData, SensorKind, SensorTarget, Transmission,
};

/// The words of a sensor.
const SENSOR_FIELDS: [&str; 13] = [
    "SENSOR_WAY",
    "SENSOR_KIND",
    "SENSOR_PLACE",
    "SENSOR_DIM",
    "SENSOR_CLIP",
    "SENSOR_OBJECT_KIND",
    "SENSOR_OBJECT",
    "SENSOR_BODY",
    "SENSOR_REFERENCE_KIND",
    "SENSOR_REFERENCE",
    "SENSOR_REFERENCE_BODY",
    "SENSOR_SHAPE",
    "SENSOR_HISTORY",
];
/// The numbers of a sensor: its cutoff, the margin of its limit, the size of its site, its delay and its period.
const SENSOR_PRM_SIZE: usize = 7;
/// The methods that read sensors.
const WAYS: [&str; 11] = [
    "OF_SCALAR",
    "OF_FRAME",
    "OF_SITE",
    "OF_SUBTREE",
    "OF_BALL",
    "OF_NOTHING",
    "OF_ACTUATOR",
    "OF_CONTACTS",
    "OF_DISTANCE",
    "OF_PROJECTION",
    "OF_RAYS",
];
/// The words of a contact query, before its fields and the sides of each geom.
const QUERY: [&str; 4] = [
    "QUERY_REDUCTION",
    "QUERY_SIZE",
    "QUERY_NFIELD",
    "QUERY_FIELDS",
];
/// The reductions of contacts.
const REDUCTIONS: [&str; 4] = ["FIRST_ONES", "MIN_DIST", "MAX_FORCE", "NET_FORCE"];
/// The kinds of object with a frame.
const FRAMES: [&str; 6] = [
    "NO_FRAME",
    "INERTIAL_FRAME",
    "BODY_FRAME",
    "GEOM_FRAME",
    "SITE_FRAME",
    "CAMERA_FRAME",
];

/// Returns the words of a frame: the kind of its object, its index, and its body.
fn frame(m: &Model, object: FrameObject) -> [usize; 3] {
    let (kind, index, body) = match object {
        FrameObject::Inertial(b) => (1, b, b),
        FrameObject::Body(b) => (2, b, b),
        FrameObject::Geom(g) => (3, g, m.geoms[g].body),
        FrameObject::Site(s) => (4, s, m.sites[s].body),
        FrameObject::Camera(c) => (5, c, m.cameras[c].body),
    };
    [kind, index, body]
}

/// Returns the method, the object and the reference of a sensor, as in [`SENSOR_FIELDS`]; `None` if the device does not
/// support it.
fn target(m: &Model, sensor: &Sensor) -> Option<(usize, [usize; 3], [usize; 3])> {
    use SensorKind as Kind;
    let none = [0; 3];
    Some(match &sensor.target {
        SensorTarget::Frame { object, reference } => {
            let reference = reference.map_or(none, |other| frame(m, other));
            (1, frame(m, *object), reference)
        }
        SensorTarget::Inside { enclosed: true, .. } => return None,
        SensorTarget::Inside { site, object, .. } => (0, frame(m, *object), [4, *site, 0]),
        SensorTarget::Projection { site, camera } => (9, [4, *site, 0], [5, *camera, 0]),
        SensorTarget::Rays { .. } => (10, none, none),
        SensorTarget::Element(e) => match sensor.kind {
            Kind::Accelerometer
            | Kind::Velocimeter
            | Kind::Gyro
            | Kind::Force
            | Kind::Torque
            | Kind::Magnetometer => (2, [4, *e, 0], none),
            Kind::SubtreeCom | Kind::SubtreeLinVel | Kind::SubtreeAngMom => {
                (3, [2, *e, 0], [0, m.subtree(*e).end, 0])
            }
            Kind::BallQuat | Kind::BallAngVel => (4, [0, *e, 0], none),
            // Represented by their first output.
            Kind::ActuatorPos | Kind::ActuatorVel | Kind::ActuatorFrc => {
                (6, [0, m.actuators[*e].outputs.start, 0], none)
            }
            // Limits are represented by coordinates: joints, then tendons.
            Kind::TendonLimitPos | Kind::TendonLimitVel | Kind::TendonLimitFrc => {
                (0, [0, m.joints.len() + e, 0], none)
            }
            _ => (0, [0, *e, 0], none),
        },
        SensorTarget::Nothing if sensor.kind == Kind::User => (5, none, none),
        SensorTarget::Nothing => (0, none, none),
        SensorTarget::Geoms(_) if is_measured(m, sensor) => (8, none, none),
        SensorTarget::Contacts(query) => (7, none, [4, query.site.unwrap_or(NONE as usize), 0]),
        _ => return None,
    })
}

/// Returns the words of a contact query.
fn query(m: &Model, query: &ContactQuery) -> Vec<usize> {
    let reduction = match query.reduction {
        ContactReduction::None => 0,
        ContactReduction::MinDist => 1,
        ContactReduction::MaxForce => 2,
        ContactReduction::NetForce => 3,
    };
    let mut row = vec![reduction, query.size(), query.fields.len()];
    row.extend(query.fields.iter().map(|&field| field as usize));
    let belongs = |geom: usize, side: &ContactSide| match side {
        ContactSide::Any => true,
        ContactSide::Geom(wanted) => geom == *wanted,
        ContactSide::Body(body) => m.geoms[geom].body == *body,
        ContactSide::Subtree(bodies) => bodies.contains(&m.geoms[geom].body),
    };
    let [first, second] = &query.sides;
    let sides = |g: usize| usize::from(belongs(g, first)) + 2 * usize::from(belongs(g, second));
    row.extend((0..m.geoms.len()).map(sides));
    row
}

/// Returns true if a device supports a sensor.
pub(crate) fn is_read(m: &Model, sensor: &Sensor) -> bool {
    target(m, sensor).is_some()
}

/// Returns true if any sensor has a delay or a period, and so a measurement buffer.
pub(crate) fn has_sensor_history(m: &Model) -> bool {
    m.sensors.iter().any(|sensor| sensor.history.is_some())
}

impl Tables {
    pub(super) fn sensors(&mut self, m: &Model) {
        for names in [&SENSOR_FIELDS[..], &WAYS, &FRAMES, &QUERY, &REDUCTIONS] {
            for (code, name) in names.iter().enumerate() {
                self.constant(name, code);
            }
        }
        for &kind in SensorKind::ALL {
            self.constant(
                &format!("SENSE_{}", kind.name().to_uppercase()),
                kind as usize,
            );
        }
        for &field in ContactField::ALL {
            let name = format!("CONTACT_DATA_{}", field.name().to_uppercase());
            self.constant(&name, field as usize);
        }
        self.constant("SENSOR_SIZE", SENSOR_FIELDS.len());
        self.constant("SENSOR_PRM_SIZE", SENSOR_PRM_SIZE);
        let p = &m.params;
        let (mut words, mut numbers, mut queries) = (Vec::new(), Vec::new(), Vec::new());
        let read = |(k, s)| Some((k, s, target(m, s)?));
        let readable = Vec::from_iter(m.sensors.iter().enumerate().filter_map(read));
        self.flag("SENSING", m.flags.sensor);
        self.flag("ANY_SENSOR_HISTORY", has_sensor_history(m));
        let buffers = readable.iter().map(|(_, s, _)| s.history.as_ref());
        let mut buffers = self.histories("SENSOR_HISTORIES", buffers).into_iter();
        let (mut count, mut measured) = (0, 0);
        for (k, sensor, (way, mut object, mut reference)) in readable {
            if let SensorTarget::Geoms(_) = &sensor.target {
                object[1] = measured;
                measured += pairs_of(m, sensor).len();
                reference[1] = measured;
            }
            if let SensorTarget::Contacts(of) = &sensor.target {
                object[1] = queries.len();
                queries.extend(query(m, of));
            }
            let element = object[1];
            let site = match &sensor.target {
                SensorTarget::Inside { site, .. } => Some(*site),
                SensorTarget::Contacts(query) => query.site,
                SensorTarget::Element(site) if sensor.kind == SensorKind::Touch => Some(*site),
                _ => None,
            };
            // Rangefinders clip in the ray kernel.
            let unclipped = matches!(
                sensor.kind,
                SensorKind::Contact | SensorKind::FromTo | SensorKind::Rangefinder
            );
            let clips = sensor.cutoff > 0.0 && !unclipped;
            let clip = match sensor.data {
                SensorData::Real if clips => 1,
                SensorData::Positive if clips => 2,
                _ => 0,
            };
            let shape = site.map_or(0, |site| m.sites[site].kind as usize);
            let (place, dim) = (sensor.numbers.start, sensor.numbers.len());
            words.extend([way, sensor.kind as usize, place, dim, clip]);
            words.extend(object.into_iter().chain(reference).chain([shape]));
            words.extend(buffers.next());
            let margin = match sensor.kind {
                SensorKind::JointLimitPos => p.jnt_margin[element],
                SensorKind::TendonLimitPos => p.tendon_margin[element - m.joints.len()],
                _ => 0.0,
            };
            let size = site.map_or([0.0; 3], |site| p.site_size[site].to_array());
            numbers.extend([sensor.cutoff, margin].into_iter().chain(size));
            numbers.extend([p.sensor_delay[k], p.sensor_interval[k]]);
            count += 1;
        }
        self.count("NSENSOR", count);
        self.words("SENSORS", words);
        self.words("QUERIES", queries);
        self.numbers("SENSOR_PRM", numbers);
        self.numbers("MAGNETIC", p.magnetic.to_array());
        self.pulls(m);
    }

    /// Adds the actuators of each tendon, and their gears.
    fn pulls(&mut self, m: &Model) {
        let of = |t: usize| {
            let each = m.actuators.iter().enumerate();
            let pulls = each.filter(move |(_, a)| a.transmission == Transmission::Tendon(t));
            Vec::from_iter(pulls.map(|(u, _)| u))
        };
        let all = Vec::from_iter((0..m.tendons.len()).map(of));
        self.words("TENDON_PULL", starts(all.iter().map(Vec::len)));
        let output = |&u: &usize| m.actuators[u].outputs.start;
        self.words("PULL_OUTPUT", all.iter().flatten().map(output));
        let gear = |&u: &usize| m.params.actuator_gear[u][0];
        self.numbers("PULL_GEAR", all.iter().flatten().map(gear));
    }
}
