//! What can go wrong with a simulation.

use crate::budget::RAISE;
use crate::contact::UnsupportedPair;
use crate::dynamics::discrete_limits::NotDiscrete;
use crate::options::OptionError;
use clench_math::Instructions;
use std::sync::Arc;

/// Why a simulation cannot start, take an input, or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// An option outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Shapes that may meet and cannot be collided.
    #[error(transparent)]
    UnsupportedPair(#[from] UnsupportedPair),
    /// Something that the integrator `discrete` cannot be combined with.
    #[error(transparent)]
    NotDiscrete(#[from] NotDiscrete),
    /// An input of the wrong length.
    #[error("{field} has {found} numbers where the model needs {expected}")]
    WrongLength {
        /// Which part of the state.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length that the model needs.
        expected: usize,
    },
    /// An input out of its range.
    #[error("{field} is {value}, but must be {range}")]
    OutOfRange {
        /// What was set.
        field: &'static str,
        /// To what.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A parameter that cannot be.
    #[error("{field}[{index}] is {value}, but must be {range}")]
    Parameter {
        /// Which field of the parameters.
        field: &'static str,
        /// Where in it.
        index: usize,
        /// To what it was set.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A parameter that cannot be set because it follows from another.
    #[error("{field} follows from {other}: set that")]
    Follows {
        /// What was set.
        field: &'static str,
        /// What to set instead.
        other: &'static str,
    },
    /// Parameters with which the mass matrix is not positive definite in the initial configuration.
    #[error("at qpos0 the mass matrix is not positive definite{}{place}", env.map(|env| format!(" in environment {env}")).unwrap_or_default())]
    SingularMass {
        /// The environment, in a batch.
        env: Option<usize>,
        /// The joint where that shows, if it is known.
        place: String,
    },
    /// A name that nothing has.
    #[error("there is no {kind} \"{name}\"{hint}")]
    Unknown {
        /// Kind of thing.
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// The nearest name, or all that there are.
        hint: String,
    },
    /// An element that the model does not have.
    #[error("there is no {kind} {index}: there are {count}")]
    NoSuchElement {
        /// Kind of element.
        kind: &'static str,
        /// The number asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Instructions that the processor lacks, or that this precision was not compiled for.
    #[error(
        "this build has no kernels in this precision for {0:?} instructions on this processor; \
         CLENCH_INSTRUCTIONS=all in the environment of the build compiles all kernels"
    )]
    Instructions(Instructions),
    /// More memory than there is.
    #[error("there is no memory for {count} rows of {bytes} bytes")]
    OutOfMemory {
        /// How many rows.
        count: usize,
        /// How many bytes in each.
        bytes: usize,
    },
    /// Threads that cannot be started.
    #[error("threads cannot be started: {0}")]
    Threads(String),
    /// What a device that steps a batch cannot do, or that it failed.
    #[error("{0}")]
    Backend(String),
    /// A batch or simulation of several threads in a process that was forked from the one that started them: a fork does not copy threads.
    #[error(
        "the threads are of the process that they were started in, which forked: make a batch, or set the threads of a simulation, in \
         each process"
    )]
    Forked,
    /// A constraint at run time that there is no slot for.
    #[error(
        "all {most} slots for constraints at run time are taken: remove one, or give the model a larger max_dynamic_constraints"
    )]
    NoFreeSlot {
        /// How many there are.
        most: usize,
    },
    /// The handle of a constraint that was removed, or that this state does not have.
    #[error(
        "this constraint is not there: it was removed, or the state is one that does not have it"
    )]
    StaleConstraint,
    /// Bodies or an equality that cannot be held so.
    #[error("{what} cannot be held so: {reason}")]
    CannotHold {
        /// What was to be held.
        what: String,
        /// Why it cannot.
        reason: &'static str,
    },
    /// Heights of a geom that is no height field.
    #[error("geom {geom} is no height field")]
    NoHeightField {
        /// The geom.
        geom: usize,
    },
    /// Discrete inverse dynamics of a model whose steps have no acceleration of their own.
    #[error(
        "the integrator RK4 has no discrete acceleration: it mixes those of four states (choose Euler, implicit or implicitfast)"
    )]
    NoDiscreteInverse,
    /// A given contact that makes no sense.
    #[error("given contact {index}: {reason}")]
    Contact {
        /// Which contact.
        index: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A state that cannot be stepped from, or a step that led nowhere.
    #[error(transparent)]
    Fault(#[from] Fault),
}

impl SimError {
    /// Nothing of this kind is called `name`; `names` are those that there are.
    pub fn unknown<'a>(
        kind: &'static str,
        name: &str,
        names: impl Iterator<Item = &'a str> + Clone,
    ) -> Self {
        let distance = |known: &str| strsim::damerau_levenshtein(known, name);
        let nearest = names.clone().min_by_key(|known| distance(known));
        let hint = match nearest.filter(|known| distance(known) <= known.len().max(name.len()) / 3)
        {
            Some(known) => format!("; did you mean \"{known}\"?"),
            None => format!(": there are {}", Vec::from_iter(names).join(", ")),
        };
        SimError::Unknown {
            kind,
            name: name.to_owned(),
            hint,
        }
    }
}

/// Why an environment cannot go on. Fields of the state are named, and their numbers counted, as in the rows of a
/// batch: `xfrc_applied` has six a body, the force first.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// An input that is infinite or not a number.
    #[error("{field}[{index}] is {value}")]
    NotFinite {
        /// Which part of the state.
        field: &'static str,
        /// Where in it.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// The mass matrix of the configuration is not positive definite.
    #[error(
        "at t = {time} s the mass matrix is not positive definite{}: some dof moves no mass, or the state has diverged",
        at(place)
    )]
    Singular {
        /// Time of the state that cannot move on, s.
        time: f64,
        /// The joint that moves no mass, with its body and where it was written.
        place: Option<Arc<str>>,
    },
    /// The motion left all bounds: a number is not finite, or a position, velocity or acceleration is beyond 1e10 (MuJoCo's
    /// `mjMAXVAL`).
    #[error(
        "the simulation diverged in the step from t = {time} s: {field}[{index}] became {value}{}",
        at(place)
    )]
    Diverged {
        /// Time of the last good state, s.
        time: f64,
        /// Which quantity.
        field: &'static str,
        /// Where in it.
        index: usize,
        /// What it became.
        value: f64,
        /// The joint that it is of, with its body and where it was written.
        place: Option<Arc<str>>,
    },
    /// More contacts than the options allow. A `Sim` leaves the rest out and says so; an environment of a
    /// batch stops.
    #[error(
        "in the step from t = {time} s there are more contacts than the {limit} that the options allow"
    )]
    ContactOverflow {
        /// Time of the last good state, s.
        time: f64,
        /// How many may be.
        limit: usize,
    },
    /// More of something than the model's [`Budget`](crate::Budget) allows.
    #[error("in the step from t = {time} s there are more than {limit} {what}; {RAISE}")]
    OverBudget {
        /// Time of the last good state, s.
        time: f64,
        /// Of what.
        what: &'static str,
        /// How many may be.
        limit: u64,
    },
    /// A device ended a step before its end, as Mesa's software device does after 65,535 turns of loops.
    #[error(
        "in the step from t = {time} s the device ended a loop before its end (Mesa's software device grants 65,535 turns): a card or the \
         processor can do it"
    )]
    Unfinished {
        /// Time of the last good state, s.
        time: f64,
    },
}

fn at(place: &Option<Arc<str>>) -> String {
    place
        .as_ref()
        .map_or_else(String::new, |place| format!(" at {place}"))
}

/// The error of an element that the model does not have.
pub fn no_such(kind: &'static str, index: usize, count: usize) -> SimError {
    SimError::NoSuchElement { kind, index, count }
}
