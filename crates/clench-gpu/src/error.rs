//! Errors and faults of environments on a graphics device, with remedies.

use clench_rigid::SimError;
use std::fmt;

/// A feature of a model that the device does not support yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The element, such as `tendon "hamstring"`, and its source location.
    pub element: String,
    /// The unsupported feature.
    pub reason: &'static str,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.element, self.reason)
    }
}

/// An error in creating, setting or stepping environments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// There is no device.
    #[error(
        "there is no graphics device that can compute: install its driver, or the software device of Mesa (package mesa-vulkan-drivers on Debian and Ubuntu)"
    )]
    NoDevice,
    /// No device has this name.
    #[error("there is no graphics device \"{requested}\"; there are: {available}")]
    NoSuchDevice {
        /// The requested name.
        requested: String,
        /// The names of the available devices.
        available: String,
    },
    /// The device lacks a required feature.
    #[error("the graphics device \"{device}\" cannot be used: {reason}")]
    Unusable {
        /// The device's name.
        device: String,
        /// The reason.
        reason: String,
    },
    /// Double precision was requested, but the device does not support it.
    #[error(
        "the graphics device \"{device}\" has no double precision: use single precision, or the processor"
    )]
    NoDoublePrecision {
        /// The device's name.
        device: String,
    },
    /// The device was lost, or its driver failed.
    #[error(
        "the graphics device \"{device}\" was lost ({reason}): create the batch again, from states that were read before"
    )]
    Lost {
        /// The device's name.
        device: String,
        /// The driver's message.
        reason: String,
    },
    /// The environments do not fit the device's memory.
    #[error(
        "the graphics device \"{device}\" has no memory for {count} environments of {bytes} bytes{}",
        capacity_hint(*.max)
    )]
    OutOfMemory {
        /// The device's name.
        device: String,
        /// The requested number.
        count: usize,
        /// The bytes of each.
        bytes: u64,
        /// The number that its limits allow, if those are exceeded.
        max: Option<usize>,
    },
    /// The device does not support the model yet: the first element of each kind.
    #[error("this model cannot be stepped on a graphics device yet: {}", joined(.0))]
    Unsupported(Vec<Refusal>),
    /// More dofs than the solver can factor a Hessian for.
    #[error(
        "Newton's method on a graphics device is for up to {max} dofs, but the model has {nv}: the solver CG has no such limit"
    )]
    TooManyDofs {
        /// The maximum.
        max: usize,
        /// The number of dofs.
        nv: usize,
    },
    /// The model has too many slots for constraints that are added at run time.
    #[error(
        "a graphics device has up to {max} slots for constraints at run time, but the model has {slots}: give it a smaller max_dynamic_constraints"
    )]
    TooManySlots {
        /// The maximum.
        max: usize,
        /// The number of slots.
        slots: usize,
    },
    /// The parameters would need different kernels.
    #[error(
        "these parameters cannot differ between environments on a graphics device: its kernels are compiled for them"
    )]
    Structure,
    /// The processor refuses the model, an option or a request.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The number of values is wrong.
    #[error("{field} has {found} numbers where {expected} are needed")]
    WrongLength {
        /// The field.
        field: String,
        /// The number found.
        found: usize,
        /// The expected number.
        expected: usize,
    },
    /// A number is infinite or NaN, or a position or velocity beyond 1e10.
    #[error("{field}[{index}] of environment {env} is {value}")]
    NotFinite {
        /// The field.
        field: String,
        /// The environment.
        env: usize,
        /// The index in its row.
        index: usize,
        /// The value.
        value: f64,
    },
    /// No field has this name.
    #[error("there is no field \"{name}\" on a graphics device; there are: {names}")]
    Unknown {
        /// The name.
        name: String,
        /// All names.
        names: String,
    },
    /// The field is derived from others.
    #[error("{field} is computed from the state: it is read-only")]
    ReadOnly {
        /// The field.
        field: String,
    },
    /// The environment does not exist.
    #[error("there is no environment {env}: there are {count}")]
    NoSuchEnvironment {
        /// The requested index.
        env: usize,
        /// The number of environments.
        count: usize,
    },
}

impl From<GpuError> for SimError {
    fn from(error: GpuError) -> Self {
        SimError::Backend(error.to_string())
    }
}

fn capacity_hint(max: Option<usize>) -> String {
    max.map_or_else(
        || ": create fewer, or several batches one after the other".to_owned(),
        |max| format!(": at most {max} fit its largest buffer; create several batches"),
    )
}

fn joined(refusals: &[Refusal]) -> String {
    let lines: Vec<_> = refusals.iter().map(Refusal::to_string).collect();
    lines.join("; ")
}

/// The reason why an environment has stopped.
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
        /// The maximum.
        limit: usize,
    },
    /// More pairs of geoms stick than a state has slots for.
    #[error("more than {limit} pairs of geoms stick (option max_stick_pairs)")]
    StickOverflow {
        /// The maximum.
        limit: usize,
    },
    /// The device terminated a loop early.
    #[error(
        "the device terminated a loop early (Mesa's software device stops after 65,535 iterations)"
    )]
    Unfinished,
}
