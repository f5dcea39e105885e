//! The options, a row each: those that the solver reads, which stand with it, and those that the rest of a step reads.

/// Hands all rows to the macro `$then`: the group `solver`, then the group `step`.
///
/// ```text
/// /// What it is; its default as it is written in text.
/// name: Type = default => default in single precision, Range, Argument, Mjcf;
/// ```
///
/// with what its numbers may be ([`Range`](crate::options::Range)), the program's flag ([`Argument`](crate::options::Argument)), and where
/// MJCF has it ([`Mjcf`](crate::options::Mjcf)). A type is one that [`OptionValue`](crate::options::OptionValue) can hold.
#[doc(hidden)]
#[macro_export]
macro_rules! rigid_options {
    ($then:ident) => {
        $crate::solver_options! { $then
            step {
                /// Shortest time constant (s) that a constraint may have; 0.01. Models from MJCF have none.
                constraint_timeconst: f64 = 0.01, NotNegative, Given("constraint-timeconst"), Nowhere;
                /// Whether joint limits act; true.
                enable_joint_limit: bool = true, Any, Sets("no-joint-limit", Truth(false)), Nowhere;
                /// Whether all constraints are left out; false.
                disable_constraint: bool = false, Any, Sets("no-constraint", Truth(true)),
                    Flag("constraint", [Truth(true), Truth(false)]);
                /// Most contacts of a step, which reports an overflow by its status; auto: buffers grow.
                max_contacts: MaxContacts = MaxContacts::Auto, Any, Given("max-contacts"), Nowhere;
                /// Shape of frictional contacts; pyramidal.
                friction_cone: FrictionCone = FrictionCone::Pyramidal, Any, Given("cone"), Attribute("cone");
                /// Ratio of friction to normal impedance in elliptic contacts; 1.
                impratio: f64 = 1.0, Positive, Given("impratio"), Attribute("impratio");
                /// Most directions that a sensor `insidesite` that is `enclosed` tries from each of its starts; 35. (MuJoCo's bound of
                /// collisions too; those here have none.)
                ccd_iterations: usize = 35, Any, Given("ccd-iterations"), Attribute("ccd_iterations");
                /// Relative slope, and step in rad, at which that search ends; 1e-6.
                ccd_tolerance: f64 = 1e-6, NotNegative, Given("ccd-tolerance"), Attribute("ccd_tolerance");
                /// Whether a simulation that diverges goes on from its initial state, and counts how often, where it would stop with an
                /// error; false.
                autoreset: bool = false, Any, Sets("autoreset", Truth(true)),
                    Flag("autoreset", [Truth(false), Truth(true)]);
            }
        }
    };
}
