//! What can go wrong with environments on a graphics device, and what to do about it.

use clench_rigid::SimError;
use clench_rigid::options::OptionError;
use std::fmt;

/// Something of a model that the device cannot step yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The element, such as `tendon "hamstring"`, and where it was written.
    pub element: String,
    /// What of it cannot be done.
    pub reason: &'static str,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.element, self.reason)
    }
}

/// Why environments cannot be made, given something, or stepped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No device at all.
    #[error(
        "there is no graphics device that can compute: install its driver, or the software device of Mesa (package mesa-vulkan-drivers on Debian and Ubuntu)"
    )]
    NoDevice,
    /// No device of this name.
    #[error("there is no graphics device \"{asked}\"; there are: {known}")]
    NoSuchDevice {
        /// What was asked for.
        asked: String,
        /// The names of those that there are.
        known: String,
    },
    /// A device that does not do what is needed.
    #[error("the graphics device \"{device}\" cannot be used: {reason}")]
    Unusable {
        /// Its name.
        device: String,
        /// Why.
        reason: String,
    },
    /// A device without double precision, which was asked for.
    #[error(
        "the graphics device \"{device}\" has no double precision: take single precision, or the processor"
    )]
    NoDoublePrecision {
        /// Its name.
        device: String,
    },
    /// The device is gone, or its driver failed.
    #[error(
        "the graphics device \"{device}\" was lost ({reason}): make the batch anew, from states that were read before"
    )]
    Lost {
        /// Its name.
        device: String,
        /// What its driver says.
        reason: String,
    },
    /// More environments than the device holds.
    #[error(
        "the graphics device \"{device}\" has no memory for {count} environments of {bytes} bytes{}",
        at_most(*.most)
    )]
    OutOfMemory {
        /// Its name.
        device: String,
        /// How many were asked for.
        count: usize,
        /// What each takes.
        bytes: u64,
        /// How many its limits allow, if it is they that are exceeded.
        most: Option<usize>,
    },
    /// A model that the device cannot step yet: the first thing of each kind.
    #[error("this model cannot be stepped on a graphics device yet: {}", joined(.0))]
    Unsupported(Vec<Refusal>),
    /// A sensor that the device does not read yet.
    #[error("{device} cannot read {kind} sensor \"{name}\" yet: sensordata cannot be recorded")]
    Unread {
        /// The device's name.
        device: String,
        /// The sensor's kind.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// More dofs than the solver factors a Hessian of.
    #[error(
        "Newton's method on a graphics device is for up to {most} dofs, but the model has {nv}: the solver CG has no such limit"
    )]
    TooManyDofs {
        /// How many there may be.
        most: usize,
        /// How many there are.
        nv: usize,
    },
    /// An option outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Parameters that would make other kernels.
    #[error(
        "these parameters cannot differ between environments on a graphics device: they decide what its kernels are made of"
    )]
    Structure,
    /// What the batch on this side of the bus refuses.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// Numbers of the wrong count.
    #[error("{field} has {found} numbers where {expected} are needed")]
    WrongLength {
        /// Of what.
        field: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A number that is infinite or undefined, or beyond 1e10 where it is a position or velocity.
    #[error("{field}[{index}] of environment {env} is {value}")]
    NotFinite {
        /// Of what.
        field: String,
        /// The environment.
        env: usize,
        /// Where in its row.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// A name that no field has.
    #[error("there is no field \"{name}\" on a graphics device; there are: {known}")]
    Unknown {
        /// The name.
        name: String,
        /// All names.
        known: String,
    },
    /// A field that follows from others.
    #[error("{field} follows from the state: it can be read only")]
    ReadOnly {
        /// Which.
        field: String,
    },
    /// An environment that is not there.
    #[error("there is no environment {env}: there are {count}")]
    NoSuchEnvironment {
        /// The number asked for.
        env: usize,
        /// How many there are.
        count: usize,
    },
}

impl From<GpuError> for SimError {
    fn from(error: GpuError) -> Self {
        SimError::Backend(error.to_string())
    }
}

fn at_most(most: Option<usize>) -> String {
    most.map_or_else(
        || ": make fewer, or several batches one after the other".to_owned(),
        |most| format!(": at most {most} fit its largest buffer; make several batches"),
    )
}

fn joined(refusals: &[Refusal]) -> String {
    let lines: Vec<_> = refusals.iter().map(Refusal::to_string).collect();
    lines.join("; ")
}

/// Why an environment stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
pub enum GpuFault {
    /// The mass matrix is not positive definite.
    #[error("the mass matrix is not positive definite")]
    Singular,
    /// A number is not finite, or a position, velocity or acceleration is beyond 1e10.
    #[error("the simulation diverged")]
    Diverged,
    /// More contacts than the pool holds.
    #[error("there are more contacts than the {limit} of the pool (option max_contacts)")]
    ContactOverflow {
        /// How many there may be.
        limit: usize,
    },
    /// The device ended a loop before its end.
    #[error("the device ended a loop before its end (Mesa's software device grants 65,535 turns)")]
    Unfinished,
}
