//! The options that the solver reads, a row each. What a simulation reads besides is in the table of `clench-rigid`, which takes
//! these rows in: builder methods, checks, the program's flags, MJCF and Python follow from both.

/// Hands the rows to the macro `$then`, before the `$rest`:
///
/// ```text
/// /// What it is; its default as it is written in text.
/// name: Type = default => default in single precision, Range, Argument, Mjcf;
/// ```
///
/// What `Range`, `Argument` of the program and place in `Mjcf` may be is told by types of these names in `clench_rigid::options`; the solver reads
/// names, types and defaults alone.
#[doc(hidden)]
#[macro_export]
macro_rules! solver_options {
    ($then:ident $($rest:tt)*) => {
        $then! {
            solver {
                /// Algorithm that minimises; Newton.
                constraint_solver: ConstraintSolver = ConstraintSolver::Newton, Any, Given("solver"),
                    // Newton finds the minimum that PGS approaches.
                    Words("solver", &[
                        ("Newton", Algorithm(ConstraintSolver::Newton)),
                        ("CG", Algorithm(ConstraintSolver::Cg)),
                        ("PGS", Algorithm(ConstraintSolver::Newton)),
                    ]);
                /// Most iterations of a solve; 50. Models from MJCF have 100 where the file says nothing.
                iterations: usize = 50, Any, Given("iterations"), Attribute("iterations");
                /// Stop where gradient norm and last improvement (CG: the duality gap), over mean inertia × nv, are below; 1e-8, but 1e-5 in
                /// single precision. Zero asks for the working precision.
                tolerance: f64 = 1e-8 => 1e-5, NotNegative, Given("tolerance"), Attribute("tolerance");
                /// Most evaluations of a line search; 50. With none it takes its first guess, as MuJoCo's does, if the cost falls there.
                ls_iterations: usize = 50, Any, Given("ls-iterations"), Attribute("ls_iterations");
                /// Slope at which a line search stops, relative to the tolerance; 0.01.
                ls_tolerance: f64 = 0.01, NotNegative, Given("ls-tolerance"), Attribute("ls_tolerance");
                /// Whether the Hessian is kept sparse; auto: the model decides.
                sparse_solve: Switch = Switch::Auto, Any, Given("sparse"),
                    Words("jacobian", &[
                        ("auto", Choice(Switch::Auto)),
                        ("sparse", Choice(Switch::On)),
                        ("dense", Choice(Switch::Off)),
                    ]);
                /// Most sweeps that remove the slip of friction after the solve; 0.
                noslip_iterations: usize = 0, Any, Given("noslip-iterations"), Attribute("noslip_iterations");
                /// Sweeps stop where their improvement, over mean inertia × nv, is below; 1e-6.
                noslip_tolerance: f64 = 1e-6, NotNegative, Given("noslip-tolerance"), Attribute("noslip_tolerance");
                /// Whether uncoupled parts are solved separately; auto: where the model has more than one tree.
                islands: Switch = Switch::Auto, Any, Given("islands"),
                    Flag("island", [Choice(Switch::Off), Choice(Switch::Auto)]);
                /// Whether a solve starts from the acceleration given to it, in a simulation the last one; true.
                warmstart: bool = true, Any, Sets("no-warmstart", Truth(false)),
                    Flag("warmstart", [Truth(false), Truth(true)]);
            }
            $($rest)*
        }
    };
}
