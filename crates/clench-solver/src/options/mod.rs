//! The solver options that a user can set, and the resolved settings that a solve reads.

mod table;

use clench_math::Real;

/// The minimisation algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConstraintSolver {
    /// Newton's method with a factored Hessian.
    #[default]
    Newton,
    /// Conjugate gradients, preconditioned by the mass matrix; needs only matrix-vector products.
    Cg,
}

/// A setting that is chosen per model unless the user sets it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switch {
    /// Chosen per model.
    #[default]
    Auto,
    /// Always on.
    On,
    /// Always off.
    Off,
}

macro_rules! declare_options {
    (solver {$(
        $(#[$doc:meta])*
        $name:ident: $type:ident = $default:expr $(=> $single:expr)?, $range:ident, $argument:expr, $mjcf:expr;
    )*}) => {
        /// The options of the solver. A field is `None` until it is set.
        ///
        /// ```
        /// use clench_solver::SolverOptions;
        /// let settings = SolverOptions::new().iterations(10).resolve::<f32>();
        /// assert_eq!((settings.iterations, settings.tolerance), (10, 1e-5));
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct SolverOptions {
            $( $(#[$doc])* pub $name: Option<$type>, )*
        }

        /// [`SolverOptions`] with a value for every field.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Settings {
            $( $(#[$doc])* pub $name: $type, )*
            /// The maximum number of entries in the factor of a Hessian, or in the matrix of `noslip`. A problem or
            /// island that needs more ends with [`Status::TooLarge`](crate::Status::TooLarge). This is not an option:
            /// the code that sets up the problem sets it.
            pub max_matrix: usize,
        }

        impl SolverOptions {
            $( $(#[$doc])*
            #[must_use]
            pub fn $name(mut self, value: $type) -> Self {
                self.$name = Some(value);
                self
            } )*

            fn resolve_for(self, single_precision: bool) -> Settings {
                Settings {
                    $( $name: self.$name.unwrap_or({
                        $( if single_precision { $single } else )? { $default }
                    }), )*
                    max_matrix: usize::MAX,
                }
            }
        }
    };
}

crate::solver_options!(declare_options);

impl SolverOptions {
    /// Creates options with nothing set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Resolves every field, using the default if it is not set. `T` is the number type of the solve.
    pub fn resolve<T: Real>(self) -> Settings {
        self.resolve_for(size_of::<T::Scalar>() < size_of::<f64>())
    }
}

impl Default for Settings {
    fn default() -> Self {
        SolverOptions::new().resolve_for(false)
    }
}
