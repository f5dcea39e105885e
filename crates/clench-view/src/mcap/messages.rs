//! The messages of a moment.

use super::shapes::{self, point, pose};
use clench::Model;
use clench::math::{Quat, Real, Vec3};
use clench::rigid::model::JointKind;
use clench::rigid::readout::{Push, TendonLine, contact_rows};
use clench::rigid::{Precision, Sim};
use serde_json::{Map, Value, json};
use std::collections::HashSet;

/// The names of the solver statistics.
pub(crate) const SOLVER: [&str; 6] = [
    "iterations",
    "gap",
    "gradient",
    "penetration",
    "contacts",
    "islands",
];
/// The names of the energies, J.
pub(crate) const ENERGY: [&str; 2] = ["potential", "kinetic"];

/// The length of the arrow of the total weight over the size of the model.
const WEIGHT: f64 = 1.1;
/// The thickness of an arrow's shaft over the size of the model.
const THICK: f64 = 0.015;

const NORMAL: [f32; 4] = [0.18, 0.49, 0.88, 1.0];
const FRICTION: [f32; 4] = [0.94, 0.54, 0.14, 1.0];
const PUSH: [f32; 4] = [0.55, 0.36, 0.82, 1.0];

/// The input of the messages.
pub(crate) struct Moment<'a, T: Precision> {
    pub sim: &'a Sim<T>,
    /// The potential and kinetic energy, J.
    pub energy: [f64; 2],
    pub pushes: &'a [Push],
    pub frames: &'a [String],
    /// The length of arrows, m/N.
    pub scale: f64,
}

/// Returns a unique frame name for each body.
pub(crate) fn frame_names(model: &Model) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut name = |(index, body): (usize, &clench::rigid::model::Body)| {
        let mut name = match (index, body.name.as_str()) {
            (0, _) => "world".to_owned(),
            (_, "") => format!("body {index}"),
            (_, name) => name.to_owned(),
        };
        while !taken.insert(name.clone()) {
            name.push('\'');
        }
        name
    };
    model.bodies.iter().enumerate().map(&mut name).collect()
}

/// Returns a length scale of the model, m: the maximum, over the geoms of movable bodies, of the offsets of body and
/// geom plus the bounding radius.
fn size(model: &Model) -> f64 {
    let (p, count) = (&model.params, model.geoms.len());
    let moving = (0..count).filter(|&g| model.geoms[g].body > 0);
    let reach = moving.map(|g| {
        let radius = p.geom_rbound[g];
        let parent = model.geoms[g].body;
        p.body_pos[parent].norm() + p.geom_pos[g].norm() + radius
    });
    let far = reach.filter(|x| x.is_finite()).fold(0.0, f64::max);
    if far > 0.0 { far } else { 1.0 }
}

/// Returns the length of arrows, m/N; the arrow of the total weight is slightly longer than the model.
pub(crate) fn force_scale(model: &Model) -> f64 {
    let weight = 9.81 * model.params.body_mass.iter().sum::<f64>();
    WEIGHT * size(model) / weight.max(1e-9)
}

/// Returns the name, or a substitute if it is empty.
fn named(name: &str, kind: &str, index: usize) -> String {
    match name {
        "" => format!("{kind} {index}"),
        name => name.to_owned(),
    }
}

/// Iterates over the joints with one coordinate.
fn plain_joints(model: &Model) -> impl Iterator<Item = (usize, &clench::rigid::model::Joint)> {
    let joints = model.joints.iter().enumerate();
    joints.filter(|(_, joint)| matches!(joint.kind, JointKind::Slide | JointKind::Hinge))
}

/// Returns the names of the joints with one coordinate.
pub(crate) fn joint_names(model: &Model) -> Vec<String> {
    plain_joints(model)
        .map(|(j, joint)| named(&joint.name, "joint", j))
        .collect()
}

/// Returns the names of all controls.
pub(crate) fn control_names(model: &Model) -> Vec<String> {
    let mut names = Vec::with_capacity(model.nu());
    for (a, actuator) in model.actuators.iter().enumerate() {
        let name = named(&actuator.name, "actuator", a);
        match actuator.controls.len() {
            1 => names.push(name),
            several => names.extend((0..several).map(|k| format!("{name} {k}"))),
        }
    }
    names
}

/// Returns the names of all sensors.
pub(crate) fn sensor_names(model: &Model) -> Vec<String> {
    let sensors = model.sensors.iter().enumerate();
    sensors
        .map(|(s, sensor)| named(&sensor.name, "sensor", s))
        .collect()
}

/// Builds the message of the poses of body frames.
pub(crate) fn frames<T: Precision>(moment: &Moment<T>, time: &Value) -> Value {
    let position = &moment.sim.workspace().position;
    let transform = |body: usize| {
        let at = position.xpos[body].to_array().map(|x| x.lane(0).to_f64());
        let quat = position.xquat[body].to_array().map(|x| x.lane(0).to_f64());
        json!({
            "timestamp": time,
            "parent_frame_id": moment.frames[0],
            "child_frame_id": moment.frames[body],
            "translation": point(at),
            "rotation": shapes::quaternion(quat),
        })
    };
    let transforms: Vec<_> = (1..moment.frames.len()).map(transform).collect();
    json!({ "transforms": transforms })
}

/// Builds a scene entity with these lists of primitives.
fn entity(time: &Value, frame: &str, id: &str, things: Map<String, Value>) -> Value {
    let mut entity = json!({
        "timestamp": time,
        "frame_id": frame,
        "id": id,
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": true,
        "metadata": [], "arrows": [], "cubes": [], "spheres": [], "cylinders": [], "lines": [], "triangles": [],
        "texts": [], "models": [],
    });
    if let Value::Object(fields) = &mut entity {
        fields.extend(things);
    }
    entity
}

fn update(entities: Vec<Value>) -> Value {
    json!({"deletions": [], "entities": entities})
}

/// Builds the message of the shapes of bodies, each in its body frame.
pub(crate) fn shapes<T: Precision>(moment: &Moment<T>, time: &Value) -> Value {
    let model = moment.sim.model();
    let of_body = |body: usize| {
        let things = shapes::of_body(model, body);
        let (frame, id) = (&moment.frames[body], format!("body {body}"));
        (!things.is_empty()).then(|| entity(time, frame, &id, things))
    };
    update((0..model.nbody()).filter_map(of_body).collect())
}

/// Builds the message of forces: contacts, then connects, welds and limits.
pub(crate) fn forces<T: Precision>(moment: &Moment<T>, time: &Value) -> Value {
    let mut arrows = Vec::new();
    let thick = THICK * size(moment.sim.model());
    let mut add = |at: [f64; 3], force: Vec3<f64>, color: [f32; 4]| {
        let length = moment.scale * force.norm();
        if length < 0.2 * thick {
            return;
        }
        let head = (3.0 * thick).min(0.5 * length);
        let quat = Quat::from_two_vectors(Vec3::new(1.0, 0.0, 0.0), force.normalize().0);
        arrows.push(json!({
            "pose": pose(at, quat.to_array()),
            "shaft_length": length - head,
            "shaft_diameter": thick,
            "head_length": head,
            "head_diameter": 2.2 * thick,
            "color": shapes::color(color),
        }));
    };
    for row in contact_rows(moment.sim.workspace(), 0) {
        let axis = |k: usize| Vec3::from_array(row.frame[k]);
        add(row.pos, axis(0) * row.force[0], NORMAL);
        let along = axis(1) * row.force[1] + axis(2) * row.force[2];
        add(row.pos, along, FRICTION);
    }
    for push in moment.pushes {
        add(push.at, Vec3::from_array(push.force), PUSH);
    }
    let things = Map::from_iter([("arrows".to_owned(), Value::Array(arrows))]);
    update(vec![entity(time, &moment.frames[0], "forces", things)])
}

/// Builds the message of the straight segments of tendons.
pub(crate) fn tendons<T: Precision>(moment: &Moment<T>, time: &Value) -> Value {
    let model = moment.sim.model();
    let line = |TendonLine { tendon, ends }| {
        let [from, to] = ends.map(|end| point(end.map(f64::from)));
        json!({
            "type": 2,
            "pose": pose([0.0; 3], [1.0, 0.0, 0.0, 0.0]),
            "thickness": 2.0 * model.visuals.tendon_width[tendon],
            "scale_invariant": false,
            "points": [from, to],
            "color": shapes::color(model.visuals.rgba(model.visuals.tendons[tendon])),
            "colors": [], "indices": [],
        })
    };
    let lines = moment.sim.tendon_lines().into_iter().map(line).collect();
    let things = Map::from_iter([("lines".to_owned(), Value::Array(lines))]);
    update(vec![entity(time, &moment.frames[0], "tendons", things)])
}

/// Builds an object of named numbers.
fn record(names: impl IntoIterator<Item = impl Into<String>>, numbers: Vec<Value>) -> Value {
    Value::Object(names.into_iter().map(Into::into).zip(numbers).collect())
}

/// Builds the message of the last solve's statistics.
pub(crate) fn solver<T: Precision>(moment: &Moment<T>) -> Value {
    let (stats, contacts) = (moment.sim.stats(), moment.sim.contacts());
    let depths = contacts
        .iter()
        .map(|contact| -contact.dist.lane(0).to_f64());
    let numbers = vec![
        json!(stats.iterations),
        json!(stats.gap),
        json!(stats.gradient),
        json!(depths.fold(0.0, f64::max)),
        json!(contacts.len()),
        json!(stats.islands),
    ];
    record(SOLVER, numbers)
}

/// Builds the message of the energies.
pub(crate) fn energy<T: Precision>(moment: &Moment<T>) -> Value {
    record(ENERGY, moment.energy.map(|x| json!(x)).to_vec())
}

/// Builds the message of positions (m, rad) and velocities of slides and hinges.
pub(crate) fn joints<T: Precision>(moment: &Moment<T>) -> Value {
    let (model, state) = (moment.sim.model(), &moment.sim.state);
    let of = |(_, joint): (usize, &clench::rigid::model::Joint)| {
        let (position, velocity) = (state.qpos[joint.qpos], state.qvel[joint.dof]);
        json!({"position": position.to_f64(), "velocity": velocity.to_f64()})
    };
    record(joint_names(model), plain_joints(model).map(of).collect())
}

/// Builds the message of the controls.
pub(crate) fn controls<T: Precision>(moment: &Moment<T>) -> Value {
    let numbers = moment.sim.state.ctrl.iter().map(|x| json!(x.to_f64()));
    record(control_names(moment.sim.model()), numbers.collect())
}

/// Builds the message of the sensor values.
pub(crate) fn sensors<T: Precision>(moment: &Moment<T>) -> Value {
    let model = moment.sim.model();
    let data = &moment.sim.workspace().sensors.data;
    let of = |sensor: &clench::rigid::model::Sensor| {
        let numbers = data[sensor.numbers.clone()].iter();
        json!(numbers.map(|x| x.lane(0).to_f64()).collect::<Vec<_>>())
    };
    record(sensor_names(model), model.sensors.iter().map(of).collect())
}
