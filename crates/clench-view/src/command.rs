//! What a user does in the page.

use clench::Model;
use clench::prelude::FrictionCone;
use serde::Deserialize;
use serde_json::{Map, Value};

/// An action of a user in the page. [`read`](Self::read) takes it from a JSON object whose `do` is its name.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Stand still, or go on.
    Pause {
        /// Whether to stand still.
        on: bool,
    },
    /// Take steps, and stand still.
    Step {
        /// How many, at most [`MAX_STEPS`].
        count: u32,
    },
    /// Back to the initial state.
    Reset {},
    /// To a keyframe.
    Keyframe {
        /// Which.
        index: usize,
    },
    /// Simulated over real time.
    Speed {
        /// From [`SPEEDS`]; 0 for as fast as can be.
        factor: f64,
    },
    /// Set a control.
    Control {
        /// Which.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Set a position coordinate of a slide or hinge, at rest.
    Position {
        /// Which coordinate.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Switch an equality constraint.
    Equality {
        /// Which.
        index: usize,
        /// Whether it is on.
        on: bool,
    },
    /// Draw a body somewhere by a spring.
    Drag {
        /// Which body.
        body: usize,
        /// The point that is drawn, in the body's frame, m.
        point: [f64; 3],
        /// Where to, m.
        target: [f64; 3],
    },
    /// Turn a body by a spring.
    Turn {
        /// Which body.
        body: usize,
        /// The orientation that it is turned to, a quaternion with w first.
        target: [f64; 4],
    },
    /// Let the body go.
    Release {},
    /// Set an option of the solver.
    Options {
        /// Whether friction cones are elliptic.
        elliptic: Option<bool>,
        /// Most iterations.
        iterations: Option<usize>,
        /// Tolerance.
        tolerance: Option<f64>,
        /// Most sweeps of noslip.
        noslip_iterations: Option<usize>,
    },
    /// Choose environments of a batch.
    Show {
        /// The one whose numbers are shown, and that is touched.
        env: usize,
        /// The first of those side by side.
        first: usize,
        /// How many are side by side, at most [`MAX_SIDE_BY_SIDE`]; 1 for `env` alone.
        count: usize,
    },
    /// Back to a moment of the last ten seconds.
    Rewind {
        /// How long ago, s of simulated time.
        seconds: f64,
    },
    /// To a moment of the last ten seconds, from which one can come forward again as long as no step is taken.
    Moment {
        /// Its time, s of simulated time.
        time: f64,
    },
}

/// The most steps of one command.
pub const MAX_STEPS: u32 = 1000;
/// The most environments that are seen at once.
pub const MAX_SIDE_BY_SIDE: usize = 64;
/// The least and the most that a speed can be.
pub const SPEEDS: [f64; 2] = [0.01, 100.0];
/// The most iterations that an option can be.
const MAX_ITERATIONS: usize = 10_000;
/// Nothing is drawn farther than this, m.
const FAR: f64 = 1e6;

impl Command {
    /// The command of this name with these fields; none where either is unknown, or a field is missing or of another type.
    ///
    /// The caller takes the name out of the object: `serde(tag)` would do it with three times the code.
    pub fn read(name: String, fields: Map<String, Value>) -> Option<Self> {
        let tagged = Map::from_iter([(name, Value::Object(fields))]);
        Command::deserialize(Value::Object(tagged)).ok()
    }

    /// Refuses what a model, or so many environments of it, does not have and numbers that make no sense.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check(&self, model: &Model, envs: usize) -> Result<(), String> {
        let below = |kind: &str, index: usize, count: usize| match index < count {
            true => Ok(()),
            false => Err(format!("there is no {kind} {index}, only {count}")),
        };
        let within =
            |name: &str, value: f64, [low, high]: [f64; 2]| match (low..=high).contains(&value) {
                true => Ok(()),
                false => Err(format!("{name} is {value}, not between {low} and {high}")),
            };
        match *self {
            Command::Step { count } => within("count", count.into(), [1.0, MAX_STEPS.into()]),
            Command::Keyframe { index } => below("keyframe", index, model.keyframes.len()),
            Command::Speed { factor: 0.0 } => Ok(()),
            Command::Speed { factor } => within("factor", factor, SPEEDS),
            Command::Control { index, value } => {
                below("control", index, model.nu())?;
                within("value", value, [-1e10, 1e10])
            }
            Command::Position { index, value } => {
                let joint = model.joints.iter().find(|joint| joint.qpos == index);
                if joint.is_none_or(|joint| joint.kind.nq() != 1) {
                    return Err(format!("no slide or hinge has the coordinate {index}"));
                }
                within("value", value, [-1e10, 1e10])
            }
            Command::Equality { index, .. } => below("equality", index, model.equalities.len()),
            Command::Drag {
                body,
                point,
                target,
            } => {
                below("body", body, model.nbody())?;
                (point.iter().chain(&target))
                    .try_for_each(|&x| within("a coordinate", x, [-FAR, FAR]))
            }
            Command::Turn { body, target } => {
                below("body", body, model.nbody())?;
                let length = target.iter().map(|x| x * x).sum::<f64>().sqrt();
                within("the length of a quaternion", length, [0.99, 1.01])
            }
            Command::Options {
                iterations,
                tolerance,
                noslip_iterations,
                ..
            } => {
                for count in [iterations, noslip_iterations].into_iter().flatten() {
                    below("number of iterations", count, MAX_ITERATIONS + 1)?;
                }
                within("tolerance", tolerance.unwrap_or(0.0), [0.0, 1.0])
            }
            Command::Show { env, first, count } => {
                below("environment", env, envs)?;
                below("environment", first, envs)?;
                within("count", count as f64, [1.0, MAX_SIDE_BY_SIDE as f64])
            }
            Command::Rewind { seconds } => within("seconds", seconds, [0.0, FAR]),
            Command::Moment { time } => within("time", time, [-1e10, 1e10]),
            Command::Pause { .. } | Command::Reset {} | Command::Release {} => Ok(()),
        }
    }
}

/// The cone of a switch.
pub(crate) fn cone(elliptic: bool) -> FrictionCone {
    match elliptic {
        true => FrictionCone::Elliptic,
        false => FrictionCone::Pyramidal,
    }
}
