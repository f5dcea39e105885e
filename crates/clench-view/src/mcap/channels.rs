//! The channels of a recording with their topics and schemas, one line of a table each.
//!
//! The schemas of `SceneUpdate` and `FrameTransforms` contain the fields that this crate fills and the lists that it
//! leaves empty, as Foxglove documents them (<https://docs.foxglove.dev/docs/sdk/schemas>); their quaternions have w
//! last.

use super::messages::{self, Moment};
use clench::Model;
use clench::rigid::Precision;
use serde_json::{Value, json};

/// A stream of messages of one kind.
pub(crate) struct Channel {
    pub topic: &'static str,
    pub schema_name: &'static str,
    pub schema: Value,
    /// True if only the first moment has a message.
    pub once: bool,
    pub message: MessageKind,
}

/// The content of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MessageKind {
    Frames,
    Shapes,
    Forces,
    Tendons,
    Solver,
    Energy,
    Joints,
    Controls,
    Sensors,
}

impl MessageKind {
    /// Builds the message of a moment; `time` is in Foxglove's format.
    pub(crate) fn message<T: Precision>(self, moment: &Moment<T>, time: &Value) -> Value {
        match self {
            MessageKind::Frames => messages::frames(moment, time),
            MessageKind::Shapes => messages::shapes(moment, time),
            MessageKind::Forces => messages::forces(moment, time),
            MessageKind::Tendons => messages::tendons(moment, time),
            MessageKind::Solver => messages::solver(moment),
            MessageKind::Energy => messages::energy(moment),
            MessageKind::Joints => messages::joints(moment),
            MessageKind::Controls => messages::controls(moment),
            MessageKind::Sensors => messages::sensors(moment),
        }
    }
}

/// Returns the channels of a model.
pub(crate) fn channels(model: &Model) -> Vec<Channel> {
    let channel = |topic, schema_name, schema, message| Channel {
        topic,
        schema_name,
        schema,
        once: message == MessageKind::Shapes,
        message,
    };
    let scene = |topic, message| channel(topic, "foxglove.SceneUpdate", scene_update(), message);
    let numbers = |topic, name, keys: Vec<String>, each: Value, message| {
        let properties = keys.into_iter().map(|key| (key, each.clone()));
        channel(topic, name, object(properties), message)
    };
    let owned = |keys: &[&str]| keys.iter().map(|&key| key.to_owned()).collect::<Vec<_>>();
    let mut all = vec![
        channel(
            "/tf",
            "foxglove.FrameTransforms",
            frame_transforms(),
            MessageKind::Frames,
        ),
        scene("/shapes", MessageKind::Shapes),
        scene("/forces", MessageKind::Forces),
        numbers(
            "/solver",
            "clench.Solver",
            owned(&messages::SOLVER),
            number(),
            MessageKind::Solver,
        ),
        numbers(
            "/energy",
            "clench.Energy",
            owned(&messages::ENERGY),
            number(),
            MessageKind::Energy,
        ),
    ];
    if model.tendons.iter().any(|tendon| tendon.is_spatial()) {
        all.push(scene("/tendons", MessageKind::Tendons));
    }
    let joints = messages::joint_names(model);
    if !joints.is_empty() {
        let each = object(
            owned(&["position", "velocity"])
                .into_iter()
                .map(|key| (key, number())),
        );
        all.push(numbers(
            "/joints",
            "clench.Joints",
            joints,
            each,
            MessageKind::Joints,
        ));
    }
    let controls = messages::control_names(model);
    if !controls.is_empty() {
        let kind = MessageKind::Controls;
        all.push(numbers(
            "/controls",
            "clench.Controls",
            controls,
            number(),
            kind,
        ));
    }
    let sensors = messages::sensor_names(model);
    if !sensors.is_empty() {
        let (kind, each) = (MessageKind::Sensors, list(number()));
        all.push(numbers("/sensors", "clench.Sensors", sensors, each, kind));
    }
    all
}

fn object(properties: impl IntoIterator<Item = (String, Value)>) -> Value {
    let properties: serde_json::Map<String, Value> = properties.into_iter().collect();
    json!({"type": "object", "properties": properties})
}

fn fields<const N: usize>(properties: [(&str, Value); N]) -> Value {
    object(properties.map(|(key, value)| (key.to_owned(), value)))
}

fn list(item: Value) -> Value {
    json!({"type": "array", "items": item})
}

fn number() -> Value {
    json!({"type": "number"})
}

fn integer() -> Value {
    json!({"type": "integer"})
}

fn text() -> Value {
    json!({"type": "string"})
}

fn flag() -> Value {
    json!({"type": "boolean"})
}

fn time() -> Value {
    fields([("sec", integer()), ("nsec", integer())])
}

fn vector() -> Value {
    fields([("x", number()), ("y", number()), ("z", number())])
}

fn quaternion() -> Value {
    fields([
        ("x", number()),
        ("y", number()),
        ("z", number()),
        ("w", number()),
    ])
}

fn color() -> Value {
    fields([
        ("r", number()),
        ("g", number()),
        ("b", number()),
        ("a", number()),
    ])
}

fn pose() -> Value {
    fields([("position", vector()), ("orientation", quaternion())])
}

fn frame_transforms() -> Value {
    let transform = fields([
        ("timestamp", time()),
        ("parent_frame_id", text()),
        ("child_frame_id", text()),
        ("translation", vector()),
        ("rotation", quaternion()),
    ]);
    fields([("transforms", list(transform))])
}

fn scene_update() -> Value {
    let arrow = fields([
        ("pose", pose()),
        ("shaft_length", number()),
        ("shaft_diameter", number()),
        ("head_length", number()),
        ("head_diameter", number()),
        ("color", color()),
    ]);
    let solid = || fields([("pose", pose()), ("size", vector()), ("color", color())]);
    let cylinder = fields([
        ("pose", pose()),
        ("size", vector()),
        ("bottom_scale", number()),
        ("top_scale", number()),
        ("color", color()),
    ]);
    let line = fields([
        ("type", integer()),
        ("pose", pose()),
        ("thickness", number()),
        ("scale_invariant", flag()),
        ("points", list(vector())),
        ("color", color()),
        ("colors", list(color())),
        ("indices", list(integer())),
    ]);
    let triangles = fields([
        ("pose", pose()),
        ("points", list(vector())),
        ("color", color()),
        ("colors", list(color())),
        ("indices", list(integer())),
    ]);
    let entity = fields([
        ("timestamp", time()),
        ("frame_id", text()),
        ("id", text()),
        ("lifetime", time()),
        ("frame_locked", flag()),
        (
            "metadata",
            list(fields([("key", text()), ("value", text())])),
        ),
        ("arrows", list(arrow)),
        ("cubes", list(solid())),
        ("spheres", list(solid())),
        ("cylinders", list(cylinder)),
        ("lines", list(line)),
        ("triangles", list(triangles)),
        ("texts", list(fields([]))),
        ("models", list(fields([]))),
    ]);
    let deletion = fields([("timestamp", time()), ("type", integer()), ("id", text())]);
    fields([("deletions", list(deletion)), ("entities", list(entity))])
}
