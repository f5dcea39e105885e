//! What a user may set, and the plain settings that a solve reads.

mod table;

use clench_math::Real;

/// Which algorithm minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConstraintSolver {
    /// Newton's method with a factored Hessian.
    #[default]
    Newton,
    /// Conjugate gradients preconditioned by the mass matrix: matrix-vector products only.
    Cg,
}

/// A choice that the model decides unless the user does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switch {
    /// Decided per model.
    #[default]
    Auto,
    /// Always.
    On,
    /// Never.
    Off,
}

macro_rules! declare_options {
    (solver {$(
        $(#[$doc:meta])*
        $name:ident: $type:ident = $default:expr $(=> $single:expr)?, $range:ident, $argument:expr, $mjcf:expr;
    )*}) => {
        /// Options of the solver. Every field knows whether it was set.
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

        /// [`SolverOptions`] with every field decided.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Settings {
            $( $(#[$doc])* pub $name: $type, )*
            /// Most numbers in the factor of a Hessian, or in the matrix of `noslip`: a problem, or an island of it, that needs more
            /// ends as [`Status::TooLarge`](crate::Status::TooLarge). No option: whoever sets up the problem says what it may take.
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
    /// Nothing set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Decides every field, by its default where it was not set; `T` is the number that the solve computes in.
    pub fn resolve<T: Real>(self) -> Settings {
        self.resolve_for(size_of::<T::Scalar>() < size_of::<f64>())
    }
}

impl Default for Settings {
    fn default() -> Self {
        SolverOptions::new().resolve_for(false)
    }
}
