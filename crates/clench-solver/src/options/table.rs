//! The table of solver options, one per row. The table of `clench-dynamics` includes these rows and adds the other
//! options of a simulation. Builder methods, checks, the program's flags, MJCF and Python are derived from both.

/// Passes the rows to the macro `$then`, followed by `$rest`:
///
/// ```text
/// /// DESCRIPTION; default DEFAULT.
/// name: Type = default => default in single precision, Range, Argument, Mjcf;
/// ```
///
/// The types of the same names in `clench_dynamics::options` define `Range`, `Argument` (of the program) and `Mjcf`.
/// The solver reads only names, types and defaults.
#[doc(hidden)]
#[macro_export]
macro_rules! solver_options {
    ($then:ident $($rest:tt)*) => {
        $then! {
            solver {
                /// Minimisation algorithm; default Newton.
                constraint_solver: ConstraintSolver = ConstraintSolver::Newton, Any, Value("solver"),
                    // PGS approaches the minimum that Newton computes.
                    Words("solver", &[
                        ("Newton", Algorithm(ConstraintSolver::Newton)),
                        ("CG", Algorithm(ConstraintSolver::Cg)),
                        ("PGS", Algorithm(ConstraintSolver::Newton)),
                    ]);
                /// Maximum number of iterations of a solve; default 50, for models from MJCF 100.
                iterations: usize = 50, Any, Value("iterations"), Attribute("iterations");
                /// Tolerance for the gradient norm and the last improvement (CG: the duality gap), over mean inertia ×
                /// nv; default 1e-8, but 1e-5 in single precision. Zero iterates to the working precision.
                tolerance: f64 = 1e-8 => 1e-5, NotNegative, Value("tolerance"), Attribute("tolerance");
                /// Maximum number of evaluations of a line search; default 50. With 0 it takes its first guess if the
                /// cost decreases there, like MuJoCo.
                ls_iterations: usize = 50, Any, Value("ls-iterations"), Attribute("ls_iterations");
                /// Slope at which a line search stops, relative to the tolerance; default 0.01.
                ls_tolerance: f64 = 0.01, NotNegative, Value("ls-tolerance"), Attribute("ls_tolerance");
                /// Sparse storage of the Hessian; default auto: chosen per model.
                sparse_solve: Switch = Switch::Auto, Any, Value("sparse"),
                    Words("jacobian", &[
                        ("auto", Choice(Switch::Auto)),
                        ("sparse", Choice(Switch::On)),
                        ("dense", Choice(Switch::Off)),
                    ]);
                /// Maximum number of sweeps that remove the slip of friction after the solve; default 0.
                noslip_iterations: usize = 0, Any, Value("noslip-iterations"), Attribute("noslip_iterations");
                /// Improvement, over mean inertia × nv, below which the sweeps stop; default 1e-6.
                noslip_tolerance: f64 = 1e-6, NotNegative, Value("noslip-tolerance"), Attribute("noslip_tolerance");
                /// Separate solves of uncoupled parts; default auto: if the model has more than one tree.
                islands: Switch = Switch::Auto, Any, Value("islands"),
                    Flag("island", [Choice(Switch::Off), Choice(Switch::Auto)]);
                /// Starts a solve from the acceleration given to it, in a simulation the last one; default true.
                warmstart: bool = true, Any, Sets("no-warmstart", Truth(false),
                        "Start each solve from the acceleration without constraints, not from the last solution"),
                    Flag("warmstart", [Truth(false), Truth(true)]);
            }
            $($rest)*
        }
    };
}
