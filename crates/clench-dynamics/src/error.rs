//! The errors of a simulation.

use crate::options::OptionError;
use clench_math::Instructions;
use std::sync::Arc;

/// An option or element that the integrator `discrete` cannot be combined with.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the integrator discrete cannot be combined with {with}: {reason}")]
pub struct NotDiscrete {
    /// The option or element.
    pub with: String,
    /// The reason.
    pub reason: &'static str,
}

/// Two geoms that may collide but whose shapes are not supported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{location}geoms {first} and {second} may collide, but {kinds} is not supported")]
pub struct UnsupportedPair {
    pub(crate) location: String,
    pub(crate) first: String,
    pub(crate) second: String,
    pub(crate) kinds: String,
}

/// The reason that a simulation cannot start, accept an input, or continue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// An option is outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Two shapes may collide, but their pair is not supported.
    #[error(transparent)]
    UnsupportedPair(#[from] UnsupportedPair),
    /// The integrator `discrete` is incompatible with a feature of the model.
    #[error(transparent)]
    NotDiscrete(#[from] NotDiscrete),
    /// An input has the wrong length.
    #[error("{field} has {found} numbers where the model needs {expected}")]
    WrongLength {
        /// The name of the input.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length that the model needs.
        expected: usize,
    },
    /// An input is out of its range.
    #[error("{field} is {value}, but must be {range}")]
    OutOfRange {
        /// The name of the input.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// A number of a parameter or an argument is out of its range.
    #[error("{field}[{index}] is {value}, but must be {range}")]
    Parameter {
        /// The field of the parameters.
        field: &'static str,
        /// The index in the field.
        index: usize,
        /// Its value.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// A parameter cannot be set because it follows from another.
    #[error("{field} is computed from {other}: set {other} instead")]
    Follows {
        /// The parameter that was set.
        field: &'static str,
        /// The parameter to set instead.
        other: &'static str,
    },
    /// The mass matrix is not positive definite in the initial configuration with these parameters.
    #[error("at qpos0 the mass matrix is not positive definite{}{place}", env.map(|env| format!(" in environment {env}")).unwrap_or_default())]
    SingularMass {
        /// The environment, in a batch.
        env: Option<usize>,
        /// The joint with the bad pivot, if it is known.
        place: String,
    },
    /// No element has the requested name.
    #[error("there is no {kind} \"{name}\"{hint}")]
    Unknown {
        /// The kind of element.
        kind: &'static str,
        /// The requested name.
        name: String,
        /// The nearest name, or all existing ones.
        hint: String,
    },
    /// An index is beyond the elements of the model.
    #[error("there is no {kind} {index}: there are {count}")]
    NoSuchElement {
        /// The kind of element.
        kind: &'static str,
        /// The requested index.
        index: usize,
        /// The number of elements.
        count: usize,
    },
    /// A batch has no model.
    #[error("a batch needs a model")]
    NoModel,
    /// A feature needs a batch of one model.
    #[error("{0} needs a batch of one model")]
    OneModel(&'static str),
    /// Models of one batch differ in more than geoms and numbers.
    #[error(
        "models 0 (\"{first}\") and {number} (\"{other}\") of a batch may differ in geoms and numbers alone, but differ in {difference}"
    )]
    ModelsDiffer {
        /// The name of the first model.
        first: String,
        /// The number of the other model.
        number: usize,
        /// The name of the other model.
        other: String,
        /// The difference.
        difference: String,
    },
    /// The processor lacks the instructions, or this precision was not compiled for them.
    #[error(
        "this build has no kernels in this precision for {0:?} instructions on this processor; \
         CLENCH_INSTRUCTIONS=all in the environment of the build compiles all kernels of steps; for derivatives, build \
         on this machine"
    )]
    Instructions(Instructions),
    /// There is not enough memory.
    #[error("there is no memory for {count} rows of {bytes} bytes")]
    OutOfMemory {
        /// The number of rows.
        count: usize,
        /// The bytes of each row.
        bytes: usize,
    },
    /// Threads cannot be started.
    #[error("threads cannot be started: {0}")]
    Threads(String),
    /// A device that steps a batch does not support an operation, or failed.
    #[error("{0}")]
    Backend(String),
    /// A multi-threaded batch or simulation is used in a forked process: a fork does not copy threads.
    #[error(
        "the threads belong to the process that started them, which forked: create a batch, or set the threads of a simulation, in \
         each process"
    )]
    Forked,
    /// All slots for constraints at run time are taken.
    #[error(
        "all {max} slots for constraints at run time are in use: remove one, or give the model a larger max_dynamic_constraints"
    )]
    NoFreeSlot {
        /// The number of slots.
        max: usize,
    },
    /// The handle is of a constraint that was removed, or that this state does not have.
    #[error("this constraint does not exist: it was removed, or this state does not contain it")]
    StaleConstraint,
    /// Bodies or an equality cannot be constrained as requested.
    #[error("{what} cannot be constrained: {reason}")]
    CannotHold {
        /// The object to be constrained.
        what: String,
        /// The reason.
        reason: &'static str,
    },
    /// The geom is not a height field.
    #[error("geom {geom} is not a height field")]
    NoHeightField {
        /// The geom.
        geom: usize,
    },
    /// An option cannot change once a simulation exists.
    #[error("the option {0} can only be chosen when a simulation is created")]
    FixedOption(&'static str),
    /// Discrete inverse dynamics are undefined for an integrator whose steps have no single acceleration.
    #[error(
        "the integrator RK4 has no discrete acceleration: it combines those of four states (choose Euler, implicit or implicitfast)"
    )]
    NoDiscreteInverse,
    /// A contact that the user provided is invalid.
    #[error("provided contact {index}: {reason}")]
    Contact {
        /// The index of the contact.
        index: usize,
        /// The reason.
        reason: &'static str,
    },
    /// A state cannot be stepped from, or a step failed.
    #[error(transparent)]
    Fault(#[from] Fault),
}

impl SimError {
    /// Returns the error for an unknown `name` of a kind; `names` are the existing ones.
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

/// The reason that an environment cannot continue. Fields of the state are named, and their numbers indexed, as in the
/// rows of a batch: `xfrc_applied` has six per body, the force first.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// An input is infinite or not a number.
    #[error("{field}[{index}] is {value}")]
    NotFinite {
        /// The field of the state.
        field: &'static str,
        /// The index in the field.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The mass matrix of the configuration is not positive definite.
    #[error(
        "at t = {time} s the mass matrix is not positive definite{}: a dof moves no mass, or the state has diverged",
        at(place)
    )]
    Singular {
        /// Time of the state that cannot advance, s.
        time: f64,
        /// The joint that moves no mass, with its body and source location.
        place: Option<Arc<str>>,
    },
    /// The motion diverged: a number is not finite, or a position, velocity or acceleration is beyond 1e10 (MuJoCo's
    /// `mjMAXVAL`).
    #[error(
        "the simulation diverged in the step from t = {time} s: {field}[{index}] became {value:e}{}; a shorter timestep or weaker \
         forces and springs may prevent it",
        at(place)
    )]
    Diverged {
        /// Time of the last good state, s.
        time: f64,
        /// The quantity.
        field: &'static str,
        /// The index in it.
        index: usize,
        /// Its value.
        value: f64,
        /// The joint that it belongs to, with its body and source location.
        place: Option<Arc<str>>,
    },
    /// There are more contacts than the options allow. A `Sim` omits the excess and reports it; an environment of a
    /// batch stops.
    #[error(
        "in the step from t = {time} s there are more contacts than the {limit} that the options allow"
    )]
    ContactOverflow {
        /// Time of the last good state, s.
        time: f64,
        /// The maximum number of contacts.
        limit: usize,
    },
    /// A quantity exceeds the model's [`Budget`](crate::Budget), or the pairs that stick exceed their slots.
    #[error("in the step from t = {time} s there are more than {limit} {what}; {remedy}")]
    OverBudget {
        /// Time of the last good state, s.
        time: f64,
        /// The quantity.
        what: &'static str,
        /// Its maximum.
        limit: u64,
        /// The way to raise it.
        remedy: &'static str,
    },
    /// A device terminated a step early, as Mesa's software device does after 65,535 iterations of loops.
    #[error(
        "in the step from t = {time} s the device terminated a loop early (Mesa's software device stops after 65,535 iterations): \
         use a GPU or the processor"
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

/// Returns the error for an index beyond the elements of the model.
pub fn no_such(kind: &'static str, index: usize, count: usize) -> SimError {
    SimError::NoSuchElement { kind, index, count }
}

/// Checks that an input has the length that the model needs.
///
/// # Errors
/// Returns an error if the length is not `expected`.
pub fn check_length(field: &'static str, found: usize, expected: usize) -> Result<(), SimError> {
    if found == expected {
        return Ok(());
    }
    Err(SimError::WrongLength {
        field,
        found,
        expected,
    })
}

/// Checks that the length is a multiple of `each`.
pub fn check_count(field: &'static str, found: usize, each: usize) -> Result<(), SimError> {
    check_length(field, found, found.next_multiple_of(each))
}
