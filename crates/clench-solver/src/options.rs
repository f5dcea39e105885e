//! What a user may set, and the plain settings that a solve reads.

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

/// The shape of frictional contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionCone {
    /// Linearised: 2(condim − 1) edges.
    #[default]
    Pyramidal,
    /// The exact cone.
    Elliptic,
}

/// How many contacts a step may hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaxContacts {
    /// Buffers grow as needed.
    #[default]
    Auto,
    /// At most this many; more are reported as an overflow.
    Limit(usize),
}

macro_rules! options {
    ($( $(#[$doc:meta])* $name:ident: $type:ty = $default:expr; )*) => {
        /// Options of the constraint model and its solver. Every field knows whether it was set, so that what the user sets
        /// wins over the file and the file over its format's defaults: `user.or(file).or(format).resolve::<f64>()`.
        ///
        /// ```
        /// use clench_solver::RigidOptions;
        /// let user = RigidOptions::new().iterations(10);
        /// let file = RigidOptions::new().iterations(100).impratio(10.0);
        /// let settings = user.or(file).resolve::<f64>();
        /// assert_eq!((settings.iterations, settings.impratio, settings.ls_iterations), (10, 10.0, 50));
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct RigidOptions {
            $( $(#[$doc])* pub $name: Option<$type>, )*
        }

        /// [`RigidOptions`] with every field decided.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Settings {
            $( $(#[$doc])* pub $name: $type, )*
            /// Most numbers in the factor of a Hessian, or in the matrix of `noslip`: a problem, or an island of it, that needs more
            /// ends as [`Status::TooLarge`](crate::Status::TooLarge). No option: whoever sets up the problem says what it may take.
            pub max_matrix: usize,
        }

        impl RigidOptions {
            $( $(#[$doc])*
            #[must_use]
            pub fn $name(mut self, value: $type) -> Self {
                self.$name = Some(value);
                self
            } )*

            /// Takes from `lower` what is not set here.
            #[must_use]
            pub fn or(self, lower: RigidOptions) -> Self {
                RigidOptions { $( $name: self.$name.or(lower.$name), )* }
            }

            fn resolve_for(self, single_precision: bool) -> Settings {
                Settings { $( $name: self.$name.unwrap_or_else(|| {
                    let default: fn(bool) -> $type = $default;
                    default(single_precision)
                }), )* max_matrix: usize::MAX }
            }
        }
    };
}

options! {
    /// Algorithm that minimises; Newton.
    constraint_solver: ConstraintSolver = |_| ConstraintSolver::Newton;
    /// Most iterations of a solve; 50.
    iterations: usize = |_| 50;
    /// Stop where gradient norm and last improvement (CG: the duality gap), over mean inertia × nv, are below; 1e-8, 1e-5 in
    /// single precision. Zero asks for the working precision.
    tolerance: f64 = |single| if single { 1e-5 } else { 1e-8 };
    /// Most evaluations of a line search; 50.
    ls_iterations: usize = |_| 50;
    /// Precision of a line search relative to `tolerance`; 0.01.
    ls_tolerance: f64 = |_| 0.01;
    /// Shortest time constant (s) that a constraint may have; 0.01.
    constraint_timeconst: f64 = |_| 0.01;
    /// Whether joint limits act; true.
    enable_joint_limit: bool = |_| true;
    /// Whether all constraints are left out; false.
    disable_constraint: bool = |_| false;
    /// Sparse or dense Hessian; by the model.
    sparse_solve: Switch = |_| Switch::Auto;
    /// Most sweeps that remove the slip of friction after the solve; 0.
    noslip_iterations: usize = |_| 0;
    /// Sweeps stop where their improvement, over mean inertia × nv, is below; 1e-6.
    noslip_tolerance: f64 = |_| 1e-6;
    /// Most contacts of a step; buffers grow.
    max_contacts: MaxContacts = |_| MaxContacts::Auto;
    /// Shape of frictional contacts; pyramidal.
    friction_cone: FrictionCone = |_| FrictionCone::Pyramidal;
    /// Ratio of friction to normal impedance in elliptic contacts; 1.
    impratio: f64 = |_| 1.0;
    /// Whether uncoupled parts are solved separately; where the model has more than one tree.
    islands: Switch = |_| Switch::Auto;
    /// Whether a solve starts from the acceleration given to it; true.
    warmstart: bool = |_| true;
    /// Whether a simulation that diverges goes on from its initial state, where it would stop with an error; false.
    autoreset: bool = |_| false;
}

impl RigidOptions {
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
        RigidOptions::new().resolve_for(false)
    }
}
