//! How much a model file may ask for.

/// Bounds on the memory and work that a model file, and each step of its model, may ask for. A few letters of a file can ask for
/// gigabytes, so a file from elsewhere must not decide alone; a model that is meant to be large is given a larger budget.
///
/// Exceeding a bound is an error that names it: a `LoadError` or `BuildError` while a model is
/// read and built, a [`Fault`](crate::Fault) of the environment while it moves.
///
/// ```
/// use clench_dynamics::Budget;
/// let budget = Budget::default().times(4.0);
/// assert_eq!(budget.elements, 4 * Budget::default().elements);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Memory for reading the files of a model and building it, bytes, as estimated before it is taken; 2 GiB.
    pub bytes: u64,
    /// Elements in the files of a model, those in replicas counted once for each; 500 000.
    pub elements: u64,
    /// Contacts of an environment in a step; 250 000. Pairs of geoms whose bounds meet may be four times as many. How many contacts
    /// one wants is another matter, and the option `max_contacts`.
    pub contacts: u64,
    /// Numbers in one matrix of a step: the mass matrix, the moment arms of actuators, the Jacobian of all contacts, the factor of
    /// an island's Hessian; 2²⁵, which take 256 MiB.
    pub matrix: u64,
    /// Steps of simulation that building a model may take, to find the length ranges of muscles that do not give them; 2 000 000.
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
    /// No bounds: for files that are known.
    pub const UNLIMITED: Budget = Budget {
        bytes: u64::MAX,
        elements: u64::MAX,
        contacts: u64::MAX,
        matrix: u64::MAX,
        steps: u64::MAX,
    };

    /// Pairs of geoms whose bounds meet in a step.
    pub fn pairs(&self) -> u64 {
        self.contacts.saturating_mul(4)
    }

    /// Every bound times a factor; a factor that is not positive leaves nothing.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        // Conversions from floating point stop at the ends of the range.
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

/// How to go on where more is meant; the end of each message.
pub const RAISE: &str =
    "if that is meant, load the model with a larger budget (`Budget`, `budget=` or `--budget`)";
