//! The commands that a user gives in the page.

use clench::Model;
use clench::prelude::FrictionCone;
use serde::Deserialize;
use serde_json::{Map, Value};

/// An action of a user in the page. [`read`](Self::read) parses it from a JSON object whose `do` is its name.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Pauses or resumes the simulation.
    Pause {
        /// True to pause.
        on: bool,
    },
    /// Takes steps, then pauses.
    Step {
        /// The number of steps, at most [`MAX_STEPS`].
        count: u32,
    },
    /// Resets to the initial state.
    Reset {},
    /// Resets to a keyframe.
    Keyframe {
        /// The index of the keyframe.
        index: usize,
    },
    /// Sets the ratio of simulated to real time.
    Speed {
        /// The ratio, within [`SPEEDS`]; 0 for as fast as possible.
        factor: f64,
    },
    /// Sets a control.
    Control {
        /// The index of the control.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Sets a position coordinate of a slide or hinge joint, with zero velocity.
    Position {
        /// The index of the coordinate in `qpos`.
        index: usize,
        /// The value.
        value: f64,
    },
    /// Enables or disables an equality constraint.
    Equality {
        /// The index of the constraint.
        index: usize,
        /// True to enable it.
        on: bool,
    },
    /// Pulls a body to a target by a spring.
    Drag {
        /// The index of the body.
        body: usize,
        /// The attachment point in the body frame, m.
        point: [f64; 3],
        /// The target, m.
        target: [f64; 3],
    },
    /// Rotates a body to a target orientation by a torsional spring.
    Turn {
        /// The index of the body.
        body: usize,
        /// The target orientation, a quaternion with w first.
        target: [f64; 4],
    },
    /// Releases the body.
    Release {},
    /// Sets options of the solver.
    Options {
        /// True for elliptic friction cones.
        elliptic: Option<bool>,
        /// The maximum number of iterations.
        iterations: Option<usize>,
        /// The tolerance.
        tolerance: Option<f64>,
        /// The maximum number of noslip iterations.
        noslip_iterations: Option<usize>,
    },
    /// Selects environments of a batch.
    Show {
        /// The environment that is plotted and interacted with.
        env: usize,
        /// The first environment of those side by side.
        first: usize,
        /// The number of environments side by side, at most [`MAX_SIDE_BY_SIDE`]; 1 for `env` only.
        count: usize,
    },
    /// Rewinds within the last ten seconds.
    Rewind {
        /// The time to go back, s of simulated time.
        seconds: f64,
    },
    /// Goes to a moment of the last ten seconds; later moments stay available until the next step.
    Moment {
        /// The time, s of simulated time.
        time: f64,
    },
}

/// The maximum number of steps of one command.
pub const MAX_STEPS: u32 = 1000;
/// The maximum number of environments that are shown at once.
pub const MAX_SIDE_BY_SIDE: usize = 64;
/// The range of the speed factor.
pub const SPEEDS: [f64; 2] = [0.01, 100.0];
/// The maximum number of iterations that an option accepts.
const MAX_ITERATIONS: usize = 10_000;
/// The limit on coordinates, m, and on rewind times, s.
const FAR: f64 = 1e6;

impl Command {
    /// Parses the command of this name with these fields. Returns `None` if the name or a field is unknown, or a field
    /// is missing or of another type.
    ///
    /// The caller removes the name from the object: `serde(tag)` would take three times the code.
    pub fn read(name: String, fields: Map<String, Value>) -> Option<Self> {
        let tagged = Map::from_iter([(name, Value::Object(fields))]);
        Command::deserialize(Value::Object(tagged)).ok()
    }

    /// Validates indices against a model with `envs` environments, and the ranges of numbers.
    ///
    /// # Errors
    /// Returns a message if a value is out of range.
    pub fn check(&self, model: &Model, envs: usize) -> Result<(), String> {
        let below = |kind: &str, index: usize, count: usize| match index < count {
            true => Ok(()),
            false => Err(format!("there is no {kind} {index}, only {count}")),
        };
        let within =
            |name: &str, value: f64, [low, high]: [f64; 2]| match (low..=high).contains(&value) {
                true => Ok(()),
                false if value.abs() < 1e10 => {
                    Err(format!("{name} is {value}, not between {low} and {high}"))
                }
                false => Err(format!("{name} is {value:e}, not between {low} and {high}")),
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

/// Returns the friction cone that the switch selects.
pub(crate) fn cone(elliptic: bool) -> FrictionCone {
    match elliptic {
        true => FrictionCone::Elliptic,
        false => FrictionCone::Pyramidal,
    }
}
