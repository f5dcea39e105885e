//! The table of options: those of the solver, which are declared with it, and those of the other stages of a step.

/// Passes all rows to the macro `$then`: the group `solver`, then the group `step`.
///
/// ```text
/// /// DESCRIPTION; default DEFAULT.
/// name: Type = default => default in single precision, Range, Argument, Mjcf;
/// ```
///
/// with the range of its numbers ([`Range`](crate::options::Range)), the program's flag
/// ([`Argument`](crate::options::Argument)), and the location in MJCF ([`Mjcf`](crate::options::Mjcf)). A type is one
/// that [`OptionValue`](crate::options::OptionValue) can hold.
#[doc(hidden)]
#[macro_export]
macro_rules! rigid_options {
    ($then:ident) => {
        $crate::solver_options! { $then
            step {
                /// Shortest time constant (s) that a constraint may have; default 0.01. Models from MJCF have none.
                constraint_timeconst: f64 = 0.01, NotNegative, Value("constraint-timeconst"), Nowhere;
                /// Enables joint limits; default true.
                enable_joint_limit: bool = true, Any, Sets("no-joint-limit", Truth(false), "Disable joint limits"),
                    Nowhere;
                /// Disables all constraints; default false.
                disable_constraint: bool = false, Any, Sets("no-constraint", Truth(true), "Disable all constraints"),
                    Flag("constraint", [Truth(true), Truth(false)]);
                /// Maximum number of contacts of a step, which reports an overflow by its status; default auto: buffers
                /// grow.
                max_contacts: MaxContacts = MaxContacts::Auto, Any, Value("max-contacts"), Nowhere;
                /// Shape of frictional contacts; default pyramidal.
                friction_cone: FrictionCone = FrictionCone::Pyramidal, Any, Value("cone"), Attribute("cone");
                /// Law of friction in contacts; default convex. In the model coulomb, sliding does not change the
                /// normal force, and the shape of frictional contacts has no effect.
                contact_model: ContactModel = ContactModel::Convex, Any, Value("contact-model"),
                    Text("clench.contact_model");
                /// Friction that sticks: contacts, dofs and tendons remember where they stuck, so that nothing creeps
                /// under a steady load; default false. Chosen when a simulation is created.
                stiction: bool = false, Any, Sets("stiction", Truth(true),
                    "Make friction stick: contacts, dofs and tendons remember where they stuck, so that nothing creeps under \
                     a steady load"), Text("clench.stiction");
                /// Maximum number of pairs of geoms that stick at a time, beyond which a step fails; default 0, which
                /// means one that suits the model. Chosen when a simulation is created.
                max_stick_pairs: usize = 0, Any, Value("max-stick-pairs"), Nowhere;
                /// Ratio of friction to normal impedance in elliptic and Coulomb contacts; default 1.
                impratio: f64 = 1.0, Positive, Value("impratio"), Attribute("impratio");
                /// Maximum directions that a sensor `insidesite` with `enclosed` tries from each of its starts; default
                /// 35. (In MuJoCo also a limit of collision iterations, which have none here.)
                ccd_iterations: usize = 35, Any, Value("ccd-iterations"), Attribute("ccd_iterations");
                /// Relative slope, and step in rad, at which that search ends; default 1e-6.
                ccd_tolerance: f64 = 1e-6, NotNegative, Value("ccd-tolerance"), Attribute("ccd_tolerance");
                /// Resets a diverged simulation to its initial state, and counts the resets, instead of stopping with
                /// an error; default false.
                autoreset: bool = false, Any, Sets("autoreset", Truth(true),
                    "Reset a diverged simulation to its initial state, and count the resets, instead of stopping with an error"),
                    Flag("autoreset", [Truth(false), Truth(true)]);
            }
        }
    };
}
