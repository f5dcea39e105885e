//! The table of the numbers of joints and tendons that reach the parameters of a model unchanged.

/// Passes to the macro `$then` its arguments in brackets, and groups of lines
///
/// ```text
/// /// Its meaning.
/// name: parameter, Finite or NotNegative, rule of the parameter, Dimension;
/// ```
///
/// `name` is the attribute in MJCF and the field of the author's description, which is zero by default. The parameter
/// is a field of [`Params`](crate::Params) with a number for each joint, dof or tendon. Descriptions, their checks, the
/// parameters, and the reading, scaling and writing of files follow from this table.
#[doc(hidden)]
#[macro_export]
macro_rules! element_numbers {
    ($then:ident $($arguments:tt)*) => {
        $then! {
            [$($arguments)*]
            joint {
                /// Distance at which the limit becomes active, m or rad.
                margin: jnt_margin, Finite, Finite, Coordinate;
                /// Elongation, m or rad, at which the spring yields and its rest position follows; 0 for never.
                springyield: jnt_springyield, NotNegative, IfModel, Coordinate;
            }
            dof {
                /// Added inertia, kg or kg m².
                armature: dof_armature, NotNegative, NotNegative, ForcePerCoordinate;
                /// Dry friction, N or N m.
                frictionloss: dof_frictionloss, NotNegative, NotNegative, Force;
            }
            tendon {
                /// Distance at which the limit becomes active, m or rad.
                margin: tendon_margin, Finite, Finite, Coordinate;
                /// Inertia for changes of the length, for a tendon that wraps around no geom.
                armature: tendon_armature, NotNegative, IfModel, ForcePerCoordinate;
                /// Elongation at which the spring yields and its dead band follows; 0 for never.
                springyield: tendon_springyield, NotNegative, IfModel, Coordinate;
                /// Dry friction, N or N m.
                frictionloss: tendon_frictionloss, NotNegative, NotNegative, Force;
            }
        }
    };
}
