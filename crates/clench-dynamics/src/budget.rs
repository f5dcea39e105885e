//! Limits on the resources of a model file.

/// Limits on the memory and work of a model file, and of each step of its model. A few letters of a file can request
/// gigabytes, so an untrusted file is limited. Load a model that is meant to be large with a larger budget.
///
/// Exceeding a limit is an error that names it: a `LoadError` or `BuildError` while a model is read and built, a
/// [`Fault`](crate::Fault) of the environment while it moves.
///
/// ```
/// use clench_dynamics::Budget;
/// let budget = Budget::default().times(4.0);
/// assert_eq!(budget.elements, 4 * Budget::default().elements);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Memory for reading the files of a model and building it, bytes, as estimated before allocation; 2 GiB.
    pub bytes: u64,
    /// Elements in the files of a model, with every replica counted; 500 000.
    pub elements: u64,
    /// Contacts of an environment in a step; 250 000. Pairs of geoms whose bounds overlap may be four times as many.
    /// The option `max_contacts` limits contacts separately.
    pub contacts: u64,
    /// Elements of one matrix of a step: the mass matrix, the moment arms of actuators, the Jacobian of all contacts,
    /// the factor of an island's Hessian; 2²⁵, which take 256 MiB.
    pub matrix: u64,
    /// Simulation steps for building a model, to find the length ranges of muscles that do not specify them; 2 000 000.
    pub steps: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Budget {
            bytes: 2 << 30,
            elements: 500_000,
            contacts: 250_000,
            matrix: 1 << 25,
            steps: 2_000_000,
        }
    }
}

impl Budget {
    /// No limits: for trusted files.
    pub const UNLIMITED: Budget = Budget {
        bytes: u64::MAX,
        elements: u64::MAX,
        contacts: u64::MAX,
        matrix: u64::MAX,
        steps: u64::MAX,
    };

    /// Returns the limit of pairs of geoms whose bounds overlap in a step.
    pub fn pairs(&self) -> u64 {
        self.contacts.saturating_mul(4)
    }

    /// Multiplies every limit by a factor. A factor that is not positive gives zero limits.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        // Conversions from floating point saturate.
        let scaled = |bound: u64| (bound as f64 * factor) as u64;
        Budget {
            bytes: scaled(self.bytes),
            elements: scaled(self.elements),
            contacts: scaled(self.contacts),
            matrix: scaled(self.matrix),
            steps: scaled(self.steps),
        }
    }
}

/// The end of each message: how to raise the limit.
pub const RAISE: &str =
    "if this is intended, load the model with a larger budget (`Budget`, `budget=` or `--budget`)";
