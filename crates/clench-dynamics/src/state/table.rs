//! The fields of a state, a line each. Memory, rows of batches, checks, copies, and the names in files and in Python follow
//! from this table.

/// Hands the table to the macro `$then`: groups of lines
///
/// ```text
/// /// What it is (how many).
/// name set_name: Kind, Size, Bound;
/// ```
///
/// with one of the [kinds](crate::state::kind), the [size](crate::state::Size) that says how many elements there are, how large
/// its numbers may be, and the name of its setter in Python. The groups say what a step does with a field: `moving` ones it reads
/// and writes; `inputs` it only reads; `occasional` inputs are mostly zero, and cost nothing then. The time, in double precision
/// whatever the precision of the rest, stands outside.
#[doc(hidden)]
#[macro_export]
macro_rules! state_fields {
    ($then:ident) => {
        $then! {
            moving {
                /// Position coordinates (nq).
                qpos set_qpos: Number, Positions, Near;
                /// Velocities (nv).
                qvel set_qvel: Number, Dofs, Near;
                /// Activations of actuators (na).
                act set_act: Number, Activations, Finite;
                /// Where springs that yield rest (nplastic): the position of a slide or hinge joint, the orientation of a ball joint (a unit
                /// quaternion, w first), the ends of a tendon's dead band. Joints first, in order.
                plastic set_plastic: Number, Plastic, Finite;
                /// Buffers of past values of delayed actuators (nhistory): see the module `history`.
                history set_history: Number, History, Finite;
                /// Acceleration of the previous step, where the solver starts (nv).
                qacc_warmstart set_qacc_warmstart: Number, Dofs, Finite;
                /// Which trees sleep (ntree, where the flag ``sleep`` is on, else none): below zero a tree is awake, from -11 for one that
                /// moves to -1 for one that has come to rest; else the next tree of the sleeping island, in a circle.
                tree_asleep set_tree_asleep: Integer, Trees, Finite;
                /// Where sleeping trees lie: positions (nq), then position and orientation of each mocap body after the last step. What
                /// lies elsewhere wakes. None without the flag ``sleep``.
                pose_asleep set_pose_asleep: Number, AsleepPose, Finite;
            }
            inputs {
                /// Controls of actuators (nu).
                ctrl set_ctrl: Number, Actuators, Finite;
                /// Forces that the user applies along degrees of freedom (nv), N or N m.
                qfrc_applied set_qfrc_applied: Number, Dofs, Finite;
                /// Positions of mocap bodies (nmocap), m.
                mocap_pos set_mocap_pos: Vector, MocapBodies, Finite;
                /// Orientations of mocap bodies (nmocap), unit quaternions, w first.
                mocap_quat set_mocap_quat: Quaternion, MocapBodies, Finite;
                /// Which equality constraints are on (neq).
                eq_active set_eq_active: Truth, Equalities, Finite;
            }
            occasional {
                /// Forces and torques that the user applies to bodies at their centres of mass, world axes (nbody): the force first.
                xfrc_applied set_xfrc_applied: Wrench, Bodies, Finite;
                /// What each slot for constraints at run time holds (max_dynamic_constraints): 1 a connect, 2 a weld, all else nothing.
                /// See the module `constraint::dynamic`.
                dynamic_kind set_dynamic_kind: Integer, DynamicConstraints, Finite;
                /// The number that the constraint of each slot got when it was added, by which handles know it.
                dynamic_serial set_dynamic_serial: Integer, DynamicConstraints, Finite;
                /// The first body that each slot ties; one that the model does not have ties nothing.
                dynamic_body1 set_dynamic_body1: Integer, DynamicConstraints, Finite;
                /// The second body, likewise.
                dynamic_body2 set_dynamic_body2: Integer, DynamicConstraints, Finite;
                /// Anchor in the frame of the first body, m.
                dynamic_anchor1 set_dynamic_anchor1: Vector, DynamicConstraints, Finite;
                /// Anchor in the frame of the second body, m.
                dynamic_anchor2 set_dynamic_anchor2: Vector, DynamicConstraints, Finite;
                /// Orientation of the second body in the frame of the first that a weld holds, a unit quaternion, w first.
                dynamic_quat set_dynamic_quat: Quaternion, DynamicConstraints, Finite;
            }
        }
    };
}
