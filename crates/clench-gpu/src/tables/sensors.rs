//! Sensors: their method, object and cutoff; and the actuators of each tendon.

use super::distances::pairs_of;
use super::frames::Frame;
use super::solids::solid_count;
use super::{NONE, Tables, starts};
use crate::codes::{Code, codes, row};
use clench_rigid::model::{
    Attachment, ContactField, ContactQuery, ContactReduction, ContactSide, FrameObject, Model,
    Sensor, SensorData, SensorKind, SensorTarget, Transmission,
};

row! {
    /// The words of a sensor.
    words SensorWords, "SENSOR" {
        method,
        kind,
        /// The offset of its numbers in `sensordata`, and their count.
        offset,
        dim,
        clip,
        object_kind,
        object,
        body,
        reference_kind,
        reference,
        reference_body,
        /// The shape of its site.
        shape,
        /// The offset of its buffer, or `NONE`.
        history,
    }
}
row! {
    /// The numbers of a sensor.
    numbers SensorNumbers, "SENSOR_PRM" {
        cutoff: 1,
        /// The margin of its limit.
        margin: 1,
        /// The size of its site.
        volume: 3,
        delay: 1,
        period: 1,
    }
}
codes! {
    /// The methods that read sensors.
    enum Method {
        Scalar = "OF_SCALAR",
        Frame = "OF_FRAME",
        Site = "OF_SITE",
        Subtree = "OF_SUBTREE",
        Ball = "OF_BALL",
        Nothing = "OF_NOTHING",
        Actuator = "OF_ACTUATOR",
        Contacts = "OF_CONTACTS",
        Distance = "OF_DISTANCE",
        Projection = "OF_PROJECTION",
        Enclosed = "OF_ENCLOSED",
        /// Read by a kernel of their own.
        Elsewhere = "OF_ELSEWHERE",
    }
}
codes! {
    /// The limits of a sensor's numbers.
    enum Clip {
        None = "UNCLIPPED",
        /// From minus the cutoff to the cutoff.
        Both = "CLIPPED",
        /// At most the cutoff.
        Above = "CLIPPED_ABOVE",
    }
}
row! {
    /// The words of a contact query, before its fields and the sides of each geom.
    words QueryWords, "QUERY" {
        reduction,
        /// The numbers of each contact.
        width,
        nfield,
    }
}
codes! {
    of ContactReduction {
        None = "FIRST_ONES",
        MinDist = "MIN_DIST",
        MaxForce = "MAX_FORCE",
        NetForce = "NET_FORCE",
    }
}
/// The flags of a geom's sides of a query.
const FIRST_SIDE: usize = 1;
const SECOND_SIDE: usize = 2;
/// The words of an object: the kind of its frame, its index, and its body.
#[derive(Clone, Copy)]
struct Object {
    kind: Frame,
    index: usize,
    body: usize,
}

impl Object {
    const NONE: Object = Object::new(Frame::None, 0);

    /// Returns an object whose body is not read.
    const fn new(kind: Frame, index: usize) -> Self {
        let body = 0;
        Object { kind, index, body }
    }
}

fn frame(m: &Model, object: FrameObject) -> Object {
    let (kind, index, body) = match object {
        FrameObject::Inertial(b) => (Frame::Inertial, b, b),
        FrameObject::Body(b) => (Frame::Body, b, b),
        FrameObject::Geom(g) => (Frame::Geom, g, m.geoms[g].body),
        FrameObject::Site(s) => (Frame::Site, s, m.sites[s].body),
        FrameObject::Camera(c) => (Frame::Camera, c, m.cameras[c].body),
    };
    Object { kind, index, body }
}

/// Returns the method that reads a kind of sensor, except those of enclosure.
fn method(kind: SensorKind) -> Method {
    use SensorKind as Kind;
    match kind {
        Kind::Touch
        | Kind::JointPos
        | Kind::JointVel
        | Kind::JointActuatorFrc
        | Kind::JointLimitPos
        | Kind::JointLimitVel
        | Kind::JointLimitFrc
        | Kind::TendonPos
        | Kind::TendonVel
        | Kind::TendonActuatorFrc
        | Kind::TendonLimitPos
        | Kind::TendonLimitVel
        | Kind::TendonLimitFrc
        | Kind::InsideSite
        | Kind::PotentialEnergy
        | Kind::KineticEnergy
        | Kind::Clock => Method::Scalar,
        Kind::FramePos
        | Kind::FrameQuat
        | Kind::FrameXAxis
        | Kind::FrameYAxis
        | Kind::FrameZAxis
        | Kind::FrameLinVel
        | Kind::FrameAngVel
        | Kind::FrameLinAcc
        | Kind::FrameAngAcc => Method::Frame,
        Kind::Accelerometer
        | Kind::Velocimeter
        | Kind::Gyro
        | Kind::Force
        | Kind::Torque
        | Kind::Magnetometer => Method::Site,
        Kind::SubtreeCom | Kind::SubtreeLinVel | Kind::SubtreeAngMom => Method::Subtree,
        Kind::BallQuat | Kind::BallAngVel => Method::Ball,
        Kind::ActuatorPos | Kind::ActuatorVel | Kind::ActuatorFrc => Method::Actuator,
        Kind::Contact => Method::Contacts,
        Kind::Distance | Kind::Normal | Kind::FromTo => Method::Distance,
        Kind::CamProjection => Method::Projection,
        Kind::Rangefinder | Kind::Tactile => Method::Elsewhere,
        Kind::User => Method::Nothing,
    }
}

/// Returns the object of a sensor that has one element, and its reference.
fn of_element(m: &Model, kind: SensorKind, e: usize) -> [Object; 2] {
    let limits_tendon = matches!(
        kind,
        SensorKind::TendonLimitPos | SensorKind::TendonLimitVel | SensorKind::TendonLimitFrc
    );
    match kind.attachment() {
        Attachment::Site => [Object::new(Frame::Site, e), Object::NONE],
        // Up to the end of its subtree.
        Attachment::Body => [
            Object::new(Frame::Body, e),
            Object::new(Frame::None, m.subtree(e).end),
        ],
        // Represented by their first output.
        Attachment::Actuator => {
            let output = m.actuators[e].outputs.start;
            [Object::new(Frame::None, output), Object::NONE]
        }
        // Limits are represented by coordinates: joints, then tendons.
        Attachment::Tendon if limits_tendon => {
            let coordinate = m.joints.len() + e;
            [Object::new(Frame::None, coordinate), Object::NONE]
        }
        Attachment::ScalarJoint | Attachment::Ball | Attachment::Joint | Attachment::Tendon => {
            [Object::new(Frame::None, e), Object::NONE]
        }
        // The builder gives these other targets.
        Attachment::Nothing
        | Attachment::Frame
        | Attachment::WorldFrame
        | Attachment::Inside
        | Attachment::Projection
        | Attachment::Rays
        | Attachment::Geoms
        | Attachment::Contacts
        | Attachment::Taxels
        | Attachment::User => [Object::NONE; 2],
    }
}

/// Returns the method, the object and the reference of a sensor. The objects of distances, contacts and enclosure are
/// offsets in other tables, which follow.
fn target(m: &Model, sensor: &Sensor) -> (Method, [Object; 2]) {
    let objects = match &sensor.target {
        SensorTarget::Frame { object, reference } => {
            let reference = reference.map_or(Object::NONE, |other| frame(m, other));
            [frame(m, *object), reference]
        }
        SensorTarget::Inside { enclosed: true, .. } => {
            return (Method::Enclosed, [Object::NONE; 2]);
        }
        SensorTarget::Inside {
            site,
            object,
            enclosed: false,
        } => [frame(m, *object), Object::new(Frame::Site, *site)],
        SensorTarget::Projection { site, camera } => [
            Object::new(Frame::Site, *site),
            Object::new(Frame::Camera, *camera),
        ],
        SensorTarget::Element(e) => of_element(m, sensor.kind, *e),
        SensorTarget::Rays { .. }
        | SensorTarget::Taxels { .. }
        | SensorTarget::Geoms(_)
        | SensorTarget::Nothing => [Object::NONE; 2],
        SensorTarget::Contacts(query) => {
            let site = query.site.unwrap_or(NONE as usize);
            [Object::NONE, Object::new(Frame::Site, site)]
        }
    };
    (method(sensor.kind), objects)
}

/// Returns the words of a contact query.
fn query(m: &Model, query: &ContactQuery) -> Vec<usize> {
    let row = QueryWords {
        reduction: query.reduction.code(),
        width: query.size(),
        nfield: query.fields.len(),
    };
    let mut row = row.words().to_vec();
    row.extend(query.fields.iter().map(|&field| field as usize));
    let belongs = |geom: usize, side: &ContactSide| match side {
        ContactSide::Any => true,
        ContactSide::Geom(wanted) => geom == *wanted,
        ContactSide::Body(body) => m.geoms[geom].body == *body,
        ContactSide::Subtree(bodies) => bodies.contains(&m.geoms[geom].body),
    };
    let [first, second] = &query.sides;
    let sides = |g: usize| {
        FIRST_SIDE * usize::from(belongs(g, first)) + SECOND_SIDE * usize::from(belongs(g, second))
    };
    row.extend((0..m.geoms.len()).map(sides));
    row
}

/// Returns true if any sensor has a delay or a period, and so a measurement buffer.
pub(crate) fn has_sensor_history(m: &Model) -> bool {
    m.sensors.iter().any(|sensor| sensor.history.is_some())
}

impl Tables {
    pub(super) fn sensors(&mut self, m: &Model) {
        self.sensor_constants();
        let p = &m.params;
        let (mut words, mut numbers, mut queries) = (Vec::new(), Vec::new(), Vec::new());
        self.flag("SENSING", m.flags.sensor);
        self.flag("ANY_SENSOR_HISTORY", has_sensor_history(m));
        let buffers = m.sensors.iter().map(|s| s.history.as_ref());
        let histories = self.histories("SENSOR_HISTORIES", buffers);
        self.count("NSENSOR", m.sensors.len());
        let (mut measured, mut solids) = (0, 0);
        for ((k, sensor), history) in m.sensors.iter().enumerate().zip(histories) {
            let (method, [mut object, mut reference]) = target(m, sensor);
            if let SensorTarget::Geoms(_) = &sensor.target {
                object.index = measured;
                measured += pairs_of(m, sensor).len();
                reference.index = measured;
            }
            if let SensorTarget::Inside { enclosed: true, .. } = &sensor.target {
                object.index = solids;
                solids += solid_count(m, sensor);
                reference.index = solids;
            }
            if let SensorTarget::Contacts(of) = &sensor.target {
                object.index = queries.len();
                queries.extend(query(m, of));
            }
            let site = site_of(sensor);
            let row = SensorWords {
                method: method.code(),
                kind: sensor.kind as usize,
                offset: sensor.numbers.start,
                dim: sensor.numbers.len(),
                clip: clip(sensor).code(),
                object_kind: object.kind.code(),
                object: object.index,
                body: object.body,
                reference_kind: reference.kind.code(),
                reference: reference.index,
                reference_body: reference.body,
                shape: site.map_or(0, |site| m.sites[site].kind.code()),
                history,
            };
            words.extend(row.words());
            let row = SensorNumbers {
                cutoff: [sensor.cutoff],
                margin: [limit_margin(m, sensor)],
                volume: site.map_or([0.0; 3], |site| p.site_size[site].to_array()),
                delay: [p.sensor_delay[k]],
                period: [p.sensor_interval[k]],
            };
            numbers.extend(row.numbers());
        }
        self.words("SENSORS", words);
        self.words("QUERIES", queries);
        self.numbers("SENSOR_PRM", numbers);
        self.numbers("MAGNETIC", p.magnetic.to_array());
        self.pulls(m);
    }

    fn sensor_constants(&mut self) {
        self.row::<SensorWords>();
        self.row::<SensorNumbers>();
        self.codes::<Method>();
        self.codes::<Clip>();
        self.codes::<Frame>();
        self.row::<QueryWords>();
        self.codes::<ContactReduction>();
        self.constant("FIRST_SIDE", FIRST_SIDE);
        self.constant("SECOND_SIDE", SECOND_SIDE);
        // A method that reads one kind does not need its code.
        let kinds = SensorKind::ALL.iter().map(|&kind| (kind, method(kind)));
        let has_others = |&(_, of): &(SensorKind, Method)| {
            of != Method::Elsewhere && kinds.clone().filter(|k| k.1 == of).count() > 1
        };
        for (kind, _) in kinds.clone().filter(has_others) {
            let name = format!("SENSE_{}", kind.name().to_uppercase());
            self.constant(&name, kind as usize);
        }
        for &field in ContactField::ALL {
            let name = format!("CONTACT_DATA_{}", field.name().to_uppercase());
            self.constant(&name, field as usize);
        }
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

/// Returns the limits of a sensor's numbers. Rangefinders clip in the ray kernel.
fn clip(sensor: &Sensor) -> Clip {
    let unclipped = matches!(
        sensor.kind,
        SensorKind::Contact | SensorKind::FromTo | SensorKind::Rangefinder
    );
    match sensor.data {
        _ if unclipped || sensor.cutoff <= 0.0 => Clip::None,
        SensorData::Real => Clip::Both,
        SensorData::Positive => Clip::Above,
        SensorData::Axis | SensorData::Quaternion => Clip::None,
    }
}

/// Returns the site in whose volume a sensor measures.
fn site_of(sensor: &Sensor) -> Option<usize> {
    match &sensor.target {
        SensorTarget::Inside { site, .. } => Some(*site),
        SensorTarget::Contacts(query) => query.site,
        SensorTarget::Element(site) => (sensor.kind == SensorKind::Touch).then_some(*site),
        SensorTarget::Nothing
        | SensorTarget::Frame { .. }
        | SensorTarget::Projection { .. }
        | SensorTarget::Rays { .. }
        | SensorTarget::Geoms(_)
        | SensorTarget::Taxels { .. } => None,
    }
}

/// Returns the margin of the limit whose distance a sensor measures; zero for the other kinds.
fn limit_margin(m: &Model, sensor: &Sensor) -> f64 {
    match (sensor.kind, &sensor.target) {
        (SensorKind::JointLimitPos, &SensorTarget::Element(j)) => m.params.jnt_margin[j],
        (SensorKind::TendonLimitPos, &SensorTarget::Element(t)) => m.params.tendon_margin[t],
        _ => 0.0,
    }
}
